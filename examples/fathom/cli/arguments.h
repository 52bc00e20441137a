/* SPDX-License-Identifier: MIT */
#ifndef ARGUMENTS_H
#define ARGUMENTS_H

#include "cli/command.h"

/* Reads the options of a command from argv, the command's name in argv[0], in any order and between the words. The
 * values are stored in `settings`, the words and what was given in *arguments. False after rejecting one of them. */
bool arguments_parse(arguments_t *arguments, const command_t *command, int argc, char **argv, void *settings);

/* Was --NAME given? */
bool arguments_have(const arguments_t *arguments, const char *name);

/* The letter of an option, such as 'p' of "port"; '\0': it has none. */
char argument_letter(const char *name);

#endif
