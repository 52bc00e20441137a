/* SPDX-License-Identifier: MIT */
#include "diagnosis/status_word.h"

#include "diagnosis/counters.h"
#include "fathom/processing/alarm.h"

/* FATHOM_NEAR of a contact. */
enum { KIND_NEAR = FATHOM_UNKNOWN + 1 };

static const struct {
    const char *name;
    const char *what;
} kinds[] = {
    [FATHOM_TARGET] = {"target", "there is a distance"},
    [FATHOM_NO_TARGET] = {"no_target", "nothing in range"},
    [FATHOM_NEAR] = {"too_near", "something nearer than it can measure"},
    [KIND_NEAR] = {"near", "a switch or a relay says that something is nearer than its threshold"},
    [FATHOM_FAR] = {"far", "a switch or a relay says that nothing is"},
    [FATHOM_UNKNOWN] = {"unknown",
                        "a value without a known meaning (--means), or only pulses that are too short"},
    [FATHOM_FAULT] = {"fault", "the sensor says that it has failed"},
};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

const char *status_word(const model_mode_t *mode, uint8_t kind)
{
    const bool is_contact = mode->is_contact;
    return kinds[kind == FATHOM_NEAR && is_contact ? KIND_NEAR : kind].name;
}

const char *status_word_of_failure(size_t kind, char *text)
{
    return counters_member(counters_failure_name(kind), text);
}

const char *alarm_word(uint8_t state)
{
    static const char *const names[] = {[FATHOM_ALARM_ON] = "on",
                                        [FATHOM_ALARM_OFF] = "off",
                                        [FATHOM_ALARM_UNKNOWN] = "unknown",
                                        [FATHOM_ALARM_NO_RESPONSE] = "no_response"};
    return names[state];
}

void status_words_help(FILE *to)
{
    char word[COUNTERS_MEMBER];
    for (size_t i = 0; i != KINDS; i++)
        if (kinds[i].name != NULL) (void)fprintf(to, "  %-17s %s\n", kinds[i].name, kinds[i].what);
    for (size_t i = 0; i != FAILURE_KINDS; i++)
        if (counters_failure_name(i) != NULL)
            (void)fprintf(to, "  %-17s %s\n", status_word_of_failure(i, word), counters_failure_what(i));
}
