/* SPDX-License-Identifier: MIT */
#include "device/change.h"

#include <inttypes.h>

#include "device/setting_text.h"
#include "ports/line_text.h"
#include "sensors/read_command.h"

static const char *const words[] = {[CHANGE_UNCHANGED] = "unchanged",
                                    [CHANGE_DONE] = "written",
                                    [CHANGE_UNCONFIRMED] = "not_confirmed",
                                    [CHANGE_DIFFERS] = "differs",
                                    [CHANGE_REFUSED] = "refused",
                                    [CHANGE_NOT_WRITTEN] = "not_written",
                                    [CHANGE_SENT] = "sent"};

/* The outcome as text has no underscore. */
static const char *outcome_text(change_outcome_t outcome)
{
    return outcome == CHANGE_NOT_WRITTEN   ? "not written"
           : outcome == CHANGE_UNCONFIRMED ? "not confirmed"
                                           : words[outcome];
}

/* If the setting is read back, CHANGE_DONE is more than an acknowledgement. */
static bool is_read_back(const change_t *change)
{
    const setting_t *const setting = change->setting;
    return !change->is_blind && (setting->get != NULL || setting->moves || setting->confirmed != NULL);
}

change_outcome_t change_outcome(const change_t *change, fathom_status_t status)
{
    const reader_facts_t facts = reader_facts(change->session->sensor->reader);
    if (!facts.is_written) return status == FATHOM_OK ? CHANGE_UNCHANGED : CHANGE_NOT_WRITTEN;
    if (status == FATHOM_OK) return CHANGE_DONE;
    if (change->is_for_all) return facts.acknowledgement == FATHOM_OK ? CHANGE_SENT : CHANGE_UNCONFIRMED;
    if (status == FATHOM_ERR_EXCEPTION) return CHANGE_REFUSED;
    const bool is_unknown =
        facts.is_setting || status == FATHOM_ERR_UNCONFIRMED || change->setting->confirmed != NULL;
    return is_unknown || !is_read_back(change) ? CHANGE_UNCONFIRMED : CHANGE_DIFFERS;
}

/* ---- what went wrong ---- */

static const char *acknowledgement(const change_t *change)
{
    const reader_facts_t facts = reader_facts(change->session->sensor->reader);
    return !facts.is_setting && facts.acknowledgement == FATHOM_OK ? "the sensor acknowledged the write"
                                                                   : "no acknowledgement was received";
}

/* Where the sensor may be, or what else is unknown. */
static void print_unconfirmed(const change_t *change)
{
    const sensor_t *const sensor = change->session->sensor;
    const setting_t *const setting = change->setting;
    (void)fprintf(stderr, "%s. ", acknowledgement(change));
    if (setting->is_baud) {
        (void)fprintf(stderr,
                      "The sensor is at %" PRIu32
                      " or at %s baud, perhaps from its next power-on. Run 'fathom "
                      "scan --port %s --baud %" PRIu32 ",%s'",
                      sensor->line.baud, change->wanted, session_port(change->session)->path,
                      sensor->line.baud, change->wanted);
    } else if (setting->moves) {
        char line[LINE_TEXT];
        (void)fprintf(stderr, "The sensor is at address %u or at address %s, %s. Read it at both",
                      sensor->address, change->wanted, session_line_text(change->session, line));
    } else if (setting->unconfirmed != NULL) {
        (void)fputs(setting->unconfirmed, stderr);
    } else {
        (void)fprintf(stderr, "The value may be set or not%s",
                      setting->get != NULL && !change->is_blind ? ". Read it with 'fathom get'" : "");
    }
}

void change_explain(const change_t *change, change_outcome_t outcome, fathom_status_t status)
{
    (void)fflush(stdout);
    (void)fprintf(stderr, "fathom: %s: %s %s: %s: ", change->session->sensor->name, change->setting->name,
                  change->wanted, outcome_text(outcome));
    if (outcome == CHANGE_UNCONFIRMED)
        print_unconfirmed(change);
    else if (outcome == CHANGE_DIFFERS)
        (void)fprintf(stderr, "%s, but it reads back another value. Perhaps this variant does not have it",
                      acknowledgement(change));
    else if (status == FATHOM_ERR_IN_USE)
        (void)fprintf(stderr,
                      "a sensor responds at address %s already. Two sensors at one address would respond at "
                      "the same time",
                      change->wanted);
    else if (status == FATHOM_ERR_ARGUMENT || status == FATHOM_ERR_UNSUPPORTED)
        /* the value is in range, so the driver does not know the settings of the line */
        (void)fputs("the settings of this port's line cannot be changed", stderr);
    else
        session_explain(change->session, status);
    (void)fputs("\n", stderr);
}

