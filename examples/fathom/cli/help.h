/* SPDX-License-Identifier: MIT */
#ifndef HELP_H
#define HELP_H

#include "cli/command.h"

/* A subject of several commands, or what is too long for the help of one. */
typedef struct {
    const char *name;
    const char *summary; /* a line of `fathom help` */
    void (*print)(FILE *to);
} help_topic_t;

/* `fathom COMMAND --help` */
void help_print(FILE *to, const command_t *command);

/* The same as a page of man, and the page of the tool, with all topics. Tables end with NULL and a row without a name. */
void man_print(FILE *to, const command_t *command);
void man_print_tool(FILE *to, const command_t *const *commands, const help_topic_t *topics,
                    const char *examples);

/* Prints a text in lines of 80 columns, all but the first indented; `column` is where it begins. */
void help_print_wrapped(FILE *to, const char *text, int indent, int column);

/* Prints the keys of an option, or of a map of a file, a line each. */
void help_print_keys(FILE *to, const option_t *keys, int indent);

/* The heading of a group of options. */
const char *help_heading(const command_t *command, option_group_t group);
option_group_t help_group(const command_t *command, const option_t *row);

#endif
