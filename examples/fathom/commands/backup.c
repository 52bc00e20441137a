/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <string.h>

#include "cli/rows.h"
#include "commands/commands.h"
#include "device/session.h"
#include "output/words.h"

/* fathom save writes the settings of a sensor to a file, and fathom restore those of a file to a sensor. */

typedef struct {
    session_settings_t session;
    const char *path; /* NULL: standard output */
    bool is_dry;
    bool is_new;
} backup_settings_t;

static session_t session;

static bool set_up(const arguments_t *arguments)
{
    return session_read(&session, arguments, 1, 0) &&
           session_set_mode(&session, arguments, model_mode_of(session.sensor->model, NULL));
}

/* ---- fathom save ---- */

static void print_unit(FILE *to, const void *unit)
{
    const host_t *const host = session.port.host;
    char line[LINE_TEXT];
    char place[2 * LINE_TEXT];
    char utc[UTC_TEXT];
    char when[UTC_TEXT];
    (void)snprintf(place, sizeof place, "address %u, %s", session.sensor->address,
                   session_line_text(&session, line));
    (void)snprintf(when, sizeof when, "%.19sZ", utc_text(host->utc_us(host->ctx), utc)); /* to the second */
    backup_print(to, unit, place, when);
}

static bool save(const char *path)
{
    values_t unit;
    if (!backup_read(&session, &unit)) return false;
    if (path == NULL) {
        print_unit(stdout, &unit);
    } else {
        if (!file_write(path, false, print_unit, &unit)) return false;
        (void)printf("%s: the settings are in %s\n", session.sensor->name, path);
    }
    return is_output_written();
}

static int start_save(const host_t *host, const arguments_t *arguments)
{
    const backup_settings_t *const settings = arguments->settings;
    if (!set_up(arguments)) return STATUS_USAGE;
    if (settings->path != NULL && !file_is_free(settings->path)) return STATUS_FAILED;
    if (!session_open(&session, host)) return STATUS_FAILED;
    const bool is_saved = save(settings->path);
    session_close(&session);
    return is_saved ? STATUS_OK : STATUS_FAILED;
}

/* ---- fathom restore: the plan ---- */

/* The treatment of a setting. Those that are written come in the order of writing: a setting that can be compared is
 * written before one that cannot, which is then not written if the first one fails; what moves the sensor comes last. */
typedef enum {
    STEP_NONE = 0,   /* the file does not have it, or has the same value */
    STEP_STAYS,      /* an address or a baud rate that is not to change */
    STEP_IMPOSSIBLE, /* the sensor does not have it */
    STEP_WRITE,
    STEP_WRITE_UNSEEN, /* it is write-only */
    STEP_MOVE,
    STEP_CHANGE_BAUD,
    STEPS
} step_t;

/* What fathom restore does with the sensor. */
static struct {
    const char *path;
    bool is_new;   /* the sensor gets the address of the file, */
    bool has_baud; /* and its baud rate */
    values_t file;
    values_t unit;
    step_t steps[VALUES];
    step_t last;                 /* of these, in the order of writing */
    bool is_impossible;          /* a step is STEP_IMPOSSIBLE */
    char unseen[SETTING_VALUES]; /* names of the settings that were written without comparison */
} plan;

static step_t step_of(const value_t *file, const value_t *unit)
{
    const setting_t *const setting = unit->setting;
    const bool may_move = setting->is_baud ? plan.has_baud : plan.is_new;
    if (setting->effect == NULL || file->held != HELD_VALUE || value_is_same(file, unit)) return STEP_NONE;
    if (setting->moves && !may_move) return STEP_STAYS;
    if (unit->held == HELD_NOT_THERE) return STEP_IMPOSSIBLE;
    if (setting->moves) return setting->is_baud ? STEP_CHANGE_BAUD : STEP_MOVE;
    return unit->held == HELD_NOT_READABLE ? STEP_WRITE_UNSEEN : STEP_WRITE;
}

static void make_plan(void)
{
    for (size_t i = 0; plan.unit.rows[i].setting != NULL; i++) {
        plan.steps[i] = step_of(&plan.file.rows[i], &plan.unit.rows[i]);
        if (plan.steps[i] > plan.last) plan.last = plan.steps[i];
        if (plan.steps[i] == STEP_IMPOSSIBLE) plan.is_impossible = true;
    }
}

