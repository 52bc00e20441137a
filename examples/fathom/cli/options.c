/* SPDX-License-Identifier: MIT */
#include "cli/options.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command.h"

int options_parse(const char *command, int argc, char **argv, const struct option *table, const char **values)
{
    return options_parse_each(command, argc, argv, table, values, NULL, NULL);
}

/* The long options that have a short one, in every command that has them. */
static const struct {
    const char *name;
    char letter;
} letters[] = {{"help", 'h'}, {"port", 'p'}, {"quiet", 'q'}};
enum { LETTERS = sizeof letters / sizeof letters[0] };

static char letter_of(const char *name)
{
    for (size_t i = 0; i != LETTERS; i++)
        if (strcmp(letters[i].name, name) == 0) return letters[i].letter;
    return '\0';
}

/* As getopt_long wants them. */
static const char *short_options(const struct option *table, char text[2 * LETTERS + 2])
{
    size_t length = 0;
    text[length++] = ':';
    for (; table->name != NULL; table++) {
        const char letter = letter_of(table->name);
        if (letter == '\0') continue;
        text[length++] = letter;
        if (table->has_arg != no_argument) text[length++] = ':';
    }
    text[length] = '\0';
    return text;
}

/* The row of a short option; one that the table has. */
static int row_of(const struct option *table, int letter)
{
    int row = 0;
    while (letter_of(table[row].name) != letter) row++;
    return row;
}

const char *options_port_of_environment(void)
{
    const char *const port = getenv("FATHOM_PORT"); /* NOLINT(concurrency-mt-unsafe): one thread */
    return port != NULL && port[0] != '\0' ? port : NULL;
}

static void take_environment(const struct option *table, const char **values)
{
    for (size_t row = 0; table[row].name != NULL; row++)
        if (strcmp(table[row].name, "port") == 0 && values[row] == NULL)
            values[row] = options_port_of_environment();
}

int options_parse_each(const char *command, int argc, char **argv, const struct option *table,
                       const char **values, option_each_t each, void *ctx)
{
    char letters_text[2 * LETTERS + 2];
    const char *const short_ones = short_options(table, letters_text);
    opterr = 0;
    optind = 0; /* from the beginning, whatever was read before */
    for (;;) {
        int row = -1;
        const int found = getopt_long(argc, argv, short_ones, table, &row);
        if (found == -1) break;
        if (found == ':') {
            (void)usage_error(command, "%s needs a value", argv[optind - 1]);
            return -1;
        }
        if (found == '?') {
            /* A short option may stand in the middle of a word. */
            if (optopt > 0 && optopt < 256)
                (void)usage_error(command, "there is no option -%c", optopt);
            else
                (void)usage_error(command, "there is no option %s", argv[optind - 1]);
            return -1;
        }
        if (row < 0) row = row_of(table, found);
        if (table[row].val == OPTION_ONCE && values[row] != NULL) {
            (void)usage_error(command,
                              "--%s stands twice, and takes one; a sensor's own stands behind it, such as "
                              "a16@/dev/ttyUSB0",
                              table[row].name);
            return -1;
        }
        values[row] = optarg != NULL ? optarg : "";
        if (each != NULL) each(ctx, row, values[row]);
    }
    take_environment(table, values);
    return optind;
}

bool option_number(const char *command, const char *name, const char *text, uint32_t min, uint32_t max,
                   uint32_t *number)
{
    if (text == NULL || number_parse(text, min, max, number)) return true;
    (void)usage_error(command, "--%s takes a whole number from %" PRIu32 " to %" PRIu32 ", not '%s'", name,
                      min, max, text);
    return false;
}

bool option_json(const char *command, const char *text, bool *is_json)
{
    *is_json = text != NULL && strcmp(text, "json") == 0;
    if (text == NULL || *is_json || strcmp(text, "text") == 0) return true;
    (void)usage_error(command, "there is no format '%s', only text, json", text);
    return false;
}

bool option_port(const char *command, const char *path)
{
    if (path != NULL) return true;
    (void)usage_error(command, "--port is missing, such as --port /dev/ttyUSB0");
    return false;
}
