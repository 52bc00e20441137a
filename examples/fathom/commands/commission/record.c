/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): getline */
#include "commands/commission/record.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "device/session.h"
#include "output/words.h"

static const char title[] = "# fathom commission: which unit has which address, or is to have it";
static const char columns[] =
    "# sensor, address, UUID (- if it has none), planned or done, time of the last change\n";

bool record_has_numbers(const model_t *model) { return setting_of(model->settings, "uuid") != NULL; }

const record_unit_t *record_of(const record_t *record, const model_t *model, const char *number)
{
    for (size_t i = 0; i != RECORD_UNITS && record_has_numbers(model); i++)
        if (record->units[i].model == model && strcmp(record->units[i].number, number) == 0)
            return &record->units[i];
    return NULL;
}

static bool fail(const record_t *record)
{
    (void)fprintf(stderr, "fathom: cannot read the record %s: %s\n", record->path, strerror(errno));
    return false;
}

/* ---- reading ---- */

static bool is_number(const model_t *model, const char *text)
{
    enum { HEX = 32 };
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
    if (sscanf(text, "%15s %15s %63s %15s %23s %1s", model, address, unit.number, state, unit.when, rest) !=
        5)
        return "a line has five words: sensor, address, UUID, planned or done, time";
    unit.model = model_find(model);
    if (unit.model == NULL) return "unknown sensor";
    if (!number_parse(address, 1, unit.model->max_address, &number))
        return "this sensor cannot have this address";
    if (!is_number(unit.model, unit.number)) return "invalid UUID";
    unit.is_done = strcmp(state, "done") == 0;
    if (!unit.is_done && strcmp(state, "planned") != 0) return "the state is neither planned nor done";
    if (!is_time(unit.when)) return "invalid time";
    unit.address = (uint8_t)number;
    if (record->units[unit.address].model != NULL) return "this address is in the record twice";
    if (record_of(record, unit.model, unit.number) != NULL) return "this UUID is in the record twice";
    record->units[unit.address] = unit;
    return NULL;
}

bool record_read(record_t *record, const char *path)
{
    char *text = NULL;
    size_t size = 0;
    ssize_t length = 0;
    unsigned line = 0;
    const char *wrong = NULL;
    memset(record, 0, sizeof *record);
    record->path = path;
    FILE *const file = fopen(path, "r");
    if (file == NULL) return errno == ENOENT || fail(record);
    while (wrong == NULL && (length = getline(&text, &size, file)) > 0) {
        char *const end = &text[length - 1];
        line++;
        if (*end != '\n') wrong = "the end of the line is missing";
        *end = '\0';
        if (wrong == NULL && line == 1 && strcmp(text, title) != 0)
            wrong = "this file is no record of fathom commission";
        else if (wrong == NULL && text[0] != '#' && text[0] != '\0')
            wrong = parse_line(record, text);
    }
    const bool is_read = ferror(file) == 0 || fail(record);
    if (wrong != NULL)
        (void)fprintf(stderr,
                      "fathom: %s:%u: %s. Nothing was sent. Correct the line, or use another --record.\n",
                      path, line, wrong);
    else if (is_read && line == 0)
        (void)fprintf(stderr, "fathom: the record %s is empty. Remove the file to start a new record.\n",
                      path);
    free(text);
    (void)fclose(file);
    return is_read && wrong == NULL && line != 0;
}

/* ---- writing ---- */

static void print_all(FILE *to, const void *ctx)
{
    const record_t *const record = ctx;
    (void)fprintf(to, "%s\n%s", title, columns);
    for (size_t i = 0; i != RECORD_UNITS; i++) {
        const record_unit_t *const unit = &record->units[i];
        if (unit->model == NULL) continue;
        (void)fprintf(to, "%s %u %s %s %s\n", unit->model->name, unit->address, unit->number,
                      unit->is_done ? "done" : "planned", unit->when);
    }
}

bool record_write(const record_t *record) { return file_write(record->path, true, print_all, record); }

bool record_put(record_t *record, const record_unit_t *unit, uint64_t utc_us)
{
    char text[UTC_TEXT];
    record_unit_t *const to = &record->units[unit->address];
    const record_unit_t was = *to;
    *to = *unit;
    (void)snprintf(to->when, sizeof to->when, "%.19sZ", utc_text(utc_us, text));
    if (record_write(record)) return true;
    *to = was;
    return false;
}
