/* SPDX-License-Identifier: MIT */
#include <limits.h>
#include <string.h>

#include "cli/rows.h"
#include "commands/commands.h"
#include "device/session.h"
#include "ports/port.h"

/* fathom info and get print values of a sensor, set changes one of them, and reset discards settings of an HPS-167S. */

static session_t session;

/* ---- fathom info, fathom get ---- */

static values_t values;

/* The sensor responds at its address, so the address is known also if no register has it. */
static bool is_address(const setting_t *setting) { return strcmp(setting->name, "address") == 0; }

static bool has_text(const value_t *value)
{
    return value->held == HELD_VALUE || value->held == HELD_NOT_SETTABLE;
}

static void print_text(void)
{
    const sensor_t *const sensor = session.sensor;
    const bool has_name = session.site.sensor_count > 1 || sensor->has_own_name;
    char line[LINE_TEXT];
    char cell[SETTING_CELL];
    (void)printf("%s%s%s%s, %s, at address %u, %s\n", sensor != session.site.sensors[0] ? "\n" : "",
                 has_name ? sensor->name : "", has_name ? ": " : "", sensor->model->name, sensor->model->what,
                 sensor->address, session_line_text(&session, line));
    for (const value_t *value = values.rows; value->setting != NULL; value++)
        if (has_text(value))
            (void)printf("%-26s %s\n", value->setting->name,
                         setting_with_unit(value->setting, value->text, cell));
        else if (value->held != HELD_NOTHING)
            (void)printf("%-26s - (%s)\n", value->setting->name,
                         value->held == HELD_NOT_THERE ? setting_reason(value->status) : "write-only");
}

/* `address` is the value that the sensor reports, or the address of the requests if none of the values is an address. */
static void print_json(void)
{
    json_t json = {.to = stdout};
    char line[LINE_TEXT];
    bool has_address = false;
    for (const value_t *value = values.rows; value->setting != NULL; value++)
        if (is_address(value->setting)) has_address = true;
    json_begin(&json, NULL, '{');
    sensor_json(&json, session.sensor);
    if (!has_address) json_value(&json, "address", "%u", session.sensor->address);
    json_string(&json, "line", session_line_text(&session, line));
    for (const value_t *value = values.rows; value->setting != NULL; value++)
        if (has_text(value) || value->held == HELD_NOT_THERE)
            setting_json(&json, NULL, value->setting, has_text(value) ? value->text : NULL);
    json_end(&json, '}');
    (void)fputc('\n', stdout);
}

/* Prints on stderr what the user should know about the values. Returns true if all were read. */
static bool print_remarks(void)
{
    size_t all = 0;
    size_t missing = 0;
    for (const value_t *value = values.rows; value->setting != NULL; value++, all++) {
        const setting_t *const setting = value->setting;
        if (!has_text(value) && value->held != HELD_NOT_READABLE) missing++;
        if (setting->remark != NULL && has_text(value) && strcmp(value->text, setting->words[1]) == 0)
            (void)session_fail(&session, FATHOM_OK, "%s with 'fathom set %s:%u --port %s %s %s'",
                               setting->remark, session.sensor->model->name, session.sensor->address,
                               session.sensor->port->path, setting->name, setting->words[0]);
    }
    if (values.is_known && missing != 0)
        (void)session_fail(&session, FATHOM_OK, "%zu of %zu values could not be read.", missing, all);
    return missing == 0;
}

static const setting_t *shown; /* by fathom get SENSOR SETTING */

static bool is_in_mode(const setting_t *setting)
{
    return model_mode_of(session.sensor->model, setting) == session.sensor->mode;
}
static bool is_readable(const setting_t *setting) { return setting->read_at != 0 && is_in_mode(setting); }
static bool is_settable(const setting_t *setting) { return setting->effect != NULL && is_in_mode(setting); }
static bool is_shown(const setting_t *setting) { return setting == shown; }

static int show(const host_t *host, bool (*is_wanted)(const setting_t *setting))
{
    values_begin(&values, session.sensor->model, is_wanted);
    if (!session_open(&session, host)) return STATUS_FAILED;
    const bool is_read = values_read(&session, &values, false);
    if (values.is_known && session.is_json) print_json();
    if (values.is_known && !session.is_json) print_text();
    const bool is_good = is_output_written() && print_remarks() && is_read;
    session_close(&session);
    return is_good ? STATUS_OK : STATUS_FAILED;
}

/* A sensor that fails keeps none of the others from being read. */
static int start_info(const host_t *host, const arguments_t *arguments)
{
    int status = STATUS_OK;
    if (!session_read(&session, arguments, INT_MAX, 0)) return STATUS_USAGE;
    for (size_t i = 0; i != session.site.sensor_count; i++) {
        if (i != 0 && host->has_ended(host->ctx)) return STATUS_FAILED;
        session.sensor = session.site.sensors[i];
        if (show(host, is_readable) != STATUS_OK) status = STATUS_FAILED;
    }
    return status;
}

