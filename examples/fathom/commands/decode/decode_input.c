/* SPDX-License-Identifier: MIT */
#include "commands/decode/decode_input.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "output/status.h"

static const char separators[] = " \t\r\n\v\f,;:{}";

static int hex_digit(char c)
{
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

static bool is_separator(char c) { return c != '\0' && strchr(separators, c) != NULL; }

static bool reserve(decode_input_t *input, size_t bytes)
{
    if (input->bytes != NULL) return true;
    input->bytes = malloc(bytes + 1);
    input->line_starts = calloc(bytes + 1, sizeof *input->line_starts);
    if (input->bytes != NULL && input->line_starts != NULL) return true;
    (void)fprintf(stderr, "fathom: there is no memory for %zu bytes\n", bytes);
    return false;
}

/* What is wrong with a text, and where. */
typedef struct {
    const char *what;
    size_t line; /* both from 1 */
    size_t column;
    char found; /* 0: not about one character */
} complaint_t;

/* A word of hex digits: whole bytes, with or without 0x. Returns what follows it; NULL: not hex. */
static const char *take_word(decode_input_t *input, const char *at, const char *end, complaint_t *complaint)
{
    const char *const begin = at;
    if (end - at > 2 && at[0] == '0' && (at[1] == 'x' || at[1] == 'X')) at += 2;
    const char *const digits = at;
    while (at != end && hex_digit(*at) >= 0) at++;
    if (at != end && !is_separator(*at) && *at != '#') {
        complaint->what = "is no hex digit";
        complaint->found = *at;
        complaint->column += (size_t)(at - begin);
        return NULL;
    }
    if ((at - digits) % 2 != 0) {
        complaint->what = "a byte has two hex digits";
        return NULL;
    }
    for (const char *digit = digits; digit != at; digit += 2)
        input->bytes[input->count++] = (uint8_t)(hex_digit(digit[0]) * 16 + hex_digit(digit[1]));
    return at;
}

/* There is room for length / 2 bytes more. A comment goes from # to the end of its line. */
static bool take_text(decode_input_t *input, const char *text, size_t length, bool starts_line,
                      complaint_t *complaint)
{
    const char *const end = text + length;
    const char *line = text;
    bool fresh = starts_line;
    complaint->line = 1;
    while (text != end) {
        if (*text == '#') {
            while (text != end && *text != '\n') text++;
            continue;
        }
        if (is_separator(*text)) {
            if (*text == '\n') {
                complaint->line++;
                line = text + 1;
                fresh = true;
            }
            text++;
            continue;
        }
        const size_t first = input->count;
        complaint->column = (size_t)(text - line) + 1;
        text = take_word(input, text, end, complaint);
        if (text == NULL) return false;
        if (fresh && input->count != first) input->line_starts[first] = true;
        fresh = false;
    }
    return true;
}

/* "'G' (line 2, character 7) is no hex digit" */
static void describe(const complaint_t *complaint, const char *place, char *text, size_t capacity)
{
    const char shown = complaint->found > ' ' && complaint->found < '\x7f' ? complaint->found : '?';
    if (complaint->found != 0)
        (void)snprintf(text, capacity, "'%c' (%s, character %zu) %s", shown, place, complaint->column,
                       complaint->what);
    else
        (void)snprintf(text, capacity, "%s (%s, character %zu)", complaint->what, place, complaint->column);
}

/* An argument of so many characters is a frame rather than a byte of one, and begins as a line does. */
enum { WHOLE_FRAME = 8 };

enum { PLACE_TEXT = 40, COMPLAINT_TEXT = 120 };

static int take_arguments(decode_input_t *input, const origin_t *origin, int count, char **arguments,
                          const char *besides)
{
    size_t most = 0;
    for (int i = 0; i != count; i++) most += strlen(arguments[i]) / 2;
    if (!reserve(input, most)) return STATUS_FAILED;
    for (int i = 0; i != count; i++) {
        complaint_t complaint = {NULL, 0, 0, 0};
        char place[PLACE_TEXT];
        char text[COMPLAINT_TEXT];
        const size_t length = strlen(arguments[i]);
        if (take_text(input, arguments[i], length, length >= WHOLE_FRAME, &complaint)) continue;
        (void)snprintf(place, sizeof place, "argument %d", i + 1);
        describe(&complaint, place, text, sizeof text);
        (void)reject(origin, "%s%s.", text, besides);
        return STATUS_USAGE;
    }
    return STATUS_OK;
}

/* All of a file. NULL after saying why not. */
static char *read_all(const char *name, FILE *file, size_t *length)
{
    size_t capacity = 0;
    char *text = NULL;
    *length = 0;
    for (;;) {
        if (*length == capacity) {
            capacity = capacity != 0 ? 2 * capacity : 4096;
            char *const more = realloc(text, capacity);
            if (more == NULL || capacity > (size_t)8 * DECODE_MAX_BYTES) {
                (void)fprintf(stderr, "fathom: %s is more than can be explained at a time\n", name);
                free(more != NULL ? more : text);
                return NULL;
            }
            text = more;
        }
        const size_t got = fread(text + *length, 1, capacity - *length, file);
        *length += got;
        if (got == 0) break;
    }
    if (ferror(file) == 0) return text;
    (void)fprintf(stderr, "fathom: %s: %s\n", name, strerror(errno));
    free(text);
    return NULL;
}

static int take_file(decode_input_t *input, const origin_t *origin, const char *name, FILE *file, bool raw)
{
    size_t length = 0;
    complaint_t complaint = {NULL, 0, 0, 0};
    char *const text = read_all(name, file, &length);
    if (text == NULL) return STATUS_FAILED;
    int status = STATUS_OK;
    if (!reserve(input, length)) {
        status = STATUS_FAILED;
    } else if (raw) {
        memcpy(input->bytes, text, length);
        input->count = length;
    } else if (!take_text(input, text, length, true, &complaint)) {
        char place[PLACE_TEXT];
        char what[COMPLAINT_TEXT];
        (void)snprintf(place, sizeof place, "line %zu", complaint.line);
        describe(&complaint, place, what, sizeof what);
        (void)reject(origin, "%s: %s. For a file of bytes instead of hex, add --raw.", name, what);
        status = STATUS_USAGE;
    }
    if (status == STATUS_OK && input->count > DECODE_MAX_BYTES) {
        (void)fprintf(stderr, "fathom: %s is more than the %d bytes that are explained at a time\n", name,
                      DECODE_MAX_BYTES);
        status = STATUS_FAILED;
    }
    free(text);
    return status;
}

static bool is_hex(const char *text)
{
    for (; *text != '\0'; text++)
        if (hex_digit(*text) < 0 && !is_separator(*text) && *text != 'x' && *text != 'X') return false;
    return true;
}

int decode_input_take(decode_input_t *input, const origin_t *origin, int count, char **arguments, bool raw)
{
    memset(input, 0, sizeof *input);
    if (count == 0 || (count == 1 && strcmp(arguments[0], "-") == 0))
        return take_file(input, origin, "the standard input", stdin, raw);
    if (count == 1 && (raw || !is_hex(arguments[0]))) {
        FILE *const file = fopen(arguments[0], "rbe");
        if (file != NULL) {
            const int status = take_file(input, origin, arguments[0], file, raw);
            (void)fclose(file);
            return status;
        }
        if (raw || errno != ENOENT) {
            (void)fprintf(stderr, "fathom: %s: %s\n", arguments[0], strerror(errno));
            return STATUS_FAILED;
        }
    }
    if (raw) {
        (void)reject(origin, "--raw takes one file.");
        return STATUS_USAGE;
    }
    const bool was_file = count == 1 && !is_hex(arguments[0]);
    return take_arguments(input, origin, count, arguments,
                          was_file ? ", and there is no file of that name" : "");
}

void decode_input_free(decode_input_t *input)
{
    free(input->bytes);
    free(input->line_starts);
    memset(input, 0, sizeof *input);
}
