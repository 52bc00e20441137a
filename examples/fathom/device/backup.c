/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): getline */
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "device/session.h"
#include "fathom/version.h"
#include "output/words.h"

static const char *const words[] = {[HELD_NOT_READABLE] = "not readable",
                                    [HELD_NOT_THERE] = "not there",
                                    [HELD_NOT_SETTABLE] = "not settable"};

const char *backup_text(const backup_row_t *row)
{
    return row->held >= HELD_NOT_READABLE ? words[row->held] : row->text;
}

bool backup_is_same(const backup_row_t *one, const backup_row_t *other)
{
    return one->held == HELD_VALUE && other->held == HELD_VALUE && strcmp(one->text, other->text) == 0;
}

static bool is_kept(const setting_t *setting)
{
    return setting->kind != SETTING_PRESENT && setting->mode == NULL;
}

/* Stores the text as the sensor reports it. Returns false if that value cannot be set. A sensor can have address 0, which
 * restore does not write. */
static bool store(backup_row_t *row, const setting_t *setting, const char *text)
{
    int32_t value = 0;
    const bool is_zero = setting->has_zero && strcmp(text, "0") == 0;
    (void)snprintf(row->text, sizeof row->text, "%s", text);
    if (setting->effect == NULL) return true;
    if (!is_zero && !setting_value(setting, text, &value)) return false;
    setting_print_value(setting, value, row->text);
    return true;
}

/* ---- reading a sensor ---- */

/* One response may be lost, and a backup without this value, or with "not there", would be wrong. */
static fathom_status_t read_repeatedly(session_t *session, const setting_t *setting, char text[SETTING_TEXT])
{
    enum { TIMES = 3 };
    fathom_status_t status = FATHOM_ERR_NO_RESPONSE;
    for (unsigned times = 0; times != TIMES; times++) {
        status = session_get(session, setting, text);
        if (setting_reason(status) == NULL && status != FATHOM_ERR_CHECKSUM &&
            status != FATHOM_ERR_LINE_BUSY && status != FATHOM_ERR_OTHER_MASTER)
            break;
    }
    return status;
}

static fathom_status_t read_row(session_t *session, const setting_t *setting, backup_row_t *row)
{
    char text[SETTING_TEXT];
    row->held = HELD_VALUE;
    if (setting->read_at == 0 && !setting->moves) {
        row->held = HELD_NOT_READABLE;
    } else if (setting->read_at == 0) { /* the address at which the sensor responds */
        setting_print_value(setting, session->sensor->address, row->text);
    } else {
        row->status = read_repeatedly(session, setting, text);
        if (row->status == FATHOM_OK) {
            if (!store(row, setting, text)) row->held = HELD_NOT_SETTABLE;
            return FATHOM_OK;
        }
        const bool may_be_missing = setting->is_of_variant || setting->effect == NULL;
        if (!may_be_missing || setting_reason(row->status) == NULL) return row->status;
        row->held = HELD_NOT_THERE;
    }
    return FATHOM_OK;
}

bool backup_read(session_t *session, backup_t *unit)
{
    const setting_t *known = NULL; /* the first setting that was read */
    const setting_t *missing = NULL;
    char text[SETTING_TEXT];
    *unit = (backup_t){.model = session->sensor->model};
    session_begin_task(session, "reading the settings");
    for (size_t i = 0; unit->model->settings[i].name != NULL; i++) {
        const setting_t *const setting = &unit->model->settings[i];
        if (!is_kept(setting)) continue;
        const fathom_status_t status = read_row(session, setting, &unit->rows[i]);
        if (status != FATHOM_OK) return session_fail(session, status, "%s", setting->name);
        if (unit->rows[i].held == HELD_NOT_THERE)
            missing = setting;
        else if (known == NULL && setting->read_at != 0)
            known = setting;
    }
    if (missing != NULL) { /* only if the sensor still responds */
        if (known == NULL) return session_fail(session, FATHOM_ERR_NO_RESPONSE, "%s", missing->name);
        const fathom_status_t status = read_repeatedly(session, known, text);
        if (status != FATHOM_OK) return session_fail(session, status, "%s", known->name);
    }
    session_end_task(session);
    return true;
}