/* Lists the settings of a sensor without a port. */
static int list(const arguments_t *arguments)
{
    const char *const word = arguments->words[0];
    char name[16];
    (void)snprintf(name, sizeof name, "%.*s", (int)strcspn(word, ":"), word);
    const model_t *const model = model_word(name, &arguments->origin);
    if (model == NULL) return STATUS_USAGE;
    (void)printf("%s, %s, has these settings. Add --port PORT to read their values.\n\n", model->name,
                 model->what);
    settings_print(stdout, model->settings);
    return is_output_written() ? STATUS_OK : STATUS_FAILED;
}

static int start_get(const host_t *host, const arguments_t *arguments)
{
    const session_settings_t *const settings = arguments->settings;
    if (arguments->count == 1 && settings->sensors.defaults.path == NULL &&
        strchr(arguments->words[0], '@') == NULL)
        return list(arguments);
    if (!session_read(&session, arguments, 1, 1)) return STATUS_USAGE;
    if (arguments->count == 1) return show(host, is_settable);
    shown = setting_named(&session, arguments->words[1], arguments);
    if (shown == NULL) return STATUS_USAGE;
    if (shown->read_at == 0 && !is_address(shown)) {
        (void)reject(&arguments->origin, "%s is write-only. The sensor does not report it.", shown->name);
        return STATUS_USAGE;
    }
    if (!session_set_mode(&session, arguments, model_mode_of(session.sensor->model, shown)))
        return STATUS_USAGE;
    return show(host, is_shown);
}

static const option_table_t show_tables[] = {SESSION_TABLES, {session_format_rows, 0}, {NULL, 0}};

const command_t info_command = {
    .name = "info",
    .summary = "Print all versions, settings and values of sensors",
    .usage = "[NAME=]SENSOR[:ADDRESS][:MODE][@PORT]... [OPTIONS]",
    .tables = show_tables,
    .common = "port address mode baud format",
    .examples = "  fathom info hps167s:7 --port /dev/ttyUSB0\n"
                "  fathom info a05 --port /dev/ttyUSB0 --format json\n"
                "  fathom info tank=a16@/dev/ttyUSB0 gate=hps167s:7@/dev/ttyUSB1,baud=57600\n",
    .status = "Exit status: 0 all was read, 1 a part was not, 2 wrong usage.\n",
    .topics = "settings, sensors, ports",
    .operands = OPERANDS_ASKED,
    .settings_size = sizeof(session_settings_t),
    .start = start_info,
};

const command_t get_command = {
    .name = "get",
    .summary = "Print a setting of a sensor, or all of them",
    .usage = "SENSOR[:ADDRESS][:MODE][@PORT] [SETTING] [OPTIONS]",
    .about = "Without a port, the settings and their possible values are listed.\n",
    .tables = show_tables,
    .common = "port address mode baud format",
    .examples = "  fathom get hps167s\n"
                "  fathom get hps167s:7 --port /dev/ttyUSB0\n"
                "  fathom get hps167s:7 --port /dev/ttyUSB0 termination\n",
    .status = "Exit status: 0 all was read, 1 a part was not, 2 wrong usage.\n",
    .topics = "settings, sensors, ports",
    .operands = OPERANDS_SETTING,
    .settings_size = sizeof(session_settings_t),
    .start = start_get,
};

/* ---- fathom set ---- */

typedef struct {
    session_settings_t session;
    bool is_blind;
    bool is_for_all;
} set_settings_t;

static fathom_status_t call_all(reader_t *reader, void *ctx)
{
    const change_t *const change = ctx;
    return session.sensor->model->set_all(reader, change->setting, change->value);
}

static bool set(change_t *change)
{
    const setting_t *const setting = change->setting;
    if (setting->risk != NULL)
        (void)fprintf(stderr,
                      "fathom: %s: %s. To check, measure a target at a known distance with 'fathom read', or "
                      "use 'fathom calibrate'.\n",
                      setting->name, setting->risk);
    setting_print_value(setting, change->value, change->wanted);
    if (change->is_for_all) return change_report(change, session_call(&session, call_all, change));
    if (change->is_blind) {
        reader_write_next_unchecked(session.sensor->reader);
    } else if (setting->read_at != 0) {
        const fathom_status_t status = session_get(&session, setting, change->was);
        if (status != FATHOM_OK) return change_report(change, status);
    }
    return change_report(change, session_set(&session, setting, change->value));
}

