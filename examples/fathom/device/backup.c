/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): asprintf, getline, fsync, lstat */
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "device/session.h"
#include "fathom/version.h"
#include "output/words.h"

static const char *const words[] = {[HELD_NOT_READABLE] = "not readable",
                                    [HELD_NOT_THERE] = "not there",
                                    [HELD_NOT_SETTABLE] = "not settable"};

const char *value_text(const value_t *value)
{
    return value->held >= HELD_NOT_READABLE ? words[value->held] : value->text;
}

bool value_is_same(const value_t *one, const value_t *other)
{
    return one->held == HELD_VALUE && other->held == HELD_VALUE && strcmp(one->text, other->text) == 0;
}

static bool is_kept(const setting_t *setting)
{
    return setting->kind != SETTING_PRESENT && setting->mode == NULL;
}

void values_begin(values_t *values, const model_t *model, bool (*is_wanted)(const setting_t *setting))
{
    size_t count = 0;
    *values = (values_t){.model = model};
    for (const setting_t *setting = model->settings; setting->name != NULL; setting++)
        if (is_wanted(setting)) values->rows[count++].setting = setting;
}

/* Stores a text from a file or from the sensor as the sensor reports it. Returns false if that cannot be set. */
static bool store(value_t *value, const char *text)
{
    int32_t number = 0;
    const bool can_be_set = value->setting->effect != NULL && setting_value(value->setting, text, &number);
    (void)snprintf(value->text, sizeof value->text, "%s", text);
    if (can_be_set) setting_print_value(value->setting, number, value->text);
    value->held = can_be_set || value->setting->effect == NULL ? HELD_VALUE : HELD_NOT_SETTABLE;
    return value->held == HELD_VALUE;
}

/* ---- reading a sensor ---- */

/* One response may be lost, and a backup without this value, or with "not there", would be wrong. */
static fathom_status_t read_repeatedly(session_t *session, const setting_t *setting, unsigned times,
                                       char text[SETTING_TEXT])
{
    fathom_status_t status;
    do status = session_get(session, setting, text);
    while (--times != 0 && (setting_reason(status) != NULL || status == FATHOM_ERR_CHECKSUM ||
                            status == FATHOM_ERR_LINE_BUSY || status == FATHOM_ERR_OTHER_MASTER));
    return status;
}

/* Returns the first value that can be read in the sensor's mode; NULL: there is none. */
static const setting_t *first_readable(const session_t *session)
{
    const model_t *const model = session->sensor->model;
    for (const setting_t *setting = model->settings; setting->name != NULL; setting++)
        if (setting->read_at != 0 && model_mode_of(model, setting) == session->sensor->mode) return setting;
    return NULL;
}

/* Fills in a setting that cannot be read. Of these, the address is known: the sensor responds there. */
static void hold_unread(const session_t *session, value_t *value)
{
    const setting_t *const setting = value->setting;
    value->held = setting->moves && setting->mode == NULL ? HELD_VALUE : HELD_NOT_READABLE;
    if (value->held == HELD_VALUE) setting_print_value(setting, session->sensor->address, value->text);
}

/* Returns true if a setting may be absent. A backup without a setting that each sensor has would be wrong. */
static bool may_be_absent(const setting_t *setting, bool is_backup, bool is_other_known)
{
    return is_backup ? setting->is_of_variant || setting->effect == NULL : is_other_known;
}

/* Reads the values until it is uncertain that the sensor responds. Returns the setting that shows this, or NULL. */
static const setting_t *read_rows(session_t *session, values_t *values, bool is_backup,
                                  fathom_status_t *status)
{
    const unsigned times = is_backup ? 3 : 1;
    const setting_t *known = NULL; /* a setting that was read */
    const value_t *failed = NULL;  /* was not read; others in the same response are not requested again */
    char text[SETTING_TEXT];
    for (value_t *value = values->rows; value->setting != NULL; value++) {
        const setting_t *const setting = value->setting;
        if (setting->read_at == 0) {
            hold_unread(session, value);
            continue;
        }
        *status = failed != NULL && setting->read_at == failed->setting->read_at
                      ? failed->status
                      : read_repeatedly(session, setting, times, text);
        if (*status == FATHOM_OK) {
            (void)store(value, text);
            known = setting;
            values->is_known = true;
            continue;
        }
        if (!may_be_absent(setting, is_backup, known != NULL) || setting_reason(*status) == NULL)
            return setting;
        value->held = HELD_NOT_THERE;
        value->status = *status;
        failed = value;
    }
    if (known == NULL && failed != NULL) return failed->setting;
    if (known != NULL && (failed == NULL || !is_backup)) return NULL;
    /* A setting is missing only if the sensor still responds, and nothing is known if nothing was requested. */
    if (known == NULL) known = first_readable(session);
    if (known == NULL) return NULL;
    *status = read_repeatedly(session, known, times, text);
    return *status != FATHOM_OK ? known : NULL;
}

