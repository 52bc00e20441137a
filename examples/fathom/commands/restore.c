/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "cli/rows.h"
#include "commands/commands.h"
#include "device/backup_file.h"
#include "device/change.h"
#include "device/plan.h"
#include "device/presence.h"
#include "device/setting_text.h"
#include "output/words.h"

/* fathom restore writes the settings of a file of fathom save to a sensor. */

typedef struct {
    session_settings_t session;
    const char *path;
    bool is_dry;
    bool is_new;
} restore_settings_t;

static const option_t rows[] = {
    {"file", "FILE", "Read the settings from FILE, which 'fathom save' wrote", KIND_TEXT, GROUP_COMMAND,
     AT(restore_settings_t, path), .is_path = true, .is_required = true, .takes = "the name of a file"},
    {"dry-run", .help = "Print the differences and write nothing", .group = GROUP_COMMAND,
     AT(restore_settings_t, is_dry)},
    {"as-new", .help = "Also set the address and baud rate of the saved sensor", .group = GROUP_COMMAND,
     AT(restore_settings_t, is_new)},
    {.name = NULL},
};

static const option_table_t tables[] = {{rows, 0}, SESSION_TABLES, {NULL, 0}};

static session_t session;

/* ---- writing ---- */

static const setting_t *row_of(const plan_t *plan, size_t n)
{
    return &plan->unit->model->settings[plan->order[n]];
}

static bool write_row(const plan_t *plan, size_t n)
{
    const setting_t *const setting = row_of(plan, n);
    const backup_row_t *const unit = &plan->unit->rows[plan->order[n]];
    change_t change = {
        .session = &session, .setting = setting, .value = plan->file->rows[plan->order[n]].value};
    setting_print_value(setting, change.value, change.wanted);
    (void)snprintf(change.was, sizeof change.was, "%s", unit->text);
    return change_report(&change, session_set(&session, setting, change.value)) &&
           (!setting->moves || presence_follow(&session));
}

/* Lists the names of rows `from` to `to` - 1, or only the write-only ones among them. */
static const char *names(const plan_t *plan, size_t from, size_t to, bool is_unseen,
                         char text[SETTING_VALUES])
{
    text[0] = '\0';
    for (size_t n = from; n < to; n++)
        if (!is_unseen || plan->steps[plan->order[n]] == PLAN_WRITE_UNSEEN)
            list_add(text, SETTING_VALUES, row_of(plan, n)->name);
    return text;
}

/* Prints which of the first `count` rows the next run would write again. */
static void print_again(const plan_t *plan, size_t count, const char *path)
{
    char unseen[SETTING_VALUES];
    if (names(plan, 0, count, true, unseen)[0] == '\0') return;
    (void)fflush(stdout);
    (void)fprintf(
        stderr,
        "fathom: before you run restore again, write `not readable` for %s in %s, or it is written again.\n",
        unseen, path);
}

static void print_stop(const plan_t *plan, size_t n, const char *path)
{
    char before[SETTING_VALUES];
    char after[SETTING_VALUES];
    const bool is_written = reader_facts(session.sensor->reader).is_written;
    (void)names(plan, 0, n, false, before);
    (void)names(plan, n + 1, plan->count, false, after);
    (void)fprintf(stderr, "fathom: stopped at %s. Written before: %s. Not written: %s\n",
                  row_of(plan, n)->name, before[0] != '\0' ? before : "nothing",
                  after[0] != '\0' ? after : "nothing else");
    print_again(plan, is_written ? n + 1 : n, path);
}

static bool write_all(const plan_t *plan, const char *path)
{
    for (size_t n = 0; n != plan->count; n++) {
        if (write_row(plan, n)) continue;
        print_stop(plan, n, path);
        return false;
    }
    return true;
}

/* ---- moving ---- */

/* Finds the address or the baud rate that the plan writes. */
static bool find_place(const plan_t *plan, bool is_baud, const backup_row_t **row)
{
    for (size_t n = 0; n != plan->count; n++) {
        *row = &plan->file->rows[plan->order[n]];
        if (row_of(plan, n)->moves && row_of(plan, n)->is_baud == is_baud) return true;
    }
    return false;
}

static bool is_place_free(const plan_t *plan)
{
    const backup_row_t *row = NULL;
    uint8_t address = session.sensor->address;
    uint32_t baud = session.sensor->line.baud;
    if (find_place(plan, false, &row)) address = (uint8_t)row->value;
    if (find_place(plan, true, &row)) (void)number_parse(row->text, 0, UINT32_MAX, &baud);
    return presence_is_free(&session, address, baud);
}

static bool has_moved(const plan_t *plan)
{
    const backup_row_t *row = NULL;
    return find_place(plan, false, &row) || find_place(plan, true, &row);
}