static bool suits(const change_t *change, const arguments_t *arguments)
{
    const setting_t *const setting = change->setting;
    const set_settings_t *const settings = arguments->settings;
    if (change->is_blind && change->is_for_all)
        return reject(&arguments->origin, "--all-units reads nothing anyway. Leave --blind out.");
    if (change->is_blind && setting->is_never_blind)
        return reject(&arguments->origin, "%s must be read before or after it is written. Leave --blind out.",
                      setting->name);
    if (change->is_for_all && !setting->has_broadcast)
        return reject(&arguments->origin,
                      "%s belongs to one unit. --all-units is for termination and "
                      "measure-after-power-on of an hps167s.",
                      setting->name);
    return !change->is_for_all ||
           confirm(arguments, settings->session.is_confirmed,
                   "--all-units changes every hps167s on the line, whatever its address.");
}

/* Stores the value. Returns false after rejecting it. */
static bool read_value(change_t *change, const arguments_t *arguments)
{
    const setting_t *const setting = change->setting;
    const set_settings_t *const settings = arguments->settings;
    if (!setting_value(setting, arguments->words[2], &change->value)) {
        char text[SETTING_VALUES];
        return reject(&arguments->origin, "%s is '%s'. It takes %s.", setting->name, arguments->words[2],
                      setting_values_text(setting, text));
    }
    return !setting->has_zero || change->value != 0 ||
           confirm(arguments, settings->session.is_confirmed,
                   "A unit at address 0 may not be found again, and none of its settings can be changed.");
}

static bool set_up_change(change_t *change, const arguments_t *arguments)
{
    if (!session_read(&session, arguments, 1, 2)) return false;
    if (arguments->count == 2 && strchr(arguments->words[1], '=') != NULL) {
        const int length = (int)strcspn(arguments->words[1], "=");
        return reject(&arguments->origin, "the setting and its value are two words. Write: %.*s %s.", length,
                      arguments->words[1], arguments->words[1] + length + 1);
    }
    if (arguments->count < 3)
        return reject(&arguments->origin, "the %s is missing. 'fathom get %s' lists the settings.",
                      arguments->count == 1 ? "setting" : "value", session.sensor->model->name);
    change->setting = setting_named(&session, arguments->words[1], arguments);
    if (change->setting == NULL) return false;
    if (change->setting->effect == NULL)
        return reject(&arguments->origin, "%s is read-only.", change->setting->name);
    return session_set_mode(&session, arguments, model_mode_of(session.sensor->model, change->setting)) &&
           session_can_set(&session, arguments) && read_value(change, arguments) && suits(change, arguments);
}

static int start_set(const host_t *host, const arguments_t *arguments)
{
    const set_settings_t *const settings = arguments->settings;
    change_t change = {
        .session = &session, .is_blind = settings->is_blind, .is_for_all = settings->is_for_all};
    if (!set_up_change(&change, arguments)) return STATUS_USAGE;
    if (!session_open(&session, host)) return STATUS_FAILED;
    const bool is_set = set(&change);
    session_close(&session);
    return is_set ? STATUS_OK : STATUS_FAILED;
}

static const option_t set_rows[] = {
    {"blind", .help = "Write once without reading, for a sensor that cannot be read", .group = GROUP_COMMAND,
     AT(set_settings_t, is_blind)},
    {"all-units", .help = "Write to every hps167s on the line, whatever its address", .group = GROUP_COMMAND,
     AT(set_settings_t, is_for_all)},
    {"may-not-be-found-again", .help = "The old word for --yes", .is_hidden = true,
     AT(set_settings_t, session.is_confirmed)},
    {.name = NULL},
};

static const option_table_t set_tables[] = {
    {session_yes_rows, 0}, {set_rows, 0}, SESSION_TABLES, {session_format_rows, 0}, {NULL, 0}};

const command_t set_command = {
    .name = "set",
    .summary = "Change a setting of a sensor and read it back if possible",
    .usage = "SENSOR[:ADDRESS][:MODE][@PORT] SETTING VALUE [OPTIONS]",
    .about = "A value that the sensor has already is not written. The command follows a\n"
             "sensor to its new address or baud rate. A write-only setting ('fathom get\n"
             "SENSOR' lists them) cannot be read back: its write is acknowledged only.\n",
    .tables = set_tables,
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
    .start = start_set,
};

/* ---- fathom reset: two commands of an HPS-167S, which nothing else sends ---- */

typedef struct {
    session_settings_t session;
    bool is_interface; /* the old words for the operand and --yes */
    bool is_sensor;
} reset_settings_t;

static fathom_status_t call_reset(reader_t *reader, void *ctx)
{
    const bool *const is_interface = ctx;
    return *is_interface ? session.sensor->model->reset_interface(reader)
                         : session.sensor->model->reset_sensor(reader);
}