bool values_read(session_t *session, values_t *values, bool is_backup)
{
    fathom_status_t status = FATHOM_OK;
    session_begin_task(session, "reading the settings");
    const setting_t *const failed = read_rows(session, values, is_backup, &status);
    session_end_task(session);
    if (failed != NULL) return session_fail(session, status, "%s", failed->name);
    values->is_known = true;
    return true;
}

bool backup_read(session_t *session, values_t *unit)
{
    values_begin(unit, session->sensor->model, is_kept);
    return values_read(session, unit, true);
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

static group_t group_of(const value_t *value)
{
    if (value->setting->effect == NULL) return GROUP_IDENTITY;
    if (value->setting->moves) return GROUP_PLACE;
    return value->held == HELD_NOT_READABLE ? GROUP_NOT_READABLE : GROUP_SETTINGS;
}

/* "warm-up = 5                     # s, how long ..." */
static void print_line(FILE *to, const char *name, const char *value, const char *unit, const char *what)
{
    const int length = fprintf(to, "%s = %s", name, value);
    (void)fprintf(to, "%*s # %s%s%s", length < 40 ? 40 - length : 0, "", unit != NULL ? unit : "",
                  unit != NULL ? ", " : "", what);
}

static void print_row(FILE *to, const value_t *value)
{
    const setting_t *const setting = value->setting;
    print_line(to, setting->name, value_text(value), setting->unit, setting->what);
    if (value->held == HELD_NOT_THERE) (void)fprintf(to, "; %s", setting_reason(value->status));
    if (value->held == HELD_NOT_SETTABLE) {
        char text[SETTING_VALUES];
        (void)fprintf(to, "; it has %s, which cannot be set: %s", value->text,
                      setting_values_text(setting, text));
    }
    (void)fputs("\n", to);
}

void backup_print(FILE *to, const values_t *unit, const char *place, const char *when)
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
        for (const value_t *value = unit->rows; value->setting != NULL; value++) {
            if (value->held == HELD_NOTHING || group_of(value) != group) continue;
            if (heading != NULL) (void)fprintf(to, "\n# %s\n", heading);
            heading = NULL;
            print_row(to, value);
        }
    }
}

/* ---- reading the file ---- */

typedef struct {
    const char *path;
    values_t *file;
    unsigned line; /* 0: of the whole file */
    bool has_sensor;
    bool moves; /* the address is to be written */
} parser_t;

__attribute__((format(printf, 2, 3))) static int wrong(const parser_t *parser, const char *format, ...)
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

static int parse_value(const parser_t *parser, value_t *value, const char *text)
{
    const setting_t *const setting = value->setting;
    if (strlen(text) >= sizeof value->text)
        return wrong(parser, "the value of %s is too long", setting->name);
    if (value->line != 0) return wrong(parser, "%s occurs in line %u already", setting->name, value->line);
    value->line = parser->line;
    for (value->held = HELD_NOT_READABLE; value->held <= HELD_NOT_SETTABLE; value->held++)
        if (strcmp(text, words[value->held]) == 0) return STATUS_OK;
    if (!store(value, text)) {
        char values[SETTING_VALUES];
        return wrong(parser, "%s takes %s, not '%s'", setting->name, setting_values_text(setting, values),
                     text);
    }
    if (parser->moves && setting->has_zero && strcmp(value->text, "0") == 0)
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
    const model_t *const model = parser->file->model;
    line[strcspn(line, "#")] = '\0';
    char *const name = trim(line);
    char *const sign = strchr(name, '=');
    if (name[0] == '\0') return STATUS_OK;
    if (!is_printable(name))
        return wrong(parser, "the line has a character that cannot be printed or is not ASCII");
    if (sign == NULL) return wrong(parser, "'%s' does not have the form NAME = VALUE", name);
    *sign = '\0';
    const char *const text = trim(sign + 1);
    (void)trim(name);
    if (strcmp(name, "sensor") == 0) {
        if (parser->has_sensor) return wrong(parser, "sensor occurs twice");
        if (strcmp(text, model->name) != 0)
            return wrong(parser, "the file belongs to '%s', and the sensor is an %s", text, model->name);
        parser->has_sensor = true;
        return STATUS_OK;
    }
    if (!parser->has_sensor)
        return wrong(parser, "the line '%s' comes before the line 'sensor = %s'", name, model->name);
    for (value_t *value = parser->file->rows; value->setting != NULL; value++)
        if (strcmp(value->setting->name, name) == 0) return parse_value(parser, value, text);
    /* fathom 0.6.0 saved load-settings, which is a command. */
    if (setting_of(model->settings, name) != NULL && strcmp(text, words[HELD_NOT_READABLE]) == 0)
        return STATUS_OK;
    return wrong(parser, "'%s' is no setting that 'fathom save' prints for an %s", name, model->name);
}

