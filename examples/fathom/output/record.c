/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): fputs_unlocked */
#include "output/record.h"

#include <inttypes.h>
#include <stdarg.h>
#include <string.h>

#include "output/words.h"

/* ---- JSON ---- */

static bool is_plain(unsigned char c) { return c >= 0x20 && c != '"' && c != '\\'; }

/* Writes plain characters as a whole, and single ones without taking the lock of the stream: no other thread writes. */
static void put_string(FILE *to, const char *text)
{
    (void)putc_unlocked('"', to);
    while (*text != '\0') {
        size_t length = 0;
        while (is_plain((unsigned char)text[length])) length++;
        (void)fwrite(text, 1, length, to);
        text += length;
        if (*text == '\0') break;
        (void)fprintf(to, (unsigned char)*text < 0x20 ? "\\u%04x" : "\\%c", *text);
        text++;
    }
    (void)putc_unlocked('"', to);
}

static void put_key(json_t *json, const char *key)
{
    if (json->has_member) (void)putc_unlocked(',', json->to);
    json->has_member = true;
    if (key == NULL) return;
    (void)putc_unlocked('"', json->to);
    (void)fputs_unlocked(key, json->to); /* keys need no escapes */
    (void)fputs_unlocked("\":", json->to);
}

void json_begin(json_t *json, const char *key, char bracket)
{
    put_key(json, key);
    (void)putc_unlocked(bracket, json->to);
    json->has_member = false;
}

void json_end(json_t *json, char bracket)
{
    (void)putc_unlocked(bracket, json->to);
    json->has_member = true;
}

void json_value(json_t *json, const char *key, const char *format, ...)
{
    va_list arguments;
    put_key(json, key);
    va_start(arguments, format);
    (void)vfprintf(json->to, format, arguments);
    va_end(arguments);
}

void json_flag(json_t *json, const char *key, bool flag) { json_value(json, key, flag ? "true" : "false"); }

void json_string(json_t *json, const char *key, const char *text)
{
    put_key(json, key);
    if (text != NULL)
        put_string(json->to, text);
    else
        (void)fputs("null", json->to);
}

void json_bytes(json_t *json, const char *key, const uint8_t *bytes, size_t count)
{
    put_key(json, key);
    (void)putc_unlocked('"', json->to);
    for (size_t i = 0; i != count; i++) (void)fprintf(json->to, "%s%02X", i != 0 ? " " : "", bytes[i]);
    (void)putc_unlocked('"', json->to);
}

/* ---- records ---- */

static bool is_there(const field_t *field, unsigned columns)
{
    return (field->needs & columns) == field->needs;
}

static const void *member_of(const field_t *field, const void *record)
{
    return (const char *)record + field->at;
}

/* Returns the value as text, in `text` unless it is a word. Returns NULL for null. */
static const char *value_of(const field_t *field, const void *record, char text[DECIMAL_TEXT])
{
    const void *const member = member_of(field, record);
    if (field->type == FIELD_WORD) return *(const char *const *)member;
    const int64_t number = *(const int64_t *)member;
    if (number == NO_VALUE) return NULL;
    if (field->type == FIELD_FLAG) return number != 0 ? "true" : "false";
    const unsigned places = field->type == FIELD_TENTHS ? 1 : field->type == FIELD_TEN_THOUSANDTHS ? 4 : 0;
    decimal_text(text, number, places);
    return text;
}

void record_json(json_t *json, const field_t *fields, const void *record, unsigned columns)
{
    for (; fields->key != NULL; fields++) {
        char text[DECIMAL_TEXT];
        if (!is_there(fields, columns)) continue;
        const char *const value = value_of(fields, record, text);
        if (fields->type == FIELD_WORD) {
            json_string(json, fields->key, value);
        } else {
            put_key(json, fields->key);
            (void)fputs_unlocked(value != NULL ? value : "null", json->to);
        }
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
        char text[DECIMAL_TEXT];
        const char *value = NULL;
        if (!is_there(fields, all)) continue;
        if (record == NULL)
            value = fields->key;
        else if (is_there(fields, columns))
            value = value_of(fields, record, text);
        (void)fputs(comma, to);
        if (value != NULL) put_csv(to, value);
        comma = ",";
    }
    (void)fputc('\n', to);
}

bool record_print(FILE *to, const char *before, const field_t *fields, const void *record, unsigned columns,
                  bool omits_zero)
{
    bool is_used = false;
    for (; fields->key != NULL; fields++) {
        char text[DECIMAL_TEXT];
        if (!is_there(fields, columns)) continue;
        const char *const value = value_of(fields, record, text);
        if (omits_zero && (value == NULL || strcmp(value, "0") == 0)) continue;
        (void)fprintf(to, "%s%s %s", is_used ? ", " : before, fields->key, value != NULL ? value : "-");
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
