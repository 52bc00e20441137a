/* SPDX-License-Identifier: MIT */
#include "device/change.h"

#include <inttypes.h>

#include "ports/line_text.h"

const char *const change_outcomes[] = {[CHANGE_UNCHANGED] = "unchanged",
                                       [CHANGE_DONE] = "written",
                                       [CHANGE_UNCONFIRMED] = "not_confirmed",
                                       [CHANGE_DIFFERS] = "differs",
                                       [CHANGE_REFUSED] = "refused",
                                       [CHANGE_NOT_WRITTEN] = "not_written",
                                       [CHANGE_SENT] = "sent"};

bool change_is_read_back(const change_t *change)
{
    const setting_t *const setting = change->setting;
    return !change->is_blind && (setting->get != NULL || setting->moves || setting->confirmed != NULL);
}

change_outcome_t change_outcome(const change_t *change, fathom_status_t status)
{
    const reader_facts_t facts = reader_facts(change->session->station->reader);
    if (!facts.is_written) return status == FATHOM_OK ? CHANGE_UNCHANGED : CHANGE_NOT_WRITTEN;
    if (status == FATHOM_OK) return CHANGE_DONE;
    if (change->is_for_all) return facts.acknowledgement == FATHOM_OK ? CHANGE_SENT : CHANGE_UNCONFIRMED;
    if (status == FATHOM_ERR_EXCEPTION) return CHANGE_REFUSED;
    const bool is_unknown =
        facts.is_setting || status == FATHOM_ERR_UNCONFIRMED || change->setting->confirmed != NULL;
    return is_unknown || !change_is_read_back(change) ? CHANGE_UNCONFIRMED : CHANGE_DIFFERS;
}

/* The two places at which the device may be, or what else is not known. */
static void print_unknown(FILE *to, const change_t *change)
{
    const sensor_t *const station = change->session->station;
    const setting_t *const setting = change->setting;
    const reader_facts_t facts = reader_facts(station->reader);
    const bool is_acknowledged = !facts.is_setting && facts.acknowledgement == FATHOM_OK;
    (void)fputs(is_acknowledged ? "it was acknowledged; " : "no acknowledgement came; ", to);
    if (setting->is_baud) {
        const uint32_t was = station->line.baud;
        (void)fprintf(to,
                      "it is at %" PRIu32 " or at %s baud, perhaps from the next power-on; try fathom scan "
                      "--port %s --baud %" PRIu32 ",%s",
                      was, change->wanted, session_port(change->session)->path, was, change->wanted);
    } else if (setting->moves) {
        char line[LINE_TEXT];
        (void)fprintf(to, "it is at address %u or at address %s, %s; try fathom read with either",
                      station->address, change->wanted, session_line_text(change->session, line));
    } else if (setting->unconfirmed != NULL) {
        (void)fputs(setting->unconfirmed, to);
    } else {
        (void)fprintf(to, "it may hold or not%s",
                      setting->get != NULL && !change->is_blind ? "; ask for it with fathom get" : "");
    }
}

static void print_not_written(const change_t *change, fathom_status_t status)
{
    switch (status) {
    case FATHOM_ERR_ARGUMENT: /* the value was in range: the driver does not know the line's settings */
    case FATHOM_ERR_UNSUPPORTED:
        (void)fputs("the settings of this port's line cannot be changed", stderr);
        break;
    case FATHOM_ERR_IN_USE:
        (void)fprintf(stderr,
                      "a device answers at address %s already; two at one address would answer at once",
                      change->wanted);
        break;
    default:
        session_explain(change->session, status);
        break;
    }
}

void change_explain(const change_t *change, change_outcome_t outcome, fathom_status_t status)
{
    const reader_facts_t facts = reader_facts(change->session->station->reader);
    (void)fprintf(stderr, "fathom: %s: %s %s: %s: ", change->session->station->name, change->setting->name,
                  change->wanted, change_outcomes[outcome]);
    switch (outcome) {
    case CHANGE_UNCONFIRMED:
        print_unknown(stderr, change);
        break;
    case CHANGE_DIFFERS:
        (void)fprintf(stderr, "%s, and the device tells another value; perhaps this variant does not have it",
                      facts.acknowledgement == FATHOM_OK ? "it was acknowledged" : "no acknowledgement came");
        break;
    case CHANGE_REFUSED:
        session_explain(change->session, status);
        break;
    default:
        print_not_written(change, status);
        break;
    }
    (void)fputs("\n", stderr);
}
