/* SPDX-License-Identifier: MIT */
#include "stations/set_report.h"

#include <inttypes.h>

#include "shared/command.h"
#include "shared/line_text.h"

static void print_value(const setting_t *setting, const char *text)
{
    const bool has_unit = setting->unit != NULL && setting->words == NULL;
    (void)printf("%s%s%s", text, has_unit ? " " : "", has_unit ? setting->unit : "");
}

/* Where the device is asked from now on. */
static void print_next(const change_t *change)
{
    const setting_t *const setting = change->setting;
    const station_t *const station = change->session->station;
    const model_t *const model = station->model;
    const fathom_modbus_unit_t *const unit = station->reader.unit;
    const fathom_line_settings_t *const line =
        unit->line_settings != NULL ? unit->line_settings : &station->line;
    char options[LINE_OPTIONS];
    if (!setting->moves) return;
    (void)printf("from now on: fathom read %s:%u:%s --port %s%s\n", model->name, unit->address,
                 station->mode->name, change->session->options.port,
                 line_options(line, &model->line, options));
}

static bool is_later(const change_t *change)
{
    const setting_t *const setting = change->setting;
    return setting->is_later != NULL && setting->is_later(&change->session->station->reader);
}

/* What has become of a setting, and whether it holds now is known. */
typedef enum {
    UNCHANGED,
    DONE, /* confirmed, or acknowledged where it cannot be read */
    UNCONFIRMED,
    DIFFERS,
    REFUSED,
    NOT_WRITTEN,
    SENT /* to all units */
} outcome_t;

static const char *const outcomes[] = {"unchanged, it had that value",
                                       "written",
                                       "written, not confirmed",
                                       "written, and it reads otherwise",
                                       "refused",
                                       "nothing was written",
                                       "sent, not confirmed"};

static bool is_read_back(const change_t *change)
{
    const setting_t *const setting = change->setting;
    return !change->is_blind && (setting->get != NULL || setting->moves || setting->confirmed != NULL);
}

static outcome_t outcome_of(const change_t *change, fathom_status_t status)
{
    const fathom_modbus_unit_t *const unit = change->session->station->reader.unit;
    const bool has_ended = unit->setting == 0;
    if (!unit->is_written) return status == FATHOM_READY ? UNCHANGED : NOT_WRITTEN;
    if (status == FATHOM_READY) return DONE;
    if (change->is_for_all) return unit->outcome == FATHOM_READY ? SENT : UNCONFIRMED;
    if (status == FATHOM_ERR_EXCEPTION) return REFUSED;
    const bool is_unknown =
        !has_ended || status == FATHOM_ERR_UNCONFIRMED || change->setting->confirmed != NULL;
    return is_unknown || !is_read_back(change) ? UNCONFIRMED : DIFFERS;
}

static void print_json(const change_t *change, outcome_t outcome)
{
    const station_t *const station = change->session->station;
    const bool is_written = outcome != UNCHANGED && outcome != NOT_WRITTEN;
    (void)printf("{\"sensor\": \"%s\", \"setting\": \"%s\", \"value\": ", station->model->name,
                 change->setting->name);
    session_print_json(stdout, change->wanted);
    (void)fputs(", \"was\": ", stdout);
    if (change->was[0] != '\0')
        session_print_json(stdout, change->was);
    else
        (void)fputs("null", stdout);
    (void)printf(", \"written\": %s, \"confirmed\": %s, \"outcome\": \"%s\", \"address\": %u}\n",
                 is_written ? "true" : "false",
                 outcome == UNCHANGED || (outcome == DONE && is_read_back(change)) ? "true" : "false",
                 outcomes[outcome], change->is_for_all ? 0u : (unsigned)station->reader.unit->address);
}

static void print_done(const change_t *change, outcome_t outcome)
{
    const setting_t *const setting = change->setting;
    (void)printf("%s: %s is ", change->session->station->name, setting->name);
    print_value(setting, change->wanted);
    if (is_later(change))
        (void)printf(" from the next power-on (%s until then)\n", change->was);
    else if (outcome == UNCHANGED)
        (void)printf(": %s\n", outcomes[UNCHANGED]);
    else if (setting->get != NULL)
        (void)printf(" (was %s)\n", change->was);
    else if (setting->moves || setting->confirmed != NULL)
        (void)printf("%s%s\n", setting->confirmed != NULL ? ": " : "",
                     setting->confirmed != NULL ? setting->confirmed : "");
    else
        (void)puts(" as far as the device has acknowledged it; it cannot be read back");
    if (outcome != UNCHANGED) print_next(change);
}

/* The two places at which the device may be, or what else is not known. */
static void print_unknown(FILE *to, const change_t *change)
{
    const station_t *const station = change->session->station;
    const setting_t *const setting = change->setting;
    const bool is_acknowledged =
        station->reader.unit->setting == 0 && station->reader.unit->outcome == FATHOM_READY;
    (void)fputs(is_acknowledged ? "it was acknowledged; " : "no acknowledgement came; ", to);
    if (setting->is_baud) {
        const uint32_t was = station->line.baud;
        (void)fprintf(to,
                      "it is at %" PRIu32 " or at %s baud, perhaps from the next power-on; try fathom scan "
                      "--port %s --baud %" PRIu32 ",%s",
                      was, change->wanted, change->session->options.port, was, change->wanted);
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

static void print_failed(const change_t *change, outcome_t outcome, fathom_status_t status)
{
    const fathom_modbus_unit_t *const unit = change->session->station->reader.unit;
    (void)fprintf(stderr, "fathom: %s: %s %s: %s: ", change->session->station->name, change->setting->name,
                  change->wanted, outcomes[outcome]);
    switch (outcome) {
    case UNCONFIRMED:
        print_unknown(stderr, change);
        break;
    case DIFFERS:
        (void)fprintf(stderr, "%s, and the device tells another value; perhaps this variant does not have it",
                      unit->outcome == FATHOM_READY ? "it was acknowledged" : "no acknowledgement came");
        break;
    case REFUSED:
        session_explain(change->session, status);
        break;
    default:
        print_not_written(change, status);
        break;
    }
    (void)fputs("\n", stderr);
}

/* What was asked for is done, and more than that cannot be known. */
static bool is_done_blind(const change_t *change, outcome_t outcome)
{
    const int8_t response = change->session->station->reader.unit->outcome;
    /* what came back is its acknowledgement, or may be: nothing was read that could tell an echo from one */
    const bool is_answered = response == FATHOM_READY || response == FATHOM_ERR_ECHO;
    return outcome == SENT || (change->is_blind && outcome == UNCONFIRMED && is_answered);
}

int set_report(const change_t *change, fathom_status_t status)
{
    const outcome_t outcome = outcome_of(change, status);
    const bool is_blind = is_done_blind(change, outcome);
    const bool is_done = outcome == UNCHANGED || outcome == DONE || is_blind;
    if (change->session->is_json) print_json(change, outcome);
    if (!is_done) {
        (void)fflush(stdout);
        print_failed(change, outcome, status);
    } else if (is_blind && !change->session->is_json) {
        (void)printf("%s: %s %s: %s\n", change->is_for_all ? "all units" : change->session->station->name,
                     change->setting->name, change->wanted, outcomes[outcome]);
    } else if (!change->session->is_json) {
        print_done(change, outcome);
    }
    if (fflush(stdout) != 0 || ferror(stdout)) {
        (void)fprintf(stderr, "fathom: the output cannot be written; the setting: %s\n", outcomes[outcome]);
        return STATUS_FAILED;
    }
    return is_done ? STATUS_OK : STATUS_FAILED;
}
