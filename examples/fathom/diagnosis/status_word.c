/* SPDX-License-Identifier: MIT */
#include "diagnosis/status_word.h"

#include "fathom/processing/alarm.h"

/* FATHOM_NEAR of a contact. */
enum { KIND_NEAR = FATHOM_UNKNOWN + 1 };

static const struct {
    const char *name;
    const char *what;
} kinds[] = {
    [FATHOM_TARGET] = {"target", "There is a distance"},
    [FATHOM_NO_TARGET] = {"no_target", "Nothing is in range"},
    [FATHOM_NEAR] = {"too_near", "A target is nearer than the sensor can measure"},
    [KIND_NEAR] = {"near", "A target is nearer than the threshold (switch, relay)"},
    [FATHOM_FAR] = {"far", "No target is nearer than the threshold (switch, relay)"},
    [FATHOM_UNKNOWN] = {"unknown", "No known meaning (--means), or all pulses are too short"},
    [FATHOM_FAULT] = {"fault", "The sensor reports a fault"},
};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

const char *status_word(const model_mode_t *mode, uint8_t kind)
{
    const bool is_contact = mode->is_contact;
    return kinds[kind == FATHOM_NEAR && is_contact ? KIND_NEAR : kind].name;
}

/* Failures that can end an attempt. */
static const struct {
    const char *name;
    const char *what;
} failures[FAILURE_KINDS] = {
    [FAILURE_VALUE] = {"impossible_values", "No distance, or refused by --window or --means"},
    [-FATHOM_ERR_PORT] = {"port", "The port is lost, or the program waits for it"},
    [-FATHOM_ERR_NO_RESPONSE] = {"no_response", "The sensor did not respond within --timeout"},
    [-FATHOM_ERR_CHECKSUM] = {"damaged", "The bytes have a wrong checksum, or form no frame"},
    [-FATHOM_ERR_EXCEPTION] = {"exception", "The sensor refused the request by a Modbus exception"},
    [-FATHOM_ERR_MALFORMED] = {"other_response", "The response does not fit the request"},
    [-FATHOM_ERR_STALE] = {"stale", "No frame arrived within --timeout (without requests)"},
    [-FATHOM_ERR_LINE_BUSY] = {"line_busy", "The line was never silent; no request could be sent"},
    [-FATHOM_ERR_OTHER_MASTER] = {"other_master", "Another master sent requests to this sensor"},
    [FAILURE_KINDS - 1] = {"other", "Any other failure"},
};

const char *status_word_of_failure(size_t kind) { return failures[kind].name; }

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
    for (size_t i = 0; i != KINDS; i++)
        if (kinds[i].name != NULL) (void)fprintf(to, "  %-17s %s\n", kinds[i].name, kinds[i].what);
    for (size_t i = 0; i != FAILURE_KINDS; i++)
        if (failures[i].name != NULL) (void)fprintf(to, "  %-17s %s\n", failures[i].name, failures[i].what);
}