static void print_reset(bool is_interface)
{
    if (is_interface)
        (void)printf("%s: the interface has its factory settings: address 1, 19200 8E1, termination on\n"
                     "from now on: fathom read hps167s --port %s\n",
                     session.sensor->name, session.sensor->port->path);
    else
        (void)printf(
            "%s: the sensor acknowledged that it loads its factory settings; they cannot be read back\n",
            session.sensor->name);
}

/* Prints why the reset is not confirmed. Returns false. */
static bool fail_reset(bool is_interface, fathom_status_t status)
{
    const sensor_t *const sensor = session.sensor;
    if (status == FATHOM_ERR_UNCONFIRMED && is_interface) {
        char line[LINE_TEXT];
        return session_fail(&session, FATHOM_OK,
                            "the reset was sent, but then the sensor could not be read. It is at address 1, "
                            "19200 8E1, or still at address %u, %s. Run 'fathom scan --port %s'",
                            sensor->address, line_text(&sensor->line, line), sensor->port->path);
    }
    if (status == FATHOM_ERR_UNCONFIRMED)
        return session_fail(&session, FATHOM_OK,
                            "the reset was sent, and no acknowledgement was received. The sensor may have "
                            "its factory settings or not; they cannot be read back");
    const bool is_sent = reader_facts(sensor->reader).is_written;
    return session_fail(&session, status, "%s",
                        !is_sent                         ? "nothing was written"
                        : status == FATHOM_ERR_EXCEPTION ? "the reset was refused"
                                                         : "the reset was sent, and is not confirmed");
}

static bool set_up_reset(const arguments_t *arguments, bool *is_interface)
{
    const reset_settings_t *const settings = arguments->settings;
    if (!session_read(&session, arguments, 1, 1)) return false;
    if (session.sensor->model->reset_interface == NULL)
        return reject(&arguments->origin, "%s cannot be reset. Only an hps167s can.",
                      session.sensor->model->name);
    const char *const word = arguments->count == 2    ? arguments->words[1]
                             : settings->is_interface ? "interface"
                             : settings->is_sensor    ? "sensor"
                                                      : "";
    if (word[0] == '\0') return reject(&arguments->origin, "say what to reset: interface or sensor.");
    *is_interface = strcmp(word, "interface") == 0;
    if (!*is_interface && strcmp(word, "sensor") != 0)
        return reject(&arguments->origin, "what is to be reset is '%s'. Write interface or sensor.", word);
    if (settings->is_interface && settings->is_sensor)
        return reject(&arguments->origin, "only one of interface and sensor can be reset at a time.");
    return confirm(arguments, settings->session.is_confirmed || settings->is_interface || settings->is_sensor,
                   *is_interface ? "This sets %s to address 1, 19200 8E1, and termination on."
                                 : "This overwrites the filter and the distance offset of %s.",
                   session.sensor->name);
}

static int start_reset(const host_t *host, const arguments_t *arguments)
{
    bool is_interface = false;
    if (!set_up_reset(arguments, &is_interface)) return STATUS_USAGE;
    if (!session_open(&session, host)) return STATUS_FAILED;
    const fathom_status_t status = session_call(&session, call_reset, &is_interface);
    if (status == FATHOM_OK) print_reset(is_interface);
    const bool is_reset = status == FATHOM_OK ? is_output_written() : fail_reset(is_interface, status);
    session_close(&session);
    return is_reset ? STATUS_OK : STATUS_FAILED;
}

static const option_t reset_rows[] = {
    {"yes-restore-factory-settings", .help = "Reset the interface", .is_hidden = true,
     AT(reset_settings_t, is_interface)},
    {"yes-load-factory-sensor-settings", .help = "Reset the sensor", .is_hidden = true,
     AT(reset_settings_t, is_sensor)},
    {.name = NULL},
};

static const option_table_t reset_tables[] = {
    {session_yes_rows, 0}, {reset_rows, 0}, SESSION_TABLES, {NULL, 0}};

const command_t reset_command = {
    .name = "reset",
    .summary = "Restore the factory settings of an hps167s",
    .usage = "hps167s[:ADDRESS][@PORT] interface [OPTIONS]\nhps167s[:ADDRESS][@PORT] sensor [OPTIONS]",
    .about = "\n  interface  the RS485 interface (#6): address 1, 19200 8E1, termination on\n"
             "  sensor     the sensor behind it (#13): its filter and its distance offset\n",
    .tables = reset_tables,
    .common = "port address baud yes timeout",
    .examples = "  fathom reset hps167s:7 interface --port /dev/ttyUSB0 --yes\n",
    .status = "Before you reset one of several units, make sure that no other has address 1.\n"
              "Exit status: 0 done, 1 not done or unknown, 2 wrong usage.\n",
    .topics = "settings, ports",
    .operands = OPERANDS_RESETTABLE,
    .settings_size = sizeof(reset_settings_t),
    .start = start_reset,
};