/* ---- writing the file ---- */

/* A row is in one group, or the file would have a line twice and could not be read. */
typedef enum { GROUP_IDENTITY, GROUP_PLACE, GROUP_SETTINGS, GROUP_NOT_READABLE, GROUPS } group_t;

static const char *const headings[] = {
    [GROUP_IDENTITY] = "Which unit it is. It cannot be set; fathom restore compares it.",
    [GROUP_PLACE] = "Where it is. fathom restore leaves a unit where it is, but for --as-new.",
    [GROUP_SETTINGS] = "How it is set.",
    [GROUP_NOT_READABLE] =
        "What the unit does not tell. It is restored only if you fill it in, and then written each time."};

static group_t group_of(const setting_t *setting, const backup_row_t *row)
{
    if (setting->effect == NULL) return GROUP_IDENTITY;
    if (setting->moves) return GROUP_PLACE;
    return row->held == HELD_NOT_READABLE ? GROUP_NOT_READABLE : GROUP_SETTINGS;
}

/* "warm-up = 5                     # s, how long ..." */
static void print_line(FILE *to, const char *name, const char *value, const char *unit, const char *what)
{
    const int length = fprintf(to, "%s = %s", name, value);
    (void)fprintf(to, "%*s # %s%s%s", length < 40 ? 40 - length : 0, "", unit != NULL ? unit : "",
                  unit != NULL ? ", " : "", what);
}

static void print_row(FILE *to, const setting_t *setting, const backup_row_t *row)
{
    char values[SETTING_VALUES];
    print_line(to, setting->name, backup_text(row), setting->unit, setting->what);
    if (row->held == HELD_NOT_THERE) (void)fprintf(to, "; %s", setting_reason(row->status));
    if (row->held == HELD_NOT_SETTABLE)
        (void)fprintf(to, "; it has %s, which cannot be set: %s", row->text,
                      setting_values_text(setting, values));
    (void)fputs("\n", to);
}

void backup_print(FILE *to, const backup_t *unit, const char *place, const char *when)
{
    (void)fprintf(to,
                  "# The settings of a range sensor, read by fathom save %s at\n"
                  "# %s, %s. fathom restore writes them into a unit.\n"
                  "# A value may be changed; a line may be taken out, then restore leaves that as it is.\n\n",
                  FATHOM_VERSION_STRING, place, when);
    print_line(to, "sensor", unit->model->name, NULL, unit->model->what);
    (void)fputs("\n", to);
    for (group_t group = GROUP_IDENTITY; group != GROUPS; group++) {
        const char *heading = headings[group];
        for (size_t i = 0; unit->model->settings[i].name != NULL; i++) {
            const setting_t *const setting = &unit->model->settings[i];
            const backup_row_t *const row = &unit->rows[i];
            if (row->held == HELD_NOTHING || group_of(setting, row) != group) continue;
            if (heading != NULL) (void)fprintf(to, "\n# %s\n", heading);
            heading = NULL;
            print_row(to, setting, row);
        }
    }
}

/* ---- reading the file ---- */

typedef struct {
    const char *path;
    backup_t *backup;
    unsigned line; /* 0: of the whole file */
    bool has_sensor;
    bool moves; /* the address is to be written */
} parser_t;

static int wrong(const parser_t *parser, const char *format, ...) __attribute__((format(printf, 2, 3)));

static int wrong(const parser_t *parser, const char *format, ...)
{
    va_list arguments;
    (void)fprintf(stderr, "fathom: %s:", parser->path);
    if (parser->line != 0) (void)fprintf(stderr, "%u:", parser->line);
    (void)fputs(" ", stderr);
    va_start(arguments, format);
    (void)vfprintf(stderr, format, arguments);
    va_end(arguments);
    (void)fputs("\n", stderr);
    return STATUS_USAGE;
}

/* Returns the text without blanks at both ends. */
static char *trim(char *text)
{
    size_t length = strlen(text);
    while (length != 0 && strchr(" \t\r", text[length - 1]) != NULL) text[--length] = '\0';
    return text + strspn(text, " \t");
}

