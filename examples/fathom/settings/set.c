/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <string.h>

#include "commands.h"
#include "settings/session.h"
#include "settings/setting_text.h"
#include "shared/line_text.h"

/* fathom set: one setting of one device, confirmed by reading it back where that can be. */

static const char command[] = "set";
static session_t session;

enum { BLIND = SESSION_OPTIONS, ALL_UNITS, YES, LOST, OPTIONS };

static const struct option table[OPTIONS + 1] = {
    SESSION_OPTION_ROWS,
    [BLIND] = {"blind", no_argument, NULL, 256},
    [ALL_UNITS] = {"all-units", no_argument, NULL, 256},
    [YES] = {"yes", no_argument, NULL, 256},
    [LOST] = {"may-not-be-found-again", no_argument, NULL, 256},
};

static void print_value(const setting_t *setting, const char *text)
{
    const bool has_unit = setting->unit != NULL && setting->words == NULL;
    (void)printf("%s%s%s", text, has_unit ? " " : "", has_unit ? setting->unit : "");
}

/* Where the device is asked from now on. */
static void print_next(const setting_t *setting)
{
    const station_t *const station = session.station;
    const model_t *const model = station->model;
    const fathom_modbus_unit_t *const unit = station->reader.unit;
    const fathom_line_settings_t *const line = unit->settings != NULL ? unit->settings : &station->line;
    char options[LINE_OPTIONS];
    if (!setting->moves) return;
    (void)printf("from now on: fathom read %s:%u:%s --port %s%s\n", model->name, unit->address,
                 station->mode->name, session.options.port, line_options(line, &model->line, options));
}

