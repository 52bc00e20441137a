/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "cli/rows.h"
#include "commands/commands.h"
#include "device/session.h"

/* fathom set: one setting of one device, confirmed by reading it back where that can be. */

typedef struct {
    session_settings_t session;
    bool is_blind;
    bool is_for_all;
    bool may_be_lost; /* the old word for --yes with address 0 */
} set_settings_t;

static const option_t rows[] = {
    {"blind", .help = "Write once without reading, for a sensor that cannot be read", .group = GROUP_COMMAND,
     AT(set_settings_t, is_blind)},
    {"all-units", .help = "Write to every hps167s on the line, whatever its address", .group = GROUP_COMMAND,
     AT(set_settings_t, is_for_all)},
    {"may-not-be-found-again", .help = "Confirm address 0", .is_hidden = true,
     AT(set_settings_t, may_be_lost)},
    {.name = NULL},
};

static const option_table_t tables[] = {
    {session_yes_rows, 0}, {rows, 0}, SESSION_TABLES, {session_format_rows, 0}, {NULL, 0}};

static session_t session;

static fathom_status_t call_all(reader_t *reader, void *ctx)
{
    const change_t *const change = ctx;
    return session.sensor->model->set_all(reader, change->setting, change->value);
}

/* Some settings can have an effect that the sensor does not report. */
static void print_risk(const setting_t *setting)
{
    if (setting->risk == NULL) return;
    (void)fprintf(stderr,
                  "fathom: %s: %s. To check, measure a target at a known distance with 'fathom read', or use "
                  "'fathom calibrate'.\n",
                  setting->name, setting->risk);
}

static bool set(change_t *change)
{
    print_risk(change->setting);
    setting_print_value(change->setting, change->value, change->wanted);
    change->was[0] = '\0';
    if (change->is_for_all) return change_report(change, session_call(&session, call_all, change));
    if (change->is_blind) {
        reader_write_next_unchecked(session.sensor->reader);
    } else if (change->setting->read_at != 0) {
        const fathom_status_t status = session_get(&session, change->setting, change->was);
        if (status != FATHOM_OK) return change_report(change, status);
    }
    return change_report(change, session_set(&session, change->setting, change->value));
}

static bool set_kind(change_t *change, const arguments_t *arguments, const origin_t *origin)
{
    const set_settings_t *const settings = arguments->settings;
    const setting_t *const setting = change->setting;
    change->is_blind = settings->is_blind;
    change->is_for_all = settings->is_for_all;
    if (change->is_blind && change->is_for_all)
        return reject(origin, "--all-units reads nothing anyway. Leave --blind out.");
    if (change->is_blind && setting->is_never_blind)
        return reject(origin, "%s must be read before or after it is written. Leave --blind out.",
                      setting->name);
    if (change->is_for_all && !setting->has_broadcast)
        return reject(origin,
                      "%s belongs to one unit. --all-units is for termination and "
                      "measure-after-power-on of an hps167s.",
                      setting->name);
    return !change->is_for_all ||
           confirm(arguments, settings->session.is_confirmed,
                   "--all-units changes every hps167s on the line, whatever its address.");
}

static bool set_value(change_t *change, const char *text, const arguments_t *arguments,
                      const origin_t *origin)
{
    const set_settings_t *const settings = arguments->settings;
    const setting_t *const setting = change->setting;
    char values[SETTING_VALUES];
    if (setting->has_zero && strcmp(text, "0") == 0)
        return confirm(
            arguments, settings->session.is_confirmed || settings->may_be_lost,
            "A unit at address 0 may not be found again, and none of its settings can be changed.");
    if (setting_value(setting, text, &change->value)) return true;
    return reject(origin, "%s is '%s'. It takes %s.", setting->name, text,
                  setting_values_text(setting, values));
}

static bool set_up(change_t *change, const arguments_t *arguments)
{
    const origin_t origin = {.command = arguments->command->name};
    if (!session_read(&session, arguments, 1, 2)) return false;
    if (arguments->count == 2 && strchr(arguments->words[1], '=') != NULL) {
        const int length = (int)strcspn(arguments->words[1], "=");
        return reject(&origin, "the setting and its value are two words. Write: %.*s %s.", length,
                      arguments->words[1], arguments->words[1] + length + 1);
    }
    if (arguments->count < 3)
        return reject(&origin, "the %s is missing. 'fathom get %s' lists the settings.",
                      arguments->count == 1 ? "setting" : "value", session.sensor->model->name);
    const setting_t *const setting = setting_named(&session, arguments->words[1], arguments);
    if (setting == NULL) return false;
    if (setting->effect == NULL) return reject(&origin, "%s is read-only.", setting->name);
    change->setting = setting;
    return session_set_mode(&session, arguments, model_mode_of(session.sensor->model, setting)) &&
           session_can_set(&session, arguments) &&
           set_value(change, arguments->words[2], arguments, &origin) && set_kind(change, arguments, &origin);
}

static int start(const host_t *host, const arguments_t *arguments)
{
    change_t change = {.session = &session};
    if (!set_up(&change, arguments)) return STATUS_USAGE;
    if (!session_open(&session, host)) return STATUS_FAILED;
    const bool is_set = set(&change);
    session_close(&session);
    return is_set ? STATUS_OK : STATUS_FAILED;
}

const command_t set_command = {
    .name = "set",
    .summary = "Change a setting of a sensor and read it back if possible",
    .usage = "SENSOR[:ADDRESS][:MODE][@PORT] SETTING VALUE [OPTIONS]",
    .about = "A value that the sensor has already is not written. The command follows a\n"
             "sensor to its new address or baud rate. A write-only setting ('fathom get\n"
             "SENSOR' lists them) cannot be read back: its write is acknowledged only.\n",
    .tables = tables,
    .common = "port address baud yes format",
    .examples = "  fathom set hps167s --port /dev/ttyUSB0 address 7\n"
                "  fathom set hps167s:7 --port /dev/ttyUSB0 termination off\n"
                "  fathom set hps167s --port /dev/ttyUSB0 termination off --all-units --yes\n"
                "  fathom set a16 --port /dev/ttyUSB0 switch-threshold 2000\n"
                "  fathom set hps167s --port /dev/ttyUSB0 distance-offset -15\n",
    .status = "Exit status: 0 the setting holds, was acknowledged or was sent to all units,\n"
              "1 it does not or that is unknown, 2 wrong usage.\n",
    .topics = "settings, sensors, ports",
    .operands = OPERANDS_SETTING_VALUE,
    .settings_size = sizeof(set_settings_t),
    .start = start,
};