/* Prints the versions and numbers of both. Returns false if `other` is another sensor. */
static bool print_identity(const values_t *one, const char *one_is, const values_t *other,
                           const char *other_is)
{
    bool is_known = false;
    bool is_same = true;
    for (size_t i = 0; one->rows[i].setting != NULL; i++) {
        const value_t *const a = &one->rows[i];
        const value_t *const b = &other->rows[i];
        const bool is_unit = a->setting->kind == SETTING_IDENTITY;
        if (a->setting->effect != NULL || a->held == HELD_NOTHING) continue;
        (void)printf("%s: %s %s, %s %s: ", a->setting->name, value_text(a), one_is, value_text(b), other_is);
        if (a->held != HELD_VALUE || b->held != HELD_VALUE) {
            (void)puts("unknown");
            continue;
        }
        (void)printf("%s %s\n", value_is_same(a, b) ? "the same" : "another", is_unit ? "sensor" : "version");
        if (!is_unit) continue;
        is_known = true;
        is_same = value_is_same(a, b);
    }
    if (!is_known) (void)puts("unknown whether it is the same sensor: it has no number to compare");
    return is_same;
}

static const char *cell(const value_t *value, char text[SETTING_CELL])
{
    return setting_with_unit(value->setting,
                             value->held == HELD_NOT_SETTABLE ? value->text : value_text(value), text);
}

static void print_plan(void)
{
    const char *const notes[STEPS] = {[STEP_STAYS] = plan.is_new ? "  stays: the baud rate is the gateway's"
                                                                 : "  stays, without --as-new",
                                      [STEP_IMPOSSIBLE] = "  this sensor does not have it",
                                      [STEP_WRITE] = "",
                                      [STEP_WRITE_UNSEEN] = "  is written without comparison",
                                      [STEP_MOVE] = "",
                                      [STEP_CHANGE_BAUD] = ""};
    char is[SETTING_CELL];
    char to[SETTING_CELL];
    (void)print_identity(&plan.file, "in the file", &plan.unit, "in the sensor");
    if (plan.last == STEP_NONE)
        (void)puts("no differences");
    else
        (void)printf("%-24s %-14s    %s\n", "setting", "in the sensor", "in the file");
    for (size_t i = 0; plan.unit.rows[i].setting != NULL; i++)
        if (plan.steps[i] != STEP_NONE)
            (void)printf("%-24s %-14s -> %s%s\n", plan.unit.rows[i].setting->name,
                         cell(&plan.unit.rows[i], is), cell(&plan.file.rows[i], to), notes[plan.steps[i]]);
    for (size_t i = 0; plan.unit.rows[i].setting != NULL; i++) {
        const setting_t *const setting = plan.unit.rows[i].setting;
        if (plan.steps[i] == STEP_WRITE_UNSEEN && setting->risk != NULL)
            (void)session_fail(&session, FATHOM_OK, "%s: %s", setting->name, setting->risk);
    }
}

/* ---- fathom restore: writing ---- */

/* Moves the session to where the driver has followed the sensor. */
static bool follow(void)
{
    const reader_facts_t facts = reader_facts(session.sensor->reader);
    const fathom_line_settings_t line = facts.line != NULL ? *facts.line : session.sensor->line;
    return session_move(&session, facts.address, &line);
}

static bool write_row(size_t i)
{
    const setting_t *const setting = plan.unit.rows[i].setting;
    change_t change = {.session = &session, .setting = setting};
    (void)setting_value(setting, plan.file.rows[i].text, &change.value);
    (void)snprintf(change.wanted, sizeof change.wanted, "%s", plan.file.rows[i].text);
    (void)snprintf(change.was, sizeof change.was, "%s", plan.unit.rows[i].text);
    return change_report(&change, session_set(&session, setting, change.value)) &&
           (!setting->moves || follow());
}

