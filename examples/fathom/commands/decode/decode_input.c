/* SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L /* NOLINT(bugprone-reserved-identifier): getline */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command.h"
#include "commands/decode/decode.h"

#define SEPARATORS " \t\r\n\v\f,;:{}"
#define DIGITS     "0123456789abcdefABCDEF"

/* Returns false and sets errno if there is no room for another byte. */
static bool add_byte(decode_input_t *input, uint8_t byte, bool starts_line)
{
    if (input->count == DECODE_MAX_BYTES) {
        errno = EFBIG;
        return false;
    }
    if (input->count == input->capacity) {
        const size_t capacity = input->capacity != 0 ? 2 * input->capacity : 4096;
        uint8_t *const bytes = realloc(input->bytes, capacity);
        if (bytes != NULL) input->bytes = bytes;
        bool *const starts = bytes != NULL ? realloc(input->line_starts, capacity * sizeof *starts) : NULL;
        if (starts == NULL) return false;
        input->line_starts = starts;
        input->capacity = capacity;
    }
    input->bytes[input->count] = byte;
    input->line_starts[input->count++] = starts_line;
    return true;
}

static uint8_t hex(const char *digit)
{
    const char text[] = {digit[0], digit[1], '\0'};
    return (uint8_t)strtoul(text, NULL, 16);
}

/* Adds the bytes of a word of hex digits, with or without 0x. Returns NULL, or the position of an error: a character that
 * is no digit, or the start of a word with half a byte. errno is set if there is no room. */
static const char *add_word(decode_input_t *input, const char *word, size_t length, bool starts_line)
{
    const char *const end = word + length;
    const char *const first =
        length > 2 && word[0] == '0' && (word[1] == 'x' || word[1] == 'X') ? word + 2 : word;
    const char *const last = first + strspn(first, DIGITS);
    if (last != end) return last;
    if ((end - first) % 2 != 0) return word;
    for (const char *digit = first; digit != end; digit += 2)
        if (!add_byte(input, hex(digit), starts_line && digit == first)) return word;
    return NULL;
}

/* Adds the bytes of a line; a comment goes from # to its end. Returns as add_word(). */
static const char *add_line(decode_input_t *input, const char *line, bool starts_line)
{
    for (const char *at = line + strspn(line, SEPARATORS); *at != '\0' && *at != '#';
         at += strspn(at, SEPARATORS)) {
        const size_t length = strcspn(at, SEPARATORS "#");
        const char *const wrong = add_word(input, at, length, starts_line);
        if (wrong != NULL) return wrong;
        starts_line = false;
        at += length;
    }
    return NULL;
}

/* Reports the error that add_line() found at `wrong`, in a place such as "capture.txt: line 2". Returns the exit status. */
static int reject_line(const origin_t *origin, const char *place, const char *line, const char *wrong,
                       const char *hint)
{
    const unsigned column = (unsigned)(wrong - line) + 1;
    if (errno == EFBIG)
        (void)fprintf(stderr, "fathom: %s: there are more than the %d bytes that are decoded at a time.\n",
                      place, DECODE_MAX_BYTES);
    else if (errno != 0)
        (void)fprintf(stderr, "fathom: %s: there is not enough memory.\n", place);
    else if (strspn(wrong, DIGITS) != 0)
        (void)reject(origin, "%s, character %u: a byte has two hex digits%s.", place, column, hint);
    else
        (void)reject(origin, "%s, character %u: '%c' is no hex digit%s.", place, column,
                     *wrong > ' ' && *wrong < '\x7f' ? *wrong : '?', hint);
    return errno != 0 ? STATUS_FAILED : STATUS_USAGE;
}

/* An argument of this many characters is a frame rather than a byte of one. */
enum { WHOLE_FRAME = 8, PLACE_TEXT = 256 };

static int read_arguments(decode_input_t *input, const origin_t *origin, int count, char **arguments,
                          const char *hint)
{
    for (int i = 0; i != count; i++) {
        char place[PLACE_TEXT];
        errno = 0;
        const char *const wrong = add_line(input, arguments[i], strlen(arguments[i]) >= WHOLE_FRAME);
        (void)snprintf(place, sizeof place, "argument %d", i + 1);
        if (wrong != NULL) return reject_line(origin, place, arguments[i], wrong, hint);
    }
    return STATUS_OK;
}

static int read_text(decode_input_t *input, const origin_t *origin, const char *name, FILE *file)
{
    char *line = NULL;
    size_t size = 0;
    ssize_t length = 0;
    int status = STATUS_OK;
    for (unsigned number = 1; status == STATUS_OK && (length = getline(&line, &size, file)) >= 0; number++) {
        char place[PLACE_TEXT];
        errno = 0;
        const char *wrong = add_line(input, line, true);
        if (wrong == NULL && strlen(line) != (size_t)length) wrong = line + strlen(line); /* a 00 */
        (void)snprintf(place, sizeof place, "%.200s: line %u", name, number);
        if (wrong != NULL)
            status =
                reject_line(origin, place, line, wrong, ". For a file of bytes instead of hex, add --raw");
    }
    free(line);
    return status;
}

static int read_bytes(decode_input_t *input, const origin_t *origin, const char *name, FILE *file)
{
    errno = 0;
    for (int byte = getc(file); byte != EOF; byte = getc(file))
        if (!add_byte(input, (uint8_t)byte, false)) return reject_line(origin, name, "", "", "");
    return STATUS_OK;
}

static int read_file(decode_input_t *input, const origin_t *origin, const char *name, FILE *file, bool is_raw)
{
    const int status = is_raw ? read_bytes(input, origin, name, file) : read_text(input, origin, name, file);
    if (ferror(file) == 0) return status;
    (void)fprintf(stderr, "fathom: %s: %s\n", name, strerror(errno));
    return STATUS_FAILED;
}

int decode_input_read(decode_input_t *input, const origin_t *origin, int count, char **arguments, bool is_raw)
{
    memset(input, 0, sizeof *input);
    if (count == 0 || (count == 1 && strcmp(arguments[0], "-") == 0))
        return read_file(input, origin, "the standard input", stdin, is_raw);
    const bool is_name = count == 1 && arguments[0][strspn(arguments[0], DIGITS "xX" SEPARATORS)] != '\0';
    if (count == 1 && (is_raw || is_name)) {
        FILE *const file = fopen(arguments[0], "rbe");
        if (file != NULL) {
            const int status = read_file(input, origin, arguments[0], file, is_raw);
            (void)fclose(file);
            return status;
        }
        if (is_raw || errno != ENOENT) {
            (void)fprintf(stderr, "fathom: %s: %s\n", arguments[0], strerror(errno));
            return STATUS_FAILED;
        }
    }
    if (!is_raw)
        return read_arguments(input, origin, count, arguments,
                              is_name ? ", and there is no file of that name" : "");
    (void)reject(origin, "--raw takes one file.");
    return STATUS_USAGE;
}

void decode_input_free(decode_input_t *input)
{
    free(input->bytes);
    free(input->line_starts);
    memset(input, 0, sizeof *input);
}
