/* SPDX-License-Identifier: MIT */
#include "cli/session_options.h"
#include "commands/commands.h"
#include "device/backup_file.h"
#include "device/new_file.h"
#include "output/timestamp.h"

/* fathom save: the settings of a unit as a file, for fathom restore. */

static const char command[] = "save";
static session_t session;

enum { FILE_NAME = SESSION_OPTIONS, OPTIONS };

static const struct option table[OPTIONS + 1] = {
    SESSION_OPTION_ROWS,
    [FILE_NAME] = {"file", required_argument, NULL, 256},
};

static void help(FILE *to)
{
    (void)fputs("fathom save writes the settings of a unit as a text that a person can read and change, for "
                "`fathom restore`.\nIt changes nothing.\n\n"
                "usage: fathom save SENSOR[:ADDRESS] --port PATH [--file FILE] [OPTIONS]\n\n"
                "  --file FILE       a new file, which is there as a whole or not at all; without it: the "
                "standard output.\n"
                "                    A file that is there already is never overwritten\n",
                to);
    session_line_help(to);
    (void)fputs(
        "\nA line is NAME = VALUE, with the names and values of `fathom get` and `fathom set`. What the unit "
        "does not tell,\nas the distance-offset of an hps167s, stands there as `not readable`; what this "
        "variant does not have, as `not there`.\nWhat it measures is not in it. The first request ends the "
        "automatic output of an A16 with RS232 or an A05 with UART.\n"
        "Exit status: 0 when all is written, 1 when not (then there is no file), 2 for wrong usage.\n\n"
        "examples:\n"
        "  fathom save hps167s:7 --port /dev/ttyUSB0 --file gate.txt\n"
        "  fathom save a16 --port /dev/ttyUSB0\n",
        to);
}

static void print(FILE *to, const host_t *host, const backup_t *unit)
{
    char line[LINE_TEXT];
    char place[2 * LINE_TEXT];
    char utc[UTC_TEXT];
    char when[UTC_TEXT];
    (void)snprintf(place, sizeof place, "address %u, %s", session.station->address,
                   session_line_text(&session, line));
    (void)snprintf(when, sizeof when, "%.19sZ", utc_text(host->utc_us(host->ctx), utc)); /* to the second */
    backup_print(to, unit, place, when);
}

static int save(const host_t *host, const char *path)
{
    static new_file_t file;
    backup_t unit;
    if (!backup_read(&session, &unit)) return STATUS_FAILED;
    if (path == NULL) {
        print(stdout, host, &unit);
    } else {
        if (!new_file_begin(&file, path)) return STATUS_FAILED;
        print(file.file, host, &unit);
        if (!new_file_end(&file)) return STATUS_FAILED;
        (void)printf("%s: its settings are in %s\n", session.station->name, path);
    }
    if (fflush(stdout) == 0 && ferror(stdout) == 0) return STATUS_OK;
    (void)fputs("fathom: the output cannot be written\n", stderr);
    return STATUS_FAILED;
}

static int run(const host_t *host, int argc, char **argv)
{
    const char *values[OPTIONS] = {NULL};
    int status = STATUS_OK;
    if (!session_options_of_one(&session, &save_command, argc, argv, table, values, &status)) return status;
    if (values[SESSION_FORMAT] != NULL) return usage_error(command, "it has one format; leave --format out");
    if (!session_set_mode(&session, command, values, model_mode_of(session.station->model, NULL)))
        return STATUS_USAGE;
    if (values[FILE_NAME] != NULL && !new_file_is_free(values[FILE_NAME])) return STATUS_FAILED;
    if (!session_open(&session, host)) return STATUS_FAILED;
    status = save(host, values[FILE_NAME]);
    session_close(&session);
    return status;
}

const command_t save_command = {
    .name = "save", .summary = "writes the settings of a unit into a file", .help = help, .run = run};
