/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): open_memstream */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "cli/arguments.h"
#include "cli/help.h"
#include "fathom/version.h"
#include "output/words.h"

/* Prints a text so that roff takes none of it as a request. Lines end at blanks, as far as they are filled anyway. */
static void print_filled(FILE *to, const char *text, bool is_filled)
{
    enum { WIDTH = 64 };
    bool begins = true;
    int column = 0;
    for (; *text != '\0'; text++, column++) {
        if (is_filled && *text == ' ' && column > WIDTH) {
            (void)fputc('\n', to);
            column = 0;
            begins = true;
            continue;
        }
        if (begins && (*text == '.' || *text == '\'')) (void)fputs("\\&", to);
        if (*text == '-')
            (void)fputs("\\-", to);
        else if (*text == '\\')
            (void)fputs("\\e", to);
        else
            (void)fputc(*text, to);
        begins = *text == '\n';
        if (begins) column = 0;
    }
}

static void print_text(FILE *to, const char *text) { print_filled(to, text, true); }

static void print_lines(FILE *to, const char *head, const char *lines)
{
    if (lines == NULL) return;
    (void)fprintf(to, ".SH %s\n.nf\n", head);
    print_filled(to, lines, false);
    (void)fputs(".fi\n", to);
}

static void print_title(FILE *to, const char *name, const char *summary)
{
    (void)fputs(".TH FATHOM", to);
    for (const char *at = name; *at != '\0'; at++) (void)fputc(toupper((unsigned char)*at), to);
    (void)fprintf(to, " 1 \"\" \"fathom %s\" \"User Commands\"\n.SH NAME\nfathom", FATHOM_VERSION_STRING);
    print_text(to, name);
    (void)fputs(" \\- ", to);
    print_text(to, summary);
    (void)fputs("\n.SH SYNOPSIS\n", to);
}

static void print_keys(FILE *to, const option_t *keys)
{
    for (const option_t *key = keys; key != NULL && key->name != NULL; key++) {
        (void)fputs(".RS\n.TP\n.B ", to);
        print_text(to, key->name);
        (void)fprintf(to, "=%s\n", key->value);
        print_text(to, key->help);
        (void)fputs(".\n.RE\n", to);
    }
}

static void print_option(FILE *to, const option_t *row)
{
    const char letter = argument_letter(row->name);
    (void)fputs(".TP\n.B ", to);
    if (letter != '\0') (void)fprintf(to, "\\-%c, ", letter);
    (void)fputs("\\-\\-", to);
    print_text(to, row->name);
    if (row->otherwise != NULL)
        (void)fprintf(to, "[=%.*s]", (int)strlen(row->value) - 2, row->value + 1);
    else if (row->value != NULL)
        (void)fprintf(to, " %s", row->value);
    (void)fputc('\n', to);
    print_text(to, row->help);
    (void)fputs(".\n", to);
    print_keys(to, row->keys);
}

static void print_group(FILE *to, const command_t *command, option_group_t group)
{
    bool has_begun = false;
    for (option_walk_t walk = {.table = command->tables}; option_next(&walk);) {
        if (walk.row->is_hidden || help_group(command, walk.row) != group) continue;
        if (!has_begun) (void)fprintf(to, ".SS %s\n", help_heading(command, group));
        has_begun = true;
        print_option(to, walk.row);
    }
}

void man_print(FILE *to, const command_t *command)
{
    char name[32];
    (void)snprintf(name, sizeof name, "-%s", command->name);
    print_title(to, name, command->summary);
    for (const char *usage = command->usage; usage != NULL;) {
        char line[200];
        usage = next_word(usage, '\n', line, sizeof line);
        (void)fprintf(to, ".B fathom %s\n", command->name);
        print_text(to, line);
        (void)fputs(usage != NULL ? "\n.br\n" : "\n", to);
    }
    (void)fputs(".SH DESCRIPTION\n", to);
    print_text(to, command->summary);
    (void)fputs(".\n", to);
    if (command->about != NULL) print_text(to, command->about);
    (void)fputs(".SH OPTIONS\n", to);
    for (option_group_t group = GROUP_COMMON; group != GROUPS; group++) print_group(to, command, group);
    print_lines(to, "EXAMPLES", command->examples);
    print_lines(to, "EXIT STATUS", command->status);
    (void)fputs(".SH SEE ALSO\n.BR fathom (1)\n", to);
}

/* What a topic prints, as lines. */
static void print_topic(FILE *to, const help_topic_t *topic)
{
    char *text = NULL;
    size_t size = 0;
    FILE *const memory = open_memstream(&text, &size);
    if (memory == NULL) return;
    topic->print(memory);
    if (fclose(memory) == 0) {
        char head[80];
        (void)snprintf(head, sizeof head, "\"%s (fathom help %s)\"", topic->summary, topic->name);
        print_lines(to, head, text);
    }
    free(text);
}

void man_print_tool(FILE *to, const command_t *const *commands, const help_topic_t *topics,
                    const char *examples)
{
    print_title(to, "", "read and set up the range sensors A16, A05 and HPS-167S");
    (void)fputs(".B fathom\nCOMMAND [ARGUMENTS]\n.br\n.B fathom help\n[COMMAND | TOPIC]\n.SH DESCRIPTION\n"
                "Finds, reads and sets up the range sensors A16, A05 and HPS\\-167S\non serial ports, Modbus "
                "gateways and GPIO lines.\n.SH COMMANDS\n",
                to);
    for (; *commands != NULL; commands++) {
        (void)fprintf(to, ".TP\n.BR fathom\\-%s (1)\n", (*commands)->name);
        print_text(to, (*commands)->summary);
        (void)fputs(".\n", to);
    }
    for (; topics->name != NULL; topics++) print_topic(to, topics);
    print_lines(
        to, "EXIT STATUS",
        "0 success\n1 the line, the port or the output failed\n2 wrong usage\n3 an alarm is on (read)\n");
    (void)fputs(".SH FILES\n"
                ".TP\n.I /dev/ttyUSB0\nA serial port. On Debian it belongs to the group dialout.\n"
                ".TP\n.I /dev/serial/by\\-id/\n"
                "The same ports by the names of their adapters,\nwhich stay the same in another socket.\n"
                ".TP\n.I /dev/gpiochip0\nThe GPIO lines of a board.\n",
                to);
    print_lines(to, "EXAMPLES", examples);
    (void)fputs(".SH SEE ALSO\n.BR fathom\\-read (1),\n.BR fathom\\-scan (1)\n", to);
}