static bool is_later(const setting_t *setting)
{
    return setting->is_later != NULL && setting->is_later(&session.station->reader);
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

typedef struct {
    const setting_t *setting;
    int32_t value;
    char wanted[SETTING_TEXT];
    char was[SETTING_TEXT]; /* "": it was not read */
    bool is_blind;
    bool is_for_all;
} change_t;

static bool is_read_back(const change_t *change)
{
    const setting_t *const setting = change->setting;
    return !change->is_blind && (setting->get != NULL || setting->moves || setting->confirmed != NULL);
}

static outcome_t outcome_of(const change_t *change, fathom_status_t status)
{
    const fathom_modbus_unit_t *const unit = session.station->reader.unit;
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
    const station_t *const station = session.station;
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
    (void)printf("%s: %s is ", session.station->name, setting->name);
    print_value(setting, change->wanted);
    if (is_later(setting))
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
    if (outcome != UNCHANGED) print_next(setting);
}

/* The two places at which the device may be, or what else is not known. */
static void print_unknown(FILE *to, const change_t *change)
{
    const station_t *const station = session.station;
    const setting_t *const setting = change->setting;
    const bool is_acknowledged =
        station->reader.unit->setting == 0 && station->reader.unit->outcome == FATHOM_READY;
    (void)fputs(is_acknowledged ? "it was acknowledged; " : "no acknowledgement came; ", to);
    if (setting->is_baud) {
        const uint32_t was = station->line.baud;
        (void)fprintf(to,
                      "it is at %" PRIu32 " or at %s baud, perhaps from the next power-on; try fathom scan "
                      "--port %s --baud %" PRIu32 ",%s",
                      was, change->wanted, session.options.port, was, change->wanted);
    } else if (setting->moves) {
        char line[LINE_TEXT];
        (void)fprintf(to, "it is at address %u or at address %s, %s; try fathom read with either",
                      station->address, change->wanted, session_line_text(&session, line));
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
        session_explain(&session, status);
        break;
    }
}

static void print_failed(const change_t *change, outcome_t outcome, fathom_status_t status)
{
    const fathom_modbus_unit_t *const unit = session.station->reader.unit;
    (void)fprintf(stderr, "fathom: %s: %s %s: %s: ", session.station->name, change->setting->name,
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
        session_explain(&session, status);
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
    const int8_t answer = session.station->reader.unit->outcome;
    /* what came back is its acknowledgement, or may be: nothing was read that could tell an echo from one */
    const bool is_answered = answer == FATHOM_READY || answer == FATHOM_ERR_ECHO;
    return outcome == SENT || (change->is_blind && outcome == UNCONFIRMED && is_answered);
}

static int tell(const change_t *change, fathom_status_t status)
{
    const outcome_t outcome = outcome_of(change, status);
    const bool is_blind = is_done_blind(change, outcome);
    const bool is_done = outcome == UNCHANGED || outcome == DONE || is_blind;
    if (session.is_json) print_json(change, outcome);
    if (!is_done) {
        (void)fflush(stdout);
        print_failed(change, outcome, status);
    } else if (is_blind && !session.is_json) {
        (void)printf("%s: %s %s: %s\n", change->is_for_all ? "all units" : session.station->name,
                     change->setting->name, change->wanted, outcomes[outcome]);
    } else if (!session.is_json) {
        print_done(change, outcome);
    }
    if (fflush(stdout) != 0 || ferror(stdout)) {
        (void)fprintf(stderr, "fathom: the output cannot be written; the setting: %s\n", outcomes[outcome]);
        return STATUS_FAILED;
    }
    return is_done ? STATUS_OK : STATUS_FAILED;
}

static fathom_status_t call_all(reader_t *reader, void *ctx)
{
    const change_t *const change = ctx;
    return change->setting->set_all(reader, change->value);
}

static int set(change_t *change)
{
    setting_print_value(change->setting, change->value, change->wanted);
    change->was[0] = '\0';
    if (change->is_for_all) return tell(change, session_call(&session, call_all, change));
    if (change->is_blind) {
        (void)fathom_modbus_next_is_blind(session.station->reader.unit);
    } else if (change->setting->get != NULL) {
        const fathom_status_t status = session_get(&session, change->setting, change->was);
        if (status != FATHOM_READY) return tell(change, status);
    }
    return tell(change, session_set(&session, change->setting, change->value));
}

static void help(FILE *to)
{
    (void)fputs("fathom set changes a setting of a device: it asks for the value, writes it if it is another "
                "one, and "
                "reads it\nback. It follows a device to its new address or baud rate.\n\n"
                "usage: fathom set SENSOR[:ADDRESS[:MODE]] --port PATH SETTING VALUE [OPTIONS]\n\n"
                "`fathom get SENSOR` lists the settings, their values, and when they take effect.\n\n",
                to);
    session_options_help(to);
    (void)fputs(
        "  --blind           write it once without reading anything, for a device whose settings cannot be "
        "made out;\n"
        "                    not for an address of a16 and a05 nor a distance-offset\n"
        "  --all-units       tell every hps167s on the line at once, whatever its address; for termination "
        "and\n"
        "                    measure-after-power-on, and with --yes only\n"
        "  --may-not-be-found-again   for address 0 of an a16 or a05, at which it can be read and not set\n"
        "\nA new address is asked first whether a device is there. What the device does not tell is written "
        "without a look.\n"
        "What became of it is said: unchanged, it had that value; nothing was written; written, not "
        "confirmed; written,\nand it reads otherwise. Of --all-units: sent, not confirmed.\n"
        "Exit status: 0 when it holds (or was acknowledged, where it is not read), or was sent to all units; "
        "1 when not\nor when that is not known, 2 for wrong usage.\n\n"
        "examples:\n"
        "  fathom set hps167s --port /dev/ttyUSB0 address 7\n"
        "  fathom set hps167s:7 --port /dev/ttyUSB0 termination off\n"
        "  fathom set hps167s --port /dev/ttyUSB0 baud 115200\n"
        "  fathom set hps167s --port /dev/ttyUSB0 termination off --all-units --yes\n"
        "  fathom set a16 --port /dev/ttyUSB0 switch-threshold 2000\n"
        "  fathom set hps167s --port /dev/ttyUSB0 distance-offset -15\n",
        to);
}

enum { MAX_WORDS = 64 };

/* A negative value at the end is no option: "--" says so. The words are copied to `copy`, ended by NULL. */
static char **mark_negative(int *argc, char **argv, char *copy[MAX_WORDS])
{
    static char dashes[] = "--";
    const char *const last = argv[*argc - 1];
    bool is_marked = *argc + 2 > MAX_WORDS || last[0] != '-' || last[1] < '0' || last[1] > '9';
    for (int i = 0; i != *argc && !is_marked; i++) is_marked = strcmp(argv[i], dashes) == 0;
    if (is_marked) return argv;
    for (int i = 0; i != *argc; i++) copy[i < *argc - 1 ? i : i + 1] = argv[i];
    copy[*argc - 1] = dashes;
    copy[++*argc] = NULL;
    return copy;
}

/* False after a usage error. */
static bool take_kind(change_t *change, const char *const *values)
{
    const setting_t *const setting = change->setting;
    change->is_blind = values[BLIND] != NULL;
    change->is_for_all = values[ALL_UNITS] != NULL;
    if (change->is_blind && change->is_for_all)
        (void)usage_error(command, "--all-units reads nothing anyway; leave --blind out");
    else if (change->is_blind && setting->is_never_blind)
        (void)usage_error(command, "%s is not written --blind: it has to be read before or afterwards",
                          setting->name);
    else if (change->is_for_all && setting->set_all == NULL)
        (void)usage_error(command,
                          "%s is of one unit; --all-units is for termination and "
                          "measure-after-power-on of an hps167s",
                          setting->name);
    else if (change->is_for_all && values[YES] == NULL)
        (void)usage_error(
            command,
            "with --all-units every hps167s on the line obeys, whatever its address: say so by --yes");
    else
        return true;
    return false;
}

/* The value; address 0 only if the user says what that means. False after a usage error. */
static bool take_value(change_t *change, const char *text, bool may_be_lost)
{
    const setting_t *const setting = change->setting;
    const bool is_zero = setting->has_zero && strcmp(text, "0") == 0;
    if (is_zero == may_be_lost) return is_zero || setting_parse(command, setting, text, &change->value);
    (void)usage_error(
        command, is_zero ? "a unit at address 0 may not be found again, and nothing of it can be set any "
                           "more; if it is to be so: --may-not-be-found-again"
                         : "--may-not-be-found-again is for address 0 of an a16 or a05");
    return false;
}

static int run(const host_t *host, int argc, char **argv)
{
    char *copy[MAX_WORDS];
    argv = mark_negative(&argc, argv, copy);
    const char *values[OPTIONS] = {NULL};
    char **words = NULL;
    int count = 0;
    change_t change = {0};
    bool wants_help = false;
    if (!session_options(&session, command, argc, argv, table, values, &words, &count, &wants_help))
        return STATUS_USAGE;
    if (wants_help) return command_help(&set_command);
    const char *const model = session.station->model->name;
    if (count != 2)
        return usage_error(command,
                           count == 0   ? "which setting? `fathom get %s` lists them"
                           : count == 1 ? "a value is missing; `fathom get %s` lists them"
                                        : "one setting and one value of %s at a time",
                           model);
    const setting_t *const setting = setting_find(command, model, session_settings(&session), words[0]);
    if (setting == NULL) return STATUS_USAGE;
    if (setting->set == NULL)
        return usage_error(command, "%s is told by the device and cannot be set", setting->name);
    change.setting = setting;
    if (!take_value(&change, words[1], values[LOST] != NULL) ||
        !session_set_mode(&session, command, values, setting->mode) || !take_kind(&change, values))
        return STATUS_USAGE;
    if (session.station->address == 0)
        return usage_error(command,
                           "what is written to address 0 goes to all units, so nothing can be set there");
    if (!session_open(&session, host)) return STATUS_FAILED;
    const int status = set(&change);
    session_close(&session);
    return status;
}

const command_t set_command = {"set", "changes a setting of a device and confirms it", help, run};
