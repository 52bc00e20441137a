/* SPDX-License-Identifier: MIT */
#include "cli/help.h"

#include <string.h>

#include "cli/arguments.h"
#include "output/words.h"

enum { COLUMN = 24, WIDTH = 80 };

static const char *const headings[GROUPS] = {
    [GROUP_COMMON] = "Common options", [GROUP_COMMAND] = "Options",
    [GROUP_SENSOR] = "Sensor",         [GROUP_LINE] = "Line",
    [GROUP_OUTPUT] = "Output",         [GROUP_PROCESSING] = "Processing",
};

const char *help_heading(const command_t *command, option_group_t group)
{
    return group == GROUP_COMMAND && command->own_group != NULL ? command->own_group : headings[group];
}

option_group_t help_group(const command_t *command, const option_t *row)
{
    uint32_t n = 0;
    return command->common != NULL && word_find(command->common, row->name, &n) ? GROUP_COMMON : row->group;
}

void help_print_wrapped(FILE *to, const char *text, int indent, int column)
{
    const char *gap = "";
    while (*text != '\0') {
        const int length = (int)strcspn(text, " ");
        if (gap[0] != '\0' && column + 1 + length > WIDTH) {
            column = fprintf(to, "\n%*s", indent, "") - 1;
            gap = "";
        }
        column += fprintf(to, "%s%.*s", gap, length, text);
        text += length;
        text += strspn(text, " ");
        gap = " ";
    }
    (void)fputc('\n', to);
}

static void print_row(FILE *to, const option_t *row)
{
    const char letter = argument_letter(row->name);
    int column =
        letter != '\0' ? fprintf(to, "  -%c, --%s", letter, row->name) : fprintf(to, "      --%s", row->name);
    if (row->otherwise != NULL)
        column += fprintf(to, "[=%.*s]", (int)strlen(row->value) - 2, row->value + 1);
    else if (row->value != NULL)
        column += fprintf(to, " %s", row->value);
    column += fprintf(to, "%*s", column < COLUMN - 1 ? COLUMN - column : 2, "");
    help_print_wrapped(to, row->help, COLUMN, column);
}

/* Prints the options that a command names as the most common, in that order. */
static void print_common(FILE *to, const command_t *command)
{
    (void)fprintf(to, "\n%s:\n", headings[GROUP_COMMON]);
    for (const char *names = command->common; names != NULL;) {
        char name[32];
        option_walk_t walk;
        names = next_word(names, ' ', name, sizeof name);
        if (option_find(&walk, command->tables, name, strlen(name))) print_row(to, walk.row);
    }
}

static void print_group(FILE *to, const command_t *command, option_group_t group)
{
    bool has_begun = false;
    for (option_walk_t walk = {.table = command->tables}; option_next(&walk);) {
        if (walk.row->is_hidden || help_group(command, walk.row) != group) continue;
        if (!has_begun) (void)fprintf(to, "\n%s:\n", help_heading(command, group));
        has_begun = true;
        print_row(to, walk.row);
    }
}

void help_print(FILE *to, const command_t *command)
{
    const char *usage = command->usage;
    const char *before = "Usage: ";
    while (usage != NULL) {
        char line[200];
        usage = next_word(usage, '\n', line, sizeof line);
        (void)fprintf(to, "%sfathom %s %s\n", before, command->name, line);
        before = "       ";
    }
    (void)fprintf(to, "\n%s.\n", command->summary);
    if (command->about != NULL) (void)fputs(command->about, to);
    if (command->common != NULL) print_common(to, command);
    for (option_group_t group = GROUP_COMMAND; group != GROUPS; group++) print_group(to, command, group);
    if (command->examples != NULL) (void)fprintf(to, "\nExamples:\n%s", command->examples);
    if (command->status != NULL) (void)fprintf(to, "\n%s", command->status);
    if (command->topics != NULL) (void)fprintf(to, "More: fathom help %s.\n", command->topics);
}

void help_print_keys(FILE *to, const option_t *keys, int indent)
{
    for (const option_t *key = keys; key->name != NULL; key++) {
        int column = fprintf(to, "%*s%s=%s", indent, "", key->name, key->value);
        column += fprintf(to, "%*s", column < 23 ? 24 - column : 2, "");
        help_print_wrapped(to, key->help, 24, column);
    }
}
