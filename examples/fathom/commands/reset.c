/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "cli/session_options.h"
#include "commands/commands.h"
#include "fathom/sensor/hps167s_settings.h"
#include "ports/line_text.h"

/* fathom reset: the two commands of an HPS-167S that throw settings away.
 * Nothing else of the tool sends them. */

static const char command[] = "reset";

enum { RESTORE = SESSION_OPTIONS, LOAD, OPTIONS };

static const struct option table[OPTIONS + 1] = {
    SESSION_OPTION_ROWS,
    [RESTORE] = {"yes-restore-factory-settings", no_argument, NULL, 256},
    [LOAD] = {"yes-load-factory-sensor-settings", no_argument, NULL, 256},
};

static session_t session;

static fathom_status_t restore(reader_t *reader, void *ctx)
{
    (void)ctx;
    return session.station->model->reset.restore(reader);
}

static fathom_status_t load(reader_t *reader, void *ctx)
{
    (void)ctx;
    return session.station->model->reset.load(reader);
}

static int finish(bool is_restore, fathom_status_t status)
{
    const sensor_t *const station = session.station;
    if (status == FATHOM_OK) {
        if (is_restore)
            (void)printf("%s: the interface has its factory settings: address 1, "
                         "19200 8E1, termination on\n"
                         "from now on: fathom read hps167s --port %s\n",
                         station->name, session_port(&session)->path);
        else
            (void)printf("%s: the sensor has acknowledged that it loads its factory "
                         "settings; they cannot be read "
                         "back\n",
                         station->name);
        return fflush(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
    }
    const bool is_sent = station->model->reset.is_sent(station->reader);
    const bool is_told = status == FATHOM_ERR_UNCONFIRMED || status == FATHOM_ERR_EXCEPTION;
    (void)fprintf(stderr, "fathom: %s: %s", station->name,
                  !is_sent  ? "nothing was written: "
                  : is_told ? ""
                            : "it was sent, and is not confirmed: ");
    if (status == FATHOM_ERR_UNCONFIRMED && !is_restore) {
        (void)fputs("it was sent, and no acknowledgement came: it may hold or not, and cannot be read back",
                    stderr);
    } else if (status == FATHOM_ERR_UNCONFIRMED) {
        char line[LINE_TEXT];
        (void)fprintf(stderr,
                      "the reset was sent, and then the device could not be read: "
                      "it is at address 1, 19200 8E1, or "
                      "still at address %u, %s; try fathom scan --port %s",
                      station->address, line_text(&station->line, line), session_port(&session)->path);
    } else {
        session_explain(&session, status);
    }
    (void)fputs("\n", stderr);
    return STATUS_FAILED;
}

static void help(FILE *to)
{
    (void)fputs("fathom reset gives an HPS-167S its factory settings back. What "
                "was set is lost.\n\n"
                "usage: fathom reset hps167s[:ADDRESS] --port PATH "
                "--yes-restore-factory-settings [OPTIONS]\n"
                "       fathom reset hps167s[:ADDRESS] --port PATH "
                "--yes-load-factory-sensor-settings [OPTIONS]\n\n"
                "  --yes-restore-factory-settings\n"
                "                    of the RS485 interface (#6): address 1, "
                "19200 8E1, warm-up, termination on\n"
                "  --yes-load-factory-sensor-settings\n"
                "                    of the sensor behind it (#13): its filter "
                "and its distance offset\n",
                to);
    session_options_help(to);
    (void)fputs("\nOn a line with several units, see first that none of the "
                "others has address 1.\n"
                "Exit status: 0 when it is done, 1 when not or when that is not "
                "known, 2 for wrong usage.\n",
                to);
}

static int run(const host_t *host, int argc, char **argv)
{
    const char *values[OPTIONS] = {NULL};
    int status = STATUS_OK;
    if (!session_options_of_one(&session, &reset_command, argc, argv, table, values, &status)) return status;
    if (session.station->model->reset.restore == NULL)
        return usage_error(command, "only an hps167s can be reset; %s has no such command",
                           session.station->model->name);
    const bool is_restore = values[RESTORE] != NULL;
    if (is_restore == (values[LOAD] != NULL))
        return usage_error(command, "what was set is lost: say so by "
                                    "--yes-restore-factory-settings (the interface) or "
                                    "--yes-load-factory-sensor-settings");
    if (!session_open(&session, host)) return STATUS_FAILED;
    status = finish(is_restore, session_call(&session, is_restore ? restore : load, NULL));
    session_close(&session);
    return status;
}

const command_t reset_command = {
    .name = "reset", .summary = "gives an HPS-167S its factory settings back", .help = help, .run = run};
