/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "cli/session_options.h"
#include "commands/commands.h"
#include "device/set_report.h"
#include "device/setting_text.h"

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

static fathom_status_t call_all(reader_t *reader, void *ctx)
{
    const change_t *const change = ctx;
    return change->setting->set_all(reader, change->setting, change->value);
}

static int set(change_t *change)
{
    setting_print_value(change->setting, change->value, change->wanted);
    change->was[0] = '\0';
    if (change->is_for_all) return set_report(change, session_call(&session, call_all, change));
    if (change->is_blind) {
        reader_write_next_unchecked(session.station->reader);
    } else if (change->setting->get != NULL) {
        const fathom_status_t status = session_get(&session, change->setting, change->was);
        if (status != FATHOM_OK) return set_report(change, status);
    }
    return set_report(change, session_set(&session, change->setting, change->value));
}

static void help(FILE *to)
{
    (void)fputs("fathom set changes a setting of a device: it asks for the value, writes it if it is another "
                "one, and "
                "reads it\nback. It follows a device to its new address or baud rate.\n\n"
                "usage: fathom set SENSOR[:ADDRESS][:MODE][@PORT] [--port PATH] SETTING VALUE [OPTIONS]\n\n"
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
        "  --yes             says so, of --all-units\n"
        "  --may-not-be-found-again   for address 0 of an a16 or a05, at which it can be read and not set\n"
        "\nA new address is asked first whether a device is there. What the device does not tell is written "
        "without a look.\n"
        "The status is unchanged (the sensor had this value), written, not_written, not_confirmed (written, "
        "but not "
        "read\nback), differs (it reads back another value), refused, or sent (to all units).\n"
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
    change_t change = {.session = &session};
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
        !session_set_mode(&session, command, values, model_mode_of(session.station->model, setting)) ||
        !take_kind(&change, values))
        return STATUS_USAGE;
    if (!session_can_set(&session, command)) return STATUS_USAGE;
    if (!session_open(&session, host)) return STATUS_FAILED;
    const int status = set(&change);
    session_close(&session);
    return status;
}

const command_t set_command = {
    .name = "set", .summary = "changes a setting of a device and confirms it", .help = help, .run = run};
