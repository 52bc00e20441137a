/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "cli/rows.h"
#include "commands/commands.h"
#include "ports/port_options.h"

/* fathom reset sends the two commands of an HPS-167S that discard settings. Nothing else sends them. */

typedef struct {
    session_settings_t session;
    bool restores_interface; /* the old words for the operand and --yes */
    bool restores_sensor;
} reset_settings_t;

static const option_t rows[] = {
    {"yes-restore-factory-settings", .help = "Reset the interface", .is_hidden = true,
     AT(reset_settings_t, restores_interface)},
    {"yes-load-factory-sensor-settings", .help = "Reset the sensor", .is_hidden = true,
     AT(reset_settings_t, restores_sensor)},
    {.name = NULL},
};

static const option_table_t tables[] = {
    {session_yes_rows, 0}, {rows, 0}, SESSION_TABLES, {session_format_rows, 0}, {NULL, 0}};

static session_t session;

static fathom_status_t restore(reader_t *reader, void *ctx)
{
    (void)ctx;
    return session.sensor->model->reset_interface(reader);
}

static fathom_status_t load(reader_t *reader, void *ctx)
{
    (void)ctx;
    return session.sensor->model->reset_sensor(reader);
}

static int print_done(bool is_restore)
{
    if (is_restore)
        (void)printf("%s: the interface has its factory settings: address 1, 19200 8E1, termination on\n"
                     "from now on: fathom read hps167s --port %s\n",
                     session.sensor->name, session.sensor->port->path);
    else
        (void)printf(
            "%s: the sensor acknowledged that it loads its factory settings; they cannot be read back\n",
            session.sensor->name);
    return fflush(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
}

static int print_failure(bool is_restore, fathom_status_t status)
{
    const sensor_t *const sensor = session.sensor;
    const bool is_unconfirmed = status == FATHOM_ERR_UNCONFIRMED;
    const char *prefix = "the reset was sent, and is not confirmed: ";
    if (!reader_facts(sensor->reader).is_written)
        prefix = "nothing was written: ";
    else if (is_unconfirmed || status == FATHOM_ERR_EXCEPTION)
        prefix = "";
    (void)fprintf(stderr, "fathom: %s: %s", sensor->name, prefix);
    if (is_unconfirmed && is_restore) {
        char line[LINE_TEXT];
        (void)fprintf(
            stderr,
            "the reset was sent, but then the sensor could not be read. It is at address 1, 19200 8E1, "
            "or still at address %u, %s. Run 'fathom scan --port %s'",
            sensor->address, line_text(&sensor->line, line), session.sensor->port->path);
    } else if (is_unconfirmed) {
        (void)fputs(
            "the reset was sent, and no acknowledgement was received. The sensor may have its factory "
            "settings or not; they cannot be read back",
            stderr);
    } else {
        session_explain(&session, status);
    }
    (void)fputs("\n", stderr);
    return STATUS_FAILED;
}

static bool set_up(const arguments_t *arguments, bool *is_restore)
{
    const reset_settings_t *const settings = arguments->settings;
    const origin_t origin = {.command = arguments->command->name};
    if (!session_read(&session, arguments, 1, 1)) return false;
    if (session.sensor->model->reset_interface == NULL)
        return reject(&origin, "%s cannot be reset. Only an hps167s can.", session.sensor->model->name);
    const char *const word = arguments->count == 2          ? arguments->words[1]
                             : settings->restores_interface ? "interface"
                             : settings->restores_sensor    ? "sensor"
                                                            : "";
    if (word[0] == '\0') return reject(&origin, "say what to reset: interface or sensor.");
    *is_restore = strcmp(word, "interface") == 0;
    if (!*is_restore && strcmp(word, "sensor") != 0)
        return reject(&origin, "what is to be reset is '%s'. Write interface or sensor.", word);
    if (settings->restores_interface && settings->restores_sensor)
        return reject(&origin, "only one of interface and sensor can be reset at a time.");
    return confirm(arguments,
                   settings->session.is_confirmed || settings->restores_interface ||
                       settings->restores_sensor,
                   *is_restore ? "This sets %s to address 1, 19200 8E1, and termination on."
                               : "This overwrites the filter and the distance offset of %s.",
                   session.sensor->name);
}

static int start(const host_t *host, const arguments_t *arguments)
{
    bool is_restore = false;
    if (!set_up(arguments, &is_restore)) return STATUS_USAGE;
    if (!session_open(&session, host)) return STATUS_FAILED;
    const fathom_status_t result = session_call(&session, is_restore ? restore : load, NULL);
    const int status = result == FATHOM_OK ? print_done(is_restore) : print_failure(is_restore, result);
    session_close(&session);
    return status;
}

const command_t reset_command = {
    .name = "reset",
    .summary = "Restore the factory settings of an hps167s",
    .usage = "hps167s[:ADDRESS][@PORT] interface [OPTIONS]\nhps167s[:ADDRESS][@PORT] sensor [OPTIONS]",
    .about = "\n  interface  the RS485 interface (#6): address 1, 19200 8E1, termination on\n"
             "  sensor     the sensor behind it (#13): its filter and its distance offset\n",
    .tables = tables,
    .common = "port address baud yes timeout",
    .examples = "  fathom reset hps167s:7 interface --port /dev/ttyUSB0 --yes\n",
    .status = "Before you reset one of several units, make sure that no other has address 1.\n"
              "Exit status: 0 done, 1 not done or unknown, 2 wrong usage.\n",
    .topics = "settings, ports",
    .operands = OPERANDS_RESETTABLE,
    .settings_size = sizeof(reset_settings_t),
    .start = start,
};
