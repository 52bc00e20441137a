/* SPDX-License-Identifier: MIT */
#include "device/set_report.h"

#include "device/setting_text.h"
#include "output/status.h"
#include "sensors/read_command.h"

static void print_value(const setting_t *setting, const char *text)
{
    const bool has_unit = setting->unit != NULL && setting->words == NULL;
    (void)printf("%s%s%s", text, has_unit ? " " : "", has_unit ? setting->unit : "");
}

/* Prints how to read the sensor after its address or baud rate has changed. */
static void print_next(const change_t *change)
{
    const setting_t *const setting = change->setting;
    const sensor_t *const station = change->session->station;
    const reader_facts_t facts = reader_facts(station->reader);
    const fathom_line_settings_t *const line = facts.line != NULL ? facts.line : &station->line;
    if (!setting->moves) return;
    (void)fputs("from now on: ", stdout);
    read_command_print(stdout, station->model, station->mode->name, facts.address, line,
                       session_port(change->session)->path);
    (void)fputs("\n", stdout);
}

static bool is_later(const change_t *change)
{
    const setting_t *const setting = change->setting;
    return setting->is_later != NULL && setting->is_later(change->session->station->reader);
}

static void print_json(const change_t *change, change_outcome_t outcome)
{
    const sensor_t *const station = change->session->station;
    const bool is_unchanged = outcome == CHANGE_UNCHANGED;
    const bool is_confirmed = is_unchanged || (outcome == CHANGE_DONE && change_is_read_back(change));
    json_t json = {.to = stdout};
    json_begin(&json, NULL, '{');
    sensor_json(&json, station);
    json_value(&json, "address", "%u",
               change->is_for_all ? 0u : (unsigned)reader_facts(station->reader).address);
    json_string(&json, "setting", change->setting->name);
    setting_json(&json, "value", change->setting, change->wanted);
    setting_json(&json, "was", change->setting, change->was[0] != '\0' ? change->was : NULL);
    json_flag(&json, "written", !is_unchanged && outcome != CHANGE_NOT_WRITTEN);
    json_flag(&json, "confirmed", is_confirmed);
    json_string(&json, "status", change_outcomes[outcome]);
    json_end(&json, '}');
    (void)fputc('\n', stdout);
}

static void print_done(const change_t *change, change_outcome_t outcome)
{
    const setting_t *const setting = change->setting;
    (void)printf("%s: %s is ", change->session->station->name, setting->name);
    print_value(setting, change->wanted);
    if (is_later(change))
        (void)printf(" from the next power-on (%s until then)\n", change->was);
    else if (outcome == CHANGE_UNCHANGED)
        (void)printf(": %s\n", change_outcomes[CHANGE_UNCHANGED]);
    else if (setting->get != NULL)
        (void)printf(" (was %s)\n", change->was);
    else if (setting->moves || setting->confirmed != NULL)
        (void)printf("%s%s\n", setting->confirmed != NULL ? ": " : "",
                     setting->confirmed != NULL ? setting->confirmed : "");
    else
        (void)puts(" as far as the device has acknowledged it; it cannot be read back");
    if (outcome != CHANGE_UNCHANGED) print_next(change);
}

/* What was asked for is done, and more than that cannot be known. */
static bool is_done_blind(const change_t *change, change_outcome_t outcome)
{
    const int8_t response = reader_facts(change->session->station->reader).acknowledgement;
    /* what came back is its acknowledgement, or may be: nothing was read that could tell an echo from one */
    const bool is_answered = response == FATHOM_OK || response == FATHOM_ERR_ECHO;
    return outcome == CHANGE_SENT || (change->is_blind && outcome == CHANGE_UNCONFIRMED && is_answered);
}

int set_report(const change_t *change, fathom_status_t status)
{
    const change_outcome_t outcome = change_outcome(change, status);
    const bool is_blind = is_done_blind(change, outcome);
    const bool is_done = outcome == CHANGE_UNCHANGED || outcome == CHANGE_DONE || is_blind;
    if (change->session->is_json) print_json(change, outcome);
    if (!is_done) {
        (void)fflush(stdout);
        change_explain(change, outcome, status);
    } else if (is_blind && !change->session->is_json) {
        (void)printf("%s: %s %s: %s\n", change->is_for_all ? "all units" : change->session->station->name,
                     change->setting->name, change->wanted, change_outcomes[outcome]);
    } else if (!change->session->is_json) {
        print_done(change, outcome);
    }
    if (fflush(stdout) != 0 || ferror(stdout)) {
        (void)fprintf(stderr, "fathom: the output cannot be written; the setting: %s\n",
                      change_outcomes[outcome]);
        return STATUS_FAILED;
    }
    return is_done ? STATUS_OK : STATUS_FAILED;
}