/* Writes step after step, until a write fails. */
static bool write_all(void)
{
    const char *stopped = NULL;
    char before[SETTING_VALUES] = "";
    char after[SETTING_VALUES] = "";
    for (step_t step = STEP_WRITE; step != STEPS; step++) {
        for (size_t i = 0; plan.unit.rows[i].setting != NULL; i++) {
            const char *const name = plan.unit.rows[i].setting->name;
            if (plan.steps[i] != step) continue;
            if (stopped != NULL) {
                list_add(after, sizeof after, name);
                continue;
            }
            if (write_row(i))
                list_add(before, sizeof before, name);
            else
                stopped = name;
            if (step == STEP_WRITE_UNSEEN && reader_facts(session.sensor->reader).is_written)
                list_add(plan.unseen, sizeof plan.unseen, name);
        }
    }
    return stopped == NULL ||
           session_fail(&session, FATHOM_OK, "stopped at %s. Written before: %s. Not written: %s", stopped,
                        before[0] != '\0' ? before : "nothing", after[0] != '\0' ? after : "nothing else");
}

/* ---- fathom restore: the new place ---- */

/* One response may be lost, so the place gets two requests. Bytes without a response do not occupy it: they may be
 * frames of this sensor, received at another rate. */
static bool is_free_at(uint8_t address, const fathom_line_settings_t *line)
{
    char text[LINE_TEXT];
    presence_t presence = presence_ask(&session, address, line, 1);
    if (presence.status == FATHOM_ERR_NO_RESPONSE) presence = presence_ask(&session, address, line, 1);
    if (presence.status == FATHOM_ERR_NO_RESPONSE) return true;
    if (presence.status == FATHOM_ERR_ARGUMENT) return false; /* session_move() has printed the reason */
    const bool is_taken = presence.what == PRESENT_ONE || presence.what == PRESENT_UNCLEAR;
    return session_fail(&session, is_taken ? FATHOM_OK : presence.status,
                        "nothing was written: at address %u, %s%s", address,
                        session_line_text(&session, text),
                        is_taken ? ", a sensor responds already. Two sensors at one address would respond at "
                                   "the same time"
                                 : "");
}

/* Returns true if no sensor responds at the new address, neither at today's line settings, which the sensor passes, nor
 * at the new rate. Then moves the session back. */
static bool is_place_free(void)
{
    const fathom_line_settings_t home_line = session.sensor->line;
    const uint8_t home = session.sensor->address;
    fathom_line_settings_t line = home_line;
    uint32_t address = home;
    for (size_t i = 0; plan.unit.rows[i].setting != NULL; i++) {
        uint32_t *const number = plan.steps[i] == STEP_MOVE ? &address : &line.baud;
        if (plan.steps[i] >= STEP_MOVE) (void)number_parse(plan.file.rows[i].text, 0, UINT32_MAX, number);
    }
    const bool is_free = (address == home || is_free_at((uint8_t)address, &home_line)) &&
                         (line.baud == home_line.baud || is_free_at((uint8_t)address, &line));
    return session_move(&session, home, &home_line) && is_free;
}

/* Returns true if the same sensor responds at the new place. */
static bool is_still_same(void)
{
    values_t now;
    char line[LINE_TEXT];
    if (!backup_read(&session, &now))
        return session_fail(&session, FATHOM_OK,
                            "all differences are written, but the sensor cannot be read at its new place.");
    (void)printf("%s: responds at the new place, %s\n", session.sensor->name,
                 session_line_text(&session, line));
    return print_identity(&plan.unit, "before", &now, "now") ||
           session_fail(&session, FATHOM_OK,
                        "another sensor responds at the new place. Run 'fathom scan --port %s'",
                        session.sensor->port->path);
}

static bool restore(bool is_dry)
{
    if (!backup_read(&session, &plan.unit)) return session_fail(&session, FATHOM_OK, "nothing was written.");
    plan.has_baud =
        plan.is_new && port_has_settings(session.port.kind); /* that of a gateway belongs to all sensors */
    make_plan();
    print_plan();
    if (!is_output_written()) return false; /* without the plan on stdout nothing is written */
    if (is_dry) return plan.last < STEP_IMPOSSIBLE;
    if (plan.is_impossible)
        return session_fail(&session, FATHOM_OK,
                            "nothing was written: this sensor does not have all settings of the file. Write "
                            "`not there` for those in %s",
                            plan.path);
    const bool moves = plan.last >= STEP_MOVE;
    if (moves && !is_place_free()) return false;
    if (write_all() && (!moves || is_still_same())) return is_output_written();
    if (plan.unseen[0] != '\0')
        (void)session_fail(
            &session, FATHOM_OK,
            "before you run restore again, write `not readable` for %s in %s, or it is written "
            "again.",
            plan.unseen, plan.path);
    return false;
}