/* Returns a status; with STATUS_FAILED, errno has the reason. */
static int parse(parser_t *parser, FILE *from)
{
    enum { LINE = 250 };
    char *line = NULL;
    size_t capacity = 0;
    ssize_t length;
    int status = STATUS_OK;
    while (status == STATUS_OK && (length = getline(&line, &capacity, from)) >= 0) {
        parser->line++;
        if (line[length - 1] == '\n') line[--length] = '\0';
        if (length > LINE)
            status = wrong(parser, "the line is longer than %d characters", LINE);
        else if (strlen(line) != (size_t)length)
            status = wrong(parser, "the line has a byte 0, so this is no text file");
        else
            status = parse_line(parser, line);
    }
    free(line);
    return status == STATUS_OK && feof(from) == 0 ? STATUS_FAILED : status;
}

int backup_parse(const char *path, const model_t *model, bool moves, values_t *file)
{
    parser_t parser = {.path = path, .file = file, .moves = moves};
    values_begin(file, model, is_kept);
    FILE *const from = fopen(path, "r");
    int status = from != NULL ? parse(&parser, from) : STATUS_FAILED;
    if (status != STATUS_USAGE) parser.line = 0;
    if (status == STATUS_FAILED)
        (void)wrong(&parser, "%s", strerror(errno));
    else if (status == STATUS_OK && !parser.has_sensor)
        status = wrong(&parser, "the line 'sensor = %s' is missing. Is this a file of 'fathom save'?",
                       model->name);
    if (from != NULL) (void)fclose(from);
    return status;
}

/* ---- a file that is complete or not there ---- */

static bool fail_file(const char *path, int error)
{
    if (error == EEXIST)
        (void)fprintf(
            stderr, "fathom: %s exists and is not overwritten. Use another name, or move the file.\n", path);
    else
        (void)fprintf(stderr, "fathom: cannot write %s: %s\n", path, strerror(error));
    return false;
}

bool file_is_free(const char *path)
{
    struct stat is;
    return lstat(path, &is) != 0 || fail_file(path, EEXIST);
}

/* Writes a new file to the disk. Returns 0, or errno. */
static int write_new(const char *path, file_print_t print, const void *ctx)
{
    FILE *const file = fopen(path, "wx");
    if (file == NULL) return errno;
    errno = 0;
    print(file, ctx);
    const bool is_good = ferror(file) == 0 && fflush(file) == 0 && fsync(fileno(file)) == 0;
    const int error = is_good ? 0 : errno != 0 ? errno : EIO;
    return fclose(file) == 0 || error != 0 ? error : errno;
}

/* Creates the name, which only one program can, before the file is renamed to it. Needs no hard links, which a USB stick
 * does not have. Returns 0, or errno. */
static int set_name(const char *from, const char *to, bool replaces)
{
    FILE *const file = replaces ? NULL : fopen(to, "wx");
    if (file == NULL && !replaces) return errno;
    if (file != NULL) (void)fclose(file);
    if (rename(from, to) == 0) return 0;
    const int error = errno;
    if (!replaces) (void)unlink(to);
    return error;
}

/* The new name is on the disk only when its folder is. Not every file system supports this. */
static void sync_folder(const char *path)
{
    const char *const slash = strrchr(path, '/');
    char *const folder = slash != NULL ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
    const int fd = folder != NULL ? open(folder, O_RDONLY) : -1;
    free(folder);
    if (fd < 0) return;
    (void)fsync(fd);
    (void)close(fd);
}

bool file_write(const char *path, bool replaces, file_print_t print, const void *ctx)
{
    char *fresh = NULL;
    if (asprintf(&fresh, "%s.%ld.part", path, (long)getpid()) < 0) return fail_file(path, ENOMEM);
    int error = write_new(fresh, print, ctx);
    if (error == 0) error = set_name(fresh, path, replaces);
    if (error == 0)
        sync_folder(path);
    else
        (void)unlink(fresh);
    free(fresh);
    return error == 0 || fail_file(path, error);
}
