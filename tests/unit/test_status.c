/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include "fathom/status.h"

/* Without a default, so that the compiler says when status.h has one that is not here. */
static const char *name_in_the_header(fathom_status_t status)
{
#define ERROR_NAMED(name)                                                                                    \
    case FATHOM_ERR_##name:                                                                                  \
        return #name
    switch (status) {
    case FATHOM_OK:
        return "OK";
    case FATHOM_PENDING:
        return "PENDING";
        ERROR_NAMED(ARGUMENT);
        ERROR_NAMED(PORT);
        ERROR_NAMED(NO_RESPONSE);
        ERROR_NAMED(CHECKSUM);
        ERROR_NAMED(EXCEPTION);
        ERROR_NAMED(MALFORMED);
        ERROR_NAMED(STALE);
        ERROR_NAMED(CANCELLED);
        ERROR_NAMED(BUSY);
        ERROR_NAMED(CAPACITY);
        ERROR_NAMED(ECHO);
        ERROR_NAMED(UNSUPPORTED);
        ERROR_NAMED(WARMING_UP);
        ERROR_NAMED(UNCONFIRMED);
        ERROR_NAMED(IN_USE);
        ERROR_NAMED(DIFFERS);
        ERROR_NAMED(LINE_BUSY);
        ERROR_NAMED(OTHER_MASTER);
    }
    return "?";
}

/* status.h: "they fit an int8_t". */
TEST(each_status_has_its_name_and_any_other_number_a_question_mark)
{
    unsigned named = 0;
    for (int number = INT8_MIN; number <= INT8_MAX; number++) {
        const char *const name = fathom_status_name((fathom_status_t)number);
        assert_string_equal(name, name_in_the_header((fathom_status_t)number));
        named += name[0] != '?';
    }
    assert_int_equal(named, 20);
    assert_string_equal(fathom_status_name(FATHOM_ERR_NO_RESPONSE), "NO_RESPONSE");
}

/* Two statuses with the same advice would be one status for a user. */
TEST(each_status_has_advice_of_its_own)
{
    static const fathom_status_t none = (fathom_status_t)(FATHOM_ERR_OTHER_MASTER - 1);
    for (int number = FATHOM_ERR_OTHER_MASTER; number <= FATHOM_PENDING; number++) {
        const char *const advice = fathom_status_advice((fathom_status_t)number);
        assert_int_equal(advice[strlen(advice) - 1], '.');
        assert_in_range(strlen(advice), 20, 120);
        for (int other = FATHOM_ERR_OTHER_MASTER; other < number; other++)
            assert_true(strcmp(advice, fathom_status_advice((fathom_status_t)other)) != 0);
        assert_true(strcmp(advice, fathom_status_advice(none)) != 0);
    }
    assert_string_equal(fathom_status_advice(none), "This is no status.");
    assert_string_equal(fathom_status_advice((fathom_status_t)(FATHOM_PENDING + 1)), "This is no status.");
}

/* The sentence names what a user checks first (status.h has the causes). */
TEST(advice_names_what_to_check)
{
    static const struct {
        fathom_status_t status;
        const char *word;
    } rows[] = {{FATHOM_ERR_ARGUMENT, "init"},      {FATHOM_ERR_PORT, "adapter"},
                {FATHOM_ERR_NO_RESPONSE, "supply"}, {FATHOM_ERR_NO_RESPONSE, "address"},
                {FATHOM_ERR_NO_RESPONSE, "plug"},   {FATHOM_ERR_NO_RESPONSE, "others respond"},
                {FATHOM_ERR_CHECKSUM, "parity"},    {FATHOM_ERR_STALE, "TX"},
                {FATHOM_ERR_LINE_BUSY, "bias"},     {FATHOM_ERR_OTHER_MASTER, "one master"},
                {FATHOM_ERR_CAPACITY, "32 bytes"},  {FATHOM_ERR_IN_USE, "free address"}};
    for (unsigned i = 0; i != sizeof rows / sizeof rows[0]; i++)
        assert_non_null(strstr(fathom_status_advice(rows[i].status), rows[i].word));
}