static int parse_value(const parser_t *parser, const setting_t *setting, const char *value)
{
    backup_row_t *const row = &parser->backup->rows[setting - parser->backup->model->settings];
    char values[SETTING_VALUES];
    if (strlen(value) >= sizeof row->text) return wrong(parser, "the value of %s is too long", setting->name);
    if (row->line != 0) return wrong(parser, "%s occurs in line %u already", setting->name, row->line);
    row->line = parser->line;
    for (row->held = HELD_NOT_READABLE; row->held <= HELD_NOT_SETTABLE; row->held++)
        if (strcmp(value, words[row->held]) == 0) return STATUS_OK;
    row->held = HELD_VALUE;
    if (!store(row, setting, value))
        return wrong(parser, "%s takes %s, not '%s'", setting->name, setting_values_text(setting, values),
                     value);
    if (parser->moves && setting->has_zero && strcmp(row->text, "0") == 0)
        return wrong(parser, "with --as-new no sensor gets address 0. 'fathom set' can do that");
    return STATUS_OK;
}

/* Names and values are printed, so they must not contain what controls a terminal. */
static bool is_printable(const char *text)
{
    for (; *text != '\0'; text++)
        if ((*text < ' ' || *text > '~') && *text != '\t') return false;
    return true;
}

static int parse_line(parser_t *parser, char *line)
{
    const model_t *const model = parser->backup->model;
    line[strcspn(line, "#")] = '\0';
    char *const name = trim(line);
    char *const sign = strchr(name, '=');
    if (name[0] == '\0') return STATUS_OK;
    if (!is_printable(name))
        return wrong(parser, "the line has a character that cannot be printed or is not ASCII");
    if (sign == NULL) return wrong(parser, "'%s' does not have the form NAME = VALUE", name);
    *sign = '\0';
    const char *const value = trim(sign + 1);
    (void)trim(name);
    if (strcmp(name, "sensor") == 0) {
        if (parser->has_sensor) return wrong(parser, "sensor occurs twice");
        if (strcmp(value, model->name) != 0)
            return wrong(parser, "the file belongs to '%s', and the sensor is an %s", value, model->name);
        parser->has_sensor = true;
        return STATUS_OK;
    }
    if (!parser->has_sensor)
        return wrong(parser, "the line '%s' comes before the line 'sensor = %s'", name, model->name);
    const setting_t *const setting = setting_of(model->settings, name);
    if (setting == NULL || !is_kept(setting))
        return wrong(parser, "'%s' is no setting that 'fathom save' prints for an %s", name, model->name);
    return parse_value(parser, setting, value);
}

static int parse(parser_t *parser, FILE *from)
{
    enum { LINE = 250 };
    char *line = NULL;
    size_t capacity = 0;
    int status = STATUS_OK;
    errno = 0;
    while (status == STATUS_OK) {
        ssize_t length = getline(&line, &capacity, from);
        if (length < 0) break;
        parser->line++;
        if (line[length - 1] == '\n') line[--length] = '\0';
        if (length > LINE)
            status = wrong(parser, "the line is longer than %d characters", LINE);
        else if (strlen(line) != (size_t)length)
            status = wrong(parser, "the line has a byte 0, so this is no text file");
        else
            status = parse_line(parser, line);
    }
    const int error = errno;
    free(line);
    if (status != STATUS_OK) return status;
    parser->line = 0;
    if (feof(from) == 0) {
        (void)wrong(parser, "%s", strerror(error));
        return STATUS_FAILED;
    }
    if (parser->has_sensor) return STATUS_OK;
    return wrong(parser, "the line 'sensor = %s' is missing. Is this a file of 'fathom save'?",
                 parser->backup->model->name);
}

int backup_parse(const char *path, const model_t *model, bool moves, backup_t *file)
{
    parser_t parser = {.path = path, .backup = file, .moves = moves};
    *file = (backup_t){.model = model};
    FILE *const from = fopen(path, "r");
    if (from == NULL) {
        (void)wrong(&parser, "%s", strerror(errno));
        return STATUS_FAILED;
    }
    const int status = parse(&parser, from);
    (void)fclose(from);
    return status;
}
