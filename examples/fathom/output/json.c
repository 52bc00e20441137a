/* SPDX-License-Identifier: MIT */
#include "output/json.h"

#include <stdarg.h>

static bool is_plain(unsigned char c) { return c >= 0x20 && c != '"' && c != '\\'; }

/* Writes plain characters as a whole: a stream takes a lock in each call. */
static void put_string(FILE *to, const char *text)
{
    (void)fputc('"', to);
    while (*text != '\0') {
        size_t length = 0;
        while (is_plain((unsigned char)text[length])) length++;
        (void)fwrite(text, 1, length, to);
        text += length;
        if (*text == '\0') break;
        (void)fprintf(to, (unsigned char)*text < 0x20 ? "\\u%04x" : "\\%c", *text);
        text++;
    }
    (void)fputc('"', to);
}

static void put_key(json_t *json, const char *key)
{
    if (json->has_member) (void)fputc(',', json->to);
    json->has_member = true;
    if (key == NULL) return;
    put_string(json->to, key);
    (void)fputc(':', json->to);
}

void json_begin(json_t *json, const char *key, char bracket)
{
    put_key(json, key);
    (void)fputc(bracket, json->to);
    json->has_member = false;
}

void json_end(json_t *json, char bracket)
{
    (void)fputc(bracket, json->to);
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

void json_number(json_t *json, const char *key, const char *digits)
{
    put_key(json, key);
    (void)fputs(digits, json->to);
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
    (void)fputc('"', json->to);
    for (size_t i = 0; i != count; i++) (void)fprintf(json->to, "%s%02X", i != 0 ? " " : "", bytes[i]);
    (void)fputc('"', json->to);
}
