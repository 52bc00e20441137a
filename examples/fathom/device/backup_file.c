/* SPDX-License-Identifier: MIT */
#include "device/backup_file.h"

#include <errno.h>
#include <stdarg.h>
#include <string.h>

#include "device/setting_text.h"
#include "fathom/version.h"
#include "output/words.h"

static const char sensor[] = "sensor"; /* of the line with the model */

/* ---- writing ---- */

typedef bool (*is_in_t)(const setting_t *setting, const backup_row_t *row);

static bool is_identity(const setting_t *setting, const backup_row_t *row)
{
    (void)row;
    return setting->set == NULL;
}

static bool is_place(const setting_t *setting, const backup_row_t *row)
{
    (void)row;
    return setting->moves;
}

static bool is_setting(const setting_t *setting, const backup_row_t *row)
{
    return setting->set != NULL && !setting->moves && row->held != HELD_NOT_READABLE;
}

static bool is_not_readable(const setting_t *setting, const backup_row_t *row)
{
    return !is_identity(setting, row) && !is_place(setting, row) && row->held == HELD_NOT_READABLE;
}

/* Invariant: a row is in at most one group, or the printed file has a line twice and cannot be read. */
static const struct {
    const char *heading;
    is_in_t is_in;
} groups[] = {
    {"# Which unit it is. It cannot be set; fathom restore compares it.\n", is_identity},
    {"# Where it is. fathom restore leaves a unit where it is, but for --as-new.\n", is_place},
    {"# How it is set.\n", is_setting},
    {"# What the unit does not tell. It is restored only if you fill it in, and then written each time.\n",
     is_not_readable},
};

/* "warm-up = 5                     # s, how long ..." */
static void print_line(FILE *to, const char *name, const char *value, const char *unit, const char *what)
{
    char text[BACKUP_LINE];
    (void)snprintf(text, sizeof text, "%s = %s", name, value);
    (void)fprintf(to, "%-40s # %s%s%s", text, unit != NULL ? unit : "", unit != NULL ? ", " : "", what);
}

static void print_row(FILE *to, const setting_t *setting, const backup_row_t *row)
{
    const char *const word = backup_word(row->held);
    print_line(to, setting->name, word != NULL ? word : row->text, setting->unit, setting->what);
    if (row->held == HELD_NOT_THERE) (void)fprintf(to, "; %s", setting_reason(row->status));
    if (row->held == HELD_NOT_SETTABLE) {
        char values[SETTING_VALUES];
        (void)fprintf(to, "; it has %s, which cannot be set: %s", row->text,
                      setting_values_text(setting, values));
    }
    (void)fputs("\n", to);
}

static void print_group(FILE *to, const backup_t *unit, size_t group)
{
    bool is_begun = false;
    for (size_t i = 0; i != backup_count(unit->model); i++) {
        const setting_t *const setting = &unit->model->settings[i];
        const backup_row_t *const row = &unit->rows[i];
        if (row->held == HELD_NOTHING || !groups[group].is_in(setting, row)) continue;
        if (!is_begun) (void)fprintf(to, "\n%s", groups[group].heading);
        is_begun = true;
        print_row(to, setting, row);
    }
}

void backup_print(FILE *to, const backup_t *unit, const char *place, const char *when)
{
    (void)fprintf(to,
                  "# The settings of a range sensor, read by fathom save %s at\n"
                  "# %s, %s. fathom restore writes them into a unit.\n"
                  "# A value may be changed; a line may be taken out, then restore leaves that as it is.\n\n",
                  FATHOM_VERSION_STRING, place, when);
    print_line(to, sensor, unit->model->name, NULL, unit->model->what);
    (void)fputs("\n", to);
    for (size_t i = 0; i != sizeof groups / sizeof groups[0]; i++) print_group(to, unit, i);
}

/* ---- reading ---- */

typedef struct {
    const char *path;
    backup_t *backup;
    unsigned line; /* 0: of the whole file */
    bool has_sensor;
} parser_t;

