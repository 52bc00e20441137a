/* SPDX-License-Identifier: MIT */
#include "output/record.h"

#include <inttypes.h>
#include <stdbool.h>
#include <string.h>

enum { VALUE = 32 };

static bool is_there(const field_t *field, unsigned columns)
{
    return (field->needs & columns) == field->needs;
}

static void print_decimal(char text[VALUE], int64_t value, int places, int64_t one)
{
    const int64_t size = value < 0 ? -value : value;
    (void)snprintf(text, VALUE, "%s%" PRId64 ".%0*" PRId64, value < 0 ? "-" : "", size / one, places,
                   size % one);
}

/* Returns the value as text, in `text` unless it is a word. Returns NULL for null. */
static const char *value_of(const field_t *field, const void *record, char text[VALUE])
{
    const void *const member = (const char *)record + field->at;
    if (field->type == FIELD_WORD) return *(const char *const *)member;
    const int64_t number = *(const int64_t *)member;
    if (number == NO_VALUE) return NULL;
    if (field->type == FIELD_FLAG) return number != 0 ? "true" : "false";
    if (field->type == FIELD_TENTHS)
        print_decimal(text, number, 1, 10);
    else if (field->type == FIELD_TEN_THOUSANDTHS)
        print_decimal(text, number, 4, 10000);
    else
        (void)snprintf(text, VALUE, "%" PRId64, number);
    return text;
}

void record_json(json_t *json, const field_t *fields, const void *record, unsigned columns)
{
    for (; fields->key != NULL; fields++) {
        char text[VALUE];
        if (!is_there(fields, columns)) continue;
        const char *const value = value_of(fields, record, text);
        if (fields->type == FIELD_WORD)
            json_string(json, fields->key, value);
        else
            json_number(json, fields->key, value != NULL ? value : "null");
    }
}

void record_json_line(FILE *to, const field_t *fields, const void *record, unsigned columns)
{
    json_t json = {.to = to};
    json_begin(&json, NULL, '{');
    record_json(&json, fields, record, columns);
    json_end(&json, '}');
    (void)fputc('\n', to);
}

void record_csv_header(FILE *to, const field_t *fields, unsigned columns)
{
    const char *comma = "";
    for (; fields->key != NULL; fields++) {
        if (!is_there(fields, columns)) continue;
        (void)fprintf(to, "%s%s", comma, fields->key);
        comma = ",";
    }
    (void)fputc('\n', to);
}

/* Quotes a value that has a comma, a quotation mark or a line break, by RFC 4180. */
static void put_csv(FILE *to, const char *value)
{
    if (strpbrk(value, ",\"\r\n") == NULL) {
        (void)fputs(value, to);
        return;
    }
    (void)fputc('"', to);
    for (; *value != '\0'; value++) (void)fprintf(to, *value == '"' ? "\"\"" : "%c", *value);
    (void)fputc('"', to);
}

void record_csv(FILE *to, const field_t *fields, const void *record, unsigned columns, unsigned all)
{
    const char *comma = "";
    for (; fields->key != NULL; fields++) {
        char text[VALUE];
        if (!is_there(fields, all)) continue;
        const char *const value = is_there(fields, columns) ? value_of(fields, record, text) : NULL;
        (void)fputs(comma, to);
        put_csv(to, value != NULL ? value : "");
        comma = ",";
    }
    (void)fputc('\n', to);
}

void record_print(FILE *to, const field_t *fields, const void *record, unsigned columns)
{
    const char *comma = "";
    for (; fields->key != NULL; fields++) {
        char text[VALUE];
        if (!is_there(fields, columns)) continue;
        const char *const value = value_of(fields, record, text);
        (void)fprintf(to, "%s%s %s", comma, fields->key, value != NULL ? value : "-");
        comma = ", ";
    }
}

bool record_print_used(FILE *to, const char *before, const field_t *fields, const void *record)
{
    bool is_used = false;
    for (; fields->key != NULL; fields++) {
        const int64_t number = *(const int64_t *)(const void *)((const char *)record + fields->at);
        if (number == 0) continue;
        (void)fprintf(to, "%s%s %" PRId64, is_used ? ", " : before, fields->key, number);
        is_used = true;
    }
    return is_used;
}

void record_help(FILE *to, const field_t *fields)
{
    for (; fields->key != NULL; fields++)
        if (fields->help != NULL)
            (void)fprintf(to, "  %-17s %-6s  %s\n", fields->key, fields->unit, fields->help);
}
