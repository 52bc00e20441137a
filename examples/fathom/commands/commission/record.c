/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): fdopen, fsync */
#include "commands/commission/record.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include "device/setting_text.h"
#include "output/words.h"

static const char title[] = "# fathom commission: which unit has which address, or is to have it";
static const char columns[] =
    "# sensor, address, UUID (- if it has none), planned or done, time of the last change\n";

enum { LINE = 200, PATH = 4096, HEX = 32 };

const char *const record_states[] = {"planned", "done"};

bool record_has_numbers(const model_t *model) { return setting_of(model->settings, "uuid") != NULL; }

record_unit_t *record_at(record_t *record, uint8_t address)
{
    for (uint32_t i = 0; i != record->count; i++)
        if (record->units[i].address == address) return &record->units[i];
    return NULL;
}

record_unit_t *record_of(record_t *record, const model_t *model, const char *number)
{
    for (uint32_t i = 0; i != record->count; i++) {
        record_unit_t *const unit = &record->units[i];
        if (unit->model == model && record_has_numbers(model) && strcmp(unit->number, number) == 0)
            return unit;
    }
    return NULL;
}

/* ---- reading ---- */

static const model_t *model_named(const char *name)
{
    for (size_t i = 0; i != model_count; i++)
        if (strcmp(models[i].name, name) == 0) return &models[i];
    return NULL;
}

static bool is_number(const model_t *model, const char *text)
{
    if (!record_has_numbers(model)) return strcmp(text, "-") == 0;
    return strlen(text) == HEX && strspn(text, "0123456789abcdef") == HEX;
}

/* The time is printed as it is, also in JSON. */
static bool is_time(const char *text)
{
    for (; *text != '\0'; text++)
        if (*text <= ' ' || *text > '~' || *text == '"' || *text == '\\') return false;
    return true;
}

/* Adds a line to the record. Returns what is wrong with the line, or NULL. */
static const char *parse_line(record_t *record, const char *text)
{
    record_unit_t unit;
    char model[16];
    char address[16];
    char state[16];
    char rest[2];
    uint32_t number = 0;
    const int found =
        sscanf(text, "%15s %15s %63s %15s %23s %1s", model, address, unit.number, state, unit.when, rest);
    if (found != 5) return "a line has five words: sensor, address, UUID, planned or done, time";
    unit.model = model_named(model);
    if (unit.model == NULL) return "unknown sensor";
    if (!number_parse(address, 1, unit.model->max_address, &number))
        return "this sensor cannot have this address";
    if (!is_number(unit.model, unit.number)) return "invalid UUID";
    for (unit.state = RECORD_PLANNED; strcmp(state, record_states[unit.state]) != 0; unit.state++)
        if (unit.state == RECORD_DONE) return "the state is neither planned nor done";
    if (!is_time(unit.when)) return "invalid time";
    unit.address = (uint8_t)number;
    if (record_at(record, unit.address) != NULL) return "this address is in the record twice";
    if (record_of(record, unit.model, unit.number) != NULL) return "this UUID is in the record twice";
    record->units[record->count++] = unit;
    return NULL;
}

static bool parse_lines(record_t *record, FILE *file)
{
    char text[LINE];
    for (unsigned line = 1; fgets(text, sizeof text, file) != NULL; line++) {
        const char *wrong = NULL;
        char *const end = strchr(text, '\n');
        if (end != NULL) *end = '\0';
        if (end == NULL)
            wrong = "the end of the line is missing";
        else if (line == 1 && strcmp(text, title) != 0)
            wrong = "this file is no record of fathom commission";
        else if (text[0] != '#' && text[0] != '\0')
            wrong = parse_line(record, text);
        if (wrong == NULL) continue;
        (void)fprintf(stderr,
                      "fathom: %s:%u: %s. Nothing was sent. Correct the line, or use another --record.\n",
                      record->path, line, wrong);
        return false;
    }
    return true;
}

static bool fail(const record_t *record, const char *what)
{
    (void)fprintf(stderr, "fathom: cannot %s the record %s: %s\n", what, record->path, strerror(errno));
    return false;
}

bool record_read(record_t *record, const char *path)
{
    memset(record, 0, sizeof *record);
    record->path = path;
    FILE *const file = fopen(path, "r");
    if (file == NULL) return errno == ENOENT || fail(record, "read");
    bool is_good = parse_lines(record, file);
    if (is_good && ferror(file) != 0) is_good = fail(record, "read");
    if (is_good && ftell(file) == 0) {
        (void)fprintf(stderr, "fathom: the record %s is empty. Remove the file to start a new record.\n",
                      path);
        is_good = false;
    }
    (void)fclose(file);
    return is_good;
}

/* ---- writing ---- */

static bool print_all(const record_t *record, FILE *file)
{
    (void)fprintf(file, "%s\n%s", title, columns);
    for (uint32_t i = 0; i != record->count; i++) {
        const record_unit_t *const unit = &record->units[i];
        (void)fprintf(file, "%s %u %s %s %s\n", unit->model->name, unit->address, unit->number,
                      record_states[unit->state], unit->when);
    }
    return fflush(file) == 0 && ferror(file) == 0 && fsync(fileno(file)) == 0;
}

/* The new name is on the disk only when its folder is. Not every file system supports this. */
static void sync_folder(const char *path)
{
    char folder[PATH] = ".";
    const char *const slash = strrchr(path, '/');
    if (slash != NULL) (void)snprintf(folder, sizeof folder, "%.*s", (int)(slash - path) + 1, path);
    const int fd = open(folder, O_RDONLY);
    if (fd < 0) return;
    (void)fsync(fd);
    (void)close(fd);
}

bool record_write(const record_t *record)
{
    char fresh[PATH];
    if ((size_t)snprintf(fresh, sizeof fresh, "%s.new", record->path) >= sizeof fresh) {
        errno = ENAMETOOLONG;
        return fail(record, "write");
    }
    FILE *const file = fopen(fresh, "w");
    if (file == NULL) return fail(record, "write");
    const bool is_put = print_all(record, file);
    const int error = errno;
    if (fclose(file) == 0 && is_put && rename(fresh, record->path) == 0) {
        sync_folder(record->path);
        return true;
    }
    if (!is_put) errno = error;
    (void)fail(record, "write");
    (void)remove(fresh);
    return false;
}

record_unit_t *record_put(record_t *record, const record_unit_t *unit, uint64_t utc_us)
{
    char text[UTC_TEXT];
    record_unit_t *to = record_at(record, unit->address);
    if (to == NULL) to = &record->units[record->count++];
    const record_unit_t was = *to;
    *to = *unit;
    (void)snprintf(to->when, sizeof to->when, "%.19sZ", utc_text(utc_us, text));
    if (record_write(record)) return to;
    *to = was;
    if (was.model == NULL) record->count--;
    return NULL;
}

bool record_drop(record_t *record, const record_unit_t *unit)
{
    const uint32_t at = (uint32_t)(unit - record->units);
    memmove(&record->units[at], &record->units[at + 1], (record->count - at - 1) * sizeof *unit);
    record->count--;
    return record_write(record);
}