/* ---- what was done ---- */

static void print_json(const change_t *change, change_outcome_t outcome)
{
    const sensor_t *const sensor = change->session->sensor;
    const bool is_unchanged = outcome == CHANGE_UNCHANGED;
    json_t json = {.to = stdout};
    json_begin(&json, NULL, '{');
    sensor_json(&json, sensor);
    json_value(&json, "address", "%u",
               change->is_for_all ? 0u : (unsigned)reader_facts(sensor->reader).address);
    json_string(&json, "setting", change->setting->name);
    setting_json(&json, "value", change->setting, change->wanted);
    setting_json(&json, "was", change->setting, change->was[0] != '\0' ? change->was : NULL);
    json_flag(&json, "written", !is_unchanged && outcome != CHANGE_NOT_WRITTEN);
    json_flag(&json, "confirmed", is_unchanged || (outcome == CHANGE_DONE && is_read_back(change)));
    json_string(&json, "status", words[outcome]);
    json_end(&json, '}');
    (void)fputc('\n', stdout);
}

/* How to read the sensor after its address or baud rate has changed. */
static void print_next(const change_t *change)
{
    const sensor_t *const sensor = change->session->sensor;
    const reader_facts_t facts = reader_facts(sensor->reader);
    (void)fputs("from now on: ", stdout);
    read_command_print(stdout, sensor->model, sensor->mode->name, facts.address,
                       facts.line != NULL ? facts.line : &sensor->line, session_port(change->session)->path);
    (void)fputs("\n", stdout);
}

static void print_done(const change_t *change, change_outcome_t outcome)
{
    const setting_t *const setting = change->setting;
    const bool has_unit = setting->unit != NULL && setting->words == NULL;
    const bool is_later = setting->is_later != NULL && setting->is_later(change->session->sensor->reader);
    const char *const unit = has_unit ? setting->unit : "";
    const char *const name = change->session->sensor->name;
    if (setting->get == NULL && setting->confirmed == NULL && !setting->moves) {
        (void)printf("%s: %s: %s%s%s was written and acknowledged; the setting cannot be read back\n", name,
                     setting->name, change->wanted, has_unit ? " " : "", unit);
        return;
    }
    (void)printf("%s: %s is %s%s%s", name, setting->name, change->wanted, has_unit ? " " : "", unit);
    if (is_later)
        (void)printf(" from the next power-on (%s until then)\n", change->was);
    else if (outcome == CHANGE_UNCHANGED)
        (void)printf(": %s\n", words[outcome]);
    else if (setting->get != NULL)
        (void)printf(" (was %s)\n", change->was);
    else if (setting->confirmed != NULL)
        (void)printf(": %s\n", setting->confirmed);
    else
        (void)puts("");
    if (outcome != CHANGE_UNCHANGED && setting->moves) print_next(change);
}

/* Nothing was read that could confirm the value, so an acknowledgement, or what may be an echo of it, is a success. */
static bool is_done_blind(const change_t *change, change_outcome_t outcome)
{
    const int8_t response = reader_facts(change->session->sensor->reader).acknowledgement;
    const bool is_acknowledged = response == FATHOM_OK || response == FATHOM_ERR_ECHO;
    return outcome == CHANGE_SENT || (change->is_blind && outcome == CHANGE_UNCONFIRMED && is_acknowledged);
}

bool change_report(const change_t *change, fathom_status_t status)
{
    const change_outcome_t outcome = change_outcome(change, status);
    const bool is_blind = is_done_blind(change, outcome);
    const bool is_done = outcome == CHANGE_UNCHANGED || outcome == CHANGE_DONE || is_blind;
    if (change->session->is_json) print_json(change, outcome);
    if (!is_done)
        change_explain(change, outcome, status);
    else if (is_blind && !change->session->is_json)
        (void)printf("%s: %s %s: %s\n", change->is_for_all ? "all units" : change->session->sensor->name,
                     change->setting->name, change->wanted, outcome_text(outcome));
    else if (!change->session->is_json)
        print_done(change, outcome);
    if (fflush(stdout) == 0 && ferror(stdout) == 0) return is_done;
    (void)fprintf(stderr, "fathom: cannot write the output; the setting: %s\n", outcome_text(outcome));
    return false;
}
