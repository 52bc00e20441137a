/* SPDX-License-Identifier: MIT */
#include "cli/rows.h"
#include "commands/commands.h"
#include "device/backup_file.h"
#include "device/new_file.h"
#include "output/words.h"

/* fathom save writes the settings of a sensor to a file, for fathom restore. */

typedef struct {
    session_settings_t session;
    const char *path; /* NULL: standard output */
} save_settings_t;

static const option_t rows[] = {
    {"file", "FILE", "Write to a new FILE instead of standard output", KIND_TEXT, GROUP_OUTPUT,
     AT(save_settings_t, path), .is_path = true},
    {"output", .help = "Other commands have it", .group = GROUP_OUTPUT, .is_hidden = true, .instead = "file"},
    {.name = NULL},
};

static const option_table_t tables[] = {{rows, 0}, SESSION_TABLES, {NULL, 0}};

static session_t session;

static void print(FILE *to, const host_t *host, const backup_t *unit)
{
    char line[LINE_TEXT];
    char place[2 * LINE_TEXT];
    char utc[UTC_TEXT];
    char when[UTC_TEXT];
    (void)snprintf(place, sizeof place, "address %u, %s", session.sensor->address,
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
        if (!new_file_open(&file, path)) return STATUS_FAILED;
        print(file.file, host, &unit);
        if (!new_file_close(&file)) return STATUS_FAILED;
        (void)printf("%s: the settings are in %s\n", session.sensor->name, path);
    }
    if (fflush(stdout) == 0 && ferror(stdout) == 0) return STATUS_OK;
    (void)fputs("fathom: cannot write the output.\n", stderr);
    return STATUS_FAILED;
}

static int start(const host_t *host, const arguments_t *arguments)
{
    const save_settings_t *const settings = arguments->settings;
    if (!session_read(&session, arguments, 1, 0) ||
        !session_set_mode(&session, arguments, model_mode_of(session.sensor->model, NULL)))
        return STATUS_USAGE;
    if (settings->path != NULL && !new_file_is_free(settings->path)) return STATUS_FAILED;
    if (!session_open(&session, host)) return STATUS_FAILED;
    const int status = save(host, settings->path);
    session_close(&session);
    return status;
}

const command_t save_command = {
    .name = "save",
    .summary = "Write the settings of a sensor to a file",
    .usage = "SENSOR[:ADDRESS][@PORT] [OPTIONS]",
    .about = "The file is text. 'fathom restore' writes it to the same or another sensor.\n",
    .tables = tables,
    .common = "port address baud file timeout",
    .examples = "  fathom save hps167s:7 --port /dev/ttyUSB0 --file gate.txt\n"
                "  fathom save a16 --port /dev/ttyUSB0\n",
    .status = "Exit status: 0 success, 1 the sensor could not be read, 2 wrong usage.\n",
    .topics = "backup, settings, sensors, ports",
    .operands = OPERANDS_ONE,
    .settings_size = sizeof(save_settings_t),
    .start = start,
};
