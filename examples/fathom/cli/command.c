/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): ftruncate */
#include "cli/command.h"

#include <errno.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio_ext.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static usage_place_t place;

void usage_at(const usage_place_t *new_place)
{
    static const usage_place_t command_line = {.file = NULL};
    place = new_place != NULL ? *new_place : command_line;
}

void usage_at_line(const char *file, unsigned line)
{
    const usage_place_t this_line = {.file = file, .line = line};
    usage_at(&this_line);
}

void usage_of_word(size_t number)
{
    if (place.lines != NULL) place.line = place.lines[number];
}

static size_t option_length(const char *text)
{
    const bool is_option = text[0] == '-' && text[1] == '-' && text[2] >= 'a' && text[2] <= 'z';
    return is_option ? strspn(text + 2, "abcdefghijklmnopqrstuvwxyz0123456789-") : 0;
}

/* As a file has it: "median:" for "--median", also where that is followed by a colon. */
static void print_in_file(const char *text)
{
    while (*text != '\0') {
        const size_t length = option_length(text);
        if (length == 0) {
            (void)fputc(*text++, stderr);
            continue;
        }
        (void)fprintf(stderr, "%.*s:", (int)length, text + 2);
        text += 2 + length;
        if (*text == ':') text++;
    }
}

/* Of what the text begins with. */
static unsigned line_of(const char *text)
{
    const size_t length = option_length(text);
    const unsigned line =
        length != 0 && place.line_of != NULL ? place.line_of(place.ctx, text + 2, length) : 0;
    return line != 0 ? line : place.line;
}

origin_t usage_origin(const char *command, size_t word)
{
    return (origin_t){
        .command = command, .file = place.file, .line = place.lines != NULL ? place.lines[word] : place.line};
}

unsigned usage_line_of(const char *option)
{
    const unsigned line = place.line_of != NULL ? place.line_of(place.ctx, option, strlen(option)) : 0;
    return line != 0 ? line : place.line;
}

int usage_error(const char *command, const char *format, ...)
{
    enum { TEXT = 1024 };
    char text[TEXT];
    const char *const gap = command[0] != '\0' ? " " : "";
    va_list arguments;
    (void)fprintf(stderr, "fathom%s%s: ", gap, command);
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (place.file != NULL) {
        (void)fprintf(stderr, "%s:%u: ", place.file, line_of(text));
        print_in_file(text);
        (void)fputs("\n", stderr);
    } else {
        (void)fprintf(stderr, "%s; try: fathom%s%s --help\n", text, gap, command);
    }
    return STATUS_USAGE;
}

int command_help(const command_t *command)
{
    command->help(stdout);
    return fflush(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
}

/* Of a file: where it ends. */
static off_t end_of_output(void)
{
    struct stat is;
    return fstat(STDOUT_FILENO, &is) == 0 && S_ISREG(is.st_mode) ? is.st_size : -1;
}

/* A disk that is full takes a part of a row. It is taken back, unless another program has added to the file since. */
static void take_back(off_t before, size_t length)
{
    const off_t now = end_of_output();
    __fpurge(stdout); /* the other part */
    if (before >= 0 && now > before && now - before < (off_t)length && ftruncate(STDOUT_FILENO, before) != 0)
        return;
}

int output_flush(void)
{
    const size_t length = __fpending(stdout);
    const off_t before = end_of_output();
    if (fflush(stdout) == 0 && ferror(stdout) == 0) return 0;
    const int error = errno != 0 ? errno : EIO;
    take_back(before, length);
    return error;
}
