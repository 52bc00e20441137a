/* SPDX-License-Identifier: MIT */
#ifndef COMPLETE_H
#define COMPLETE_H

#include "cli/help.h"

/* `fathom complete WORD...`: prints what can stand in place of the last word, one candidate in a line, with its help
 * behind a tabulator. The line ":files" stands for files. The words are those behind "fathom" on the command line. */
void complete(FILE *to, const command_t *const *commands, const help_topic_t *topics, char **words,
              int count);

/* Prints the completion script of a shell (bash, zsh or fish); the script runs `fathom complete`. Returns false for
 * another shell. */
bool complete_script(FILE *to, const char *shell);

/* ---- operands of commands ---- */

void operands_sensors(FILE *to, char **words, int count);       /* several */
void operands_asked(FILE *to, char **words, int count);         /* several that receive requests */
void operands_simulated(FILE *to, char **words, int count);     /* several that can be simulated */
void operands_one(FILE *to, char **words, int count);           /* one that receives requests */
void operands_resettable(FILE *to, char **words, int count);    /* one that has a reset */
void operands_setting(FILE *to, char **words, int count);       /* one, and a setting to read */
void operands_setting_value(FILE *to, char **words, int count); /* one, a setting to change, and its value */
void operands_file(FILE *to, char **words, int count);

/* The names of the models, for option_t.list. */
const char *model_name(size_t n);

#endif