/* Returns true if the same sensor responds at the new place. */
static bool is_still_same(const backup_t *unit)
{
    backup_t now;
    char line[LINE_TEXT];
    if (!backup_read(&session, &now)) {
        (void)fputs("fathom: all differences are written, but the sensor cannot be read at its new place.\n",
                    stderr);
        return false;
    }
    (void)printf("%s: responds at the new place, %s\n", session.sensor->name,
                 session_line_text(&session, line));
    if (plan_print_identity(unit, "before", &now, "now")) return true;
    (void)fflush(stdout);
    (void)fputs("fathom: another sensor responds at the new place. Run 'fathom scan'\n", stderr);
    return false;
}

static int restore(const backup_t *file, const char *path, bool is_dry, bool is_new)
{
    backup_t unit;
    plan_t plan;
    if (!backup_read(&session, &unit)) {
        (void)fputs("fathom: nothing was written.\n", stderr);
        return STATUS_FAILED;
    }
    /* the baud rate of a gateway belongs to all sensors on its line */
    plan_init(&plan, file, &unit, is_new, is_new && port_has_line(&session.port));
    plan_print(&plan);
    if (is_dry) return plan.count == 0 && !plan.is_impossible ? STATUS_OK : STATUS_FAILED;
    if (fflush(stdout) != 0 || ferror(stdout) != 0)
        return STATUS_FAILED; /* without the plan on stdout nothing is written */
    if (plan.is_impossible) {
        (void)fprintf(stderr,
                      "fathom: nothing was written: this sensor does not have all settings of the file. "
                      "Write `not there` for those in %s\n",
                      path);
        return STATUS_FAILED;
    }
    if (has_moved(&plan) && !is_place_free(&plan)) return STATUS_FAILED;
    if (!write_all(&plan, path)) return STATUS_FAILED;
    if (!has_moved(&plan) || is_still_same(&unit)) return STATUS_OK;
    print_again(&plan, plan.count, path);
    return STATUS_FAILED;
}

/* No sensor gets address 0 by restore. */
static backup_result_t check_address(const char *path, const backup_t *file)
{
    for (size_t i = 0; i != backup_count(file->model); i++)
        if (file->model->settings[i].has_zero && file->rows[i].held == HELD_VALUE && file->rows[i].value == 0)
            return backup_refuse(path, &file->rows[i],
                                 "with --as-new no sensor gets address 0. 'fathom set' can do that");
    return BACKUP_OK;
}

static int start(const host_t *host, const arguments_t *arguments)
{
    const restore_settings_t *const settings = arguments->settings;
    backup_t file;
    if (!session_read(&session, arguments, 1, 0) ||
        !session_set_mode(&session, arguments, model_mode_of(session.sensor->model, NULL)) ||
        !session_can_set(&session, arguments))
        return STATUS_USAGE;
    backup_result_t result = backup_parse(settings->path, session.sensor->model, &file);
    if (result == BACKUP_OK && settings->is_new) result = check_address(settings->path, &file);
    if (result != BACKUP_OK) return result == BACKUP_INVALID ? STATUS_USAGE : STATUS_FAILED;
    if (!session_open(&session, host)) return STATUS_FAILED;
    const int status = restore(&file, settings->path, settings->is_dry, settings->is_new);
    session_close(&session);
    if (fflush(stdout) == 0 && ferror(stdout) == 0) return status;
    (void)fputs("fathom: cannot write the output.\n", stderr);
    return STATUS_FAILED;
}

const command_t restore_command = {
    .name = "restore",
    .summary = "Write the settings of a file to a sensor",
    .usage = "SENSOR[:ADDRESS][@PORT] --file FILE [OPTIONS]",
    .about = "The sensor is read first, and only what differs is written. With --as-new,\n"
             "nothing may respond at the new address. A setting that the file marks as\n"
             "'not readable' is written only if you fill in its value. After a failed write\n"
             "the command ends and prints what was written; run it again.\n",
    .tables = tables,
    .common = "port file dry-run as-new baud",
    .examples = "  fathom restore hps167s:7 --port /dev/ttyUSB0 --file gate.txt --dry-run\n"
                "  fathom restore hps167s:7 --port /dev/ttyUSB0 --file gate.txt\n"
                "  fathom restore hps167s --port /dev/ttyUSB0 --file gate.txt --as-new\n",
    .status = "Exit status: 0 the sensor has the settings of the file (--dry-run: already),\n"
              "1 it does not or that is unknown, 2 wrong usage or a wrong line in the file.\n",
    .topics = "backup, settings, sensors, ports",
    .operands = OPERANDS_ONE,
    .settings_size = sizeof(restore_settings_t),
    .start = start,
};