static backup_result_t wrong(const parser_t *parser, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static backup_result_t wrong(const parser_t *parser, const char *format, ...)
{
    va_list arguments;
    (void)fprintf(stderr, "fathom: %s:", parser->path);
    if (parser->line != 0) (void)fprintf(stderr, "%u:", parser->line);
    (void)fputs(" ", stderr);
    va_start(arguments, format);
    (void)vfprintf(stderr, format, arguments);
    va_end(arguments);
    (void)fputs("\n", stderr);
    return BACKUP_INVALID;
}

backup_result_t backup_refuse(const char *path, const backup_row_t *row, const char *why)
{
    const parser_t parser = {.path = path, .line = row->line};
    return wrong(&parser, "%s", why);
}

/* Returns the text without blanks at both ends. */
static char *trim(char *text)
{
    size_t length = strlen(text);
    while (length != 0 && strchr(" \t\r", text[length - 1]) != NULL) text[--length] = '\0';
    return text + strspn(text, " \t");
}

static backup_result_t parse_sensor(parser_t *parser, const char *value)
{
    if (parser->has_sensor) return wrong(parser, "%s occurs twice", sensor);
    if (strcmp(value, parser->backup->model->name) != 0)
        return wrong(parser, "the file belongs to '%s', and the sensor is an %s", value,
                     parser->backup->model->name);
    parser->has_sensor = true;
    return BACKUP_OK;
}

static backup_result_t parse_value(const parser_t *parser, const setting_t *setting, backup_row_t *row,
                                   const char *value)
{
    if (strlen(value) >= sizeof row->text) return wrong(parser, "the value of %s is too long", setting->name);
    if (row->line != 0) return wrong(parser, "%s occurs in line %u already", setting->name, row->line);
    row->line = parser->line;
    for (held_t held = HELD_NOT_READABLE; held <= HELD_NOT_SETTABLE; held++) {
        if (strcmp(value, backup_word(held)) != 0) continue;
        row->held = held;
        return BACKUP_OK;
    }
    if (setting->set != NULL && !backup_value(setting, value, &row->value)) {
        char values[SETTING_VALUES];
        return wrong(parser, "%s takes %s, not '%s'", setting->name, setting_values_text(setting, values),
                     value);
    }
    row->held = HELD_VALUE;
    (void)snprintf(row->text, sizeof row->text, "%s", value);
    return BACKUP_OK;
}

/* Names and values are printed, so they must not contain what controls a terminal. */
static bool is_printable(const char *text)
{
    for (; *text != '\0'; text++)
        if ((*text < ' ' || *text > '~') && *text != '\t') return false;
    return true;
}

static backup_result_t parse_line(parser_t *parser, char *line)
{
    const model_t *const model = parser->backup->model;
    line[strcspn(line, "#")] = '\0';
    char *const name = trim(line);
    char *const sign = strchr(name, '=');
    if (name[0] == '\0') return BACKUP_OK;
    if (!is_printable(name))
        return wrong(parser, "the line has a character that cannot be printed or is not ASCII");
    if (sign == NULL) return wrong(parser, "'%s' does not have the form NAME = VALUE", name);
    *sign = '\0';
    const char *const value = trim(sign + 1);
    (void)trim(name);
    if (strcmp(name, sensor) == 0) return parse_sensor(parser, value);
    if (!parser->has_sensor)
        return wrong(parser, "the line '%s' comes before the line '%s = %s'", name, sensor, model->name);
    for (size_t i = 0; i != backup_count(model); i++)
        if (backup_has(&model->settings[i]) && strcmp(model->settings[i].name, name) == 0)
            return parse_value(parser, &model->settings[i], &parser->backup->rows[i], value);
    return wrong(parser, "'%s' is no setting that 'fathom save' prints for an %s", name, model->name);
}

/* Reads a line without its end. Returns false at the end of the file. *length exceeds BACKUP_LINE if it is too long. */
static bool get_line(FILE *from, char line[BACKUP_LINE + 2], size_t *length, bool *has_zero)
{
    int c;
    *length = 0;
    while ((c = getc(from)) != EOF && c != '\n') {
        if (c == 0) *has_zero = true;
        if (*length <= BACKUP_LINE) line[(*length)++] = (char)c;
    }
    line[*length] = '\0';
    return c != EOF || *length != 0;
}

static backup_result_t parse(parser_t *parser, FILE *from)
{
    char line[BACKUP_LINE + 2];
    size_t length;
    bool has_zero = false;
    backup_result_t result = BACKUP_OK;
    errno = 0;
    while (result == BACKUP_OK && get_line(from, line, &length, &has_zero)) {
        parser->line++;
        if (length > BACKUP_LINE)
            result = wrong(parser, "the line is longer than %d characters", BACKUP_LINE);
        else if (has_zero)
            result = wrong(parser, "the line has a byte 0, so this is no text file");
        else
            result = parse_line(parser, line);
    }
    if (ferror(from) != 0) {
        parser->line = 0;
        (void)wrong(parser, "%s", strerror(errno));
        return BACKUP_UNREADABLE;
    }
    if (result != BACKUP_OK || parser->has_sensor) return result;
    parser->line = 0;
    return wrong(parser, "the line '%s = %s' is missing. Is this a file of 'fathom save'?", sensor,
                 parser->backup->model->name);
}

backup_result_t backup_parse(const char *path, const model_t *model, backup_t *file)
{
    parser_t parser = {.path = path, .backup = file};
    memset(file, 0, sizeof *file);
    file->model = model;
    FILE *const from = fopen(path, "r");
    if (from == NULL) {
        (void)wrong(&parser, "%s", strerror(errno));
        return BACKUP_UNREADABLE;
    }
    const backup_result_t result = parse(&parser, from);
    (void)fclose(from);
    return result;
}