static int start_restore(const host_t *host, const arguments_t *arguments)
{
    const backup_settings_t *const settings = arguments->settings;
    if (!set_up(arguments) || !session_can_set(&session, arguments)) return STATUS_USAGE;
    memset(&plan, 0, sizeof plan);
    plan.path = settings->path;
    plan.is_new = settings->is_new;
    const int parsed = backup_parse(plan.path, session.sensor->model, plan.is_new, &plan.file);
    if (parsed != STATUS_OK) return parsed;
    if (!session_open(&session, host)) return STATUS_FAILED;
    const bool is_restored = restore(settings->is_dry);
    session_close(&session);
    return is_restored ? STATUS_OK : STATUS_FAILED;
}

/* ---- the commands ---- */

static const option_t save_rows[] = {
    {"file", "FILE", "Write to a new FILE instead of standard output", KIND_TEXT, GROUP_OUTPUT,
     AT(backup_settings_t, path), .is_path = true},
    {"output", .help = "Other commands have it", .group = GROUP_OUTPUT, .is_hidden = true, .instead = "file"},
    {.name = NULL},
};

static const option_table_t save_tables[] = {{save_rows, 0}, SESSION_TABLES, {NULL, 0}};

const command_t save_command = {
    .name = "save",
    .summary = "Write the settings of a sensor to a file",
    .usage = "SENSOR[:ADDRESS][@PORT] [OPTIONS]",
    .about = "The file is text. 'fathom restore' writes it to the same or another sensor.\n",
    .tables = save_tables,
    .common = "port address baud file timeout",
    .examples = "  fathom save hps167s:7 --port /dev/ttyUSB0 --file gate.txt\n"
                "  fathom save a16 --port /dev/ttyUSB0\n",
    .status = "Exit status: 0 success, 1 the sensor could not be read, 2 wrong usage.\n",
    .topics = "backup, settings, sensors, ports",
    .operands = OPERANDS_ONE,
    .settings_size = sizeof(backup_settings_t),
    .start = start_save,
};

static const option_t restore_rows[] = {
    {"file", "FILE", "Read the settings from FILE, which 'fathom save' wrote", KIND_TEXT, GROUP_COMMAND,
     AT(backup_settings_t, path), .is_path = true, .is_required = true,
     .takes = "the name of a file, such as --file gate.txt"},
    {"dry-run", .help = "Print the differences and write nothing", .group = GROUP_COMMAND,
     AT(backup_settings_t, is_dry)},
    {"as-new", .help = "Also set the address and baud rate of the saved sensor", .group = GROUP_COMMAND,
     AT(backup_settings_t, is_new)},
    {.name = NULL},
};

static const option_table_t restore_tables[] = {{restore_rows, 0}, SESSION_TABLES, {NULL, 0}};

const command_t restore_command = {
    .name = "restore",
    .summary = "Write the settings of a file to a sensor",
    .usage = "SENSOR[:ADDRESS][@PORT] --file FILE [OPTIONS]",
    .about = "The sensor is read first, and only what differs is written. With --as-new,\n"
             "nothing may respond at the new address. A setting that the file marks as\n"
             "'not readable' is written only if you fill in its value. After a failed write\n"
             "the command ends and prints what was written; run it again.\n",
    .tables = restore_tables,
    .common = "port file dry-run as-new baud",
    .examples = "  fathom restore hps167s:7 --port /dev/ttyUSB0 --file gate.txt --dry-run\n"
                "  fathom restore hps167s:7 --port /dev/ttyUSB0 --file gate.txt\n"
                "  fathom restore hps167s --port /dev/ttyUSB0 --file gate.txt --as-new\n",
    .status = "Exit status: 0 the sensor has the settings of the file (--dry-run: already),\n"
              "1 it does not or that is unknown, 2 wrong usage or a wrong line in the file.\n",
    .topics = "backup, settings, sensors, ports",
    .operands = OPERANDS_ONE,
    .settings_size = sizeof(backup_settings_t),
    .start = start_restore,
};
