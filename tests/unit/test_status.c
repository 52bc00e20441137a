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
