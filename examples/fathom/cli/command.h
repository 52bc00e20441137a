/* SPDX-License-Identifier: MIT */
#ifndef COMMAND_H
#define COMMAND_H

#include <stddef.h>
#include <stdio.h>

#include "cli/option.h"
#include "output/words.h"
#include "ports/host.h"

/* What a command was given. */
typedef struct command command_t;
typedef struct {
    const command_t *command;
    option_given_t given; /* which options */
    void *settings;       /* their values */
    char **words;         /* the words between the options, */
    int count;            /* and how many there are */
    bool wants_help;
} arguments_t;

/* A command of the tool: a row in the table of commands.c. */
struct command {
    const char *name;
    const char *summary; /* a sentence without its full stop */
    const char *usage;   /* behind the name: "SENSOR... [OPTIONS]"; further lines behind line feeds */
    const option_table_t *tables; /* its options */
    const char *common;           /* the names of those that most people need, with blanks between them */
    const char *own_group;        /* the heading of its own options; NULL: "Options" */
    const char *about;            /* lines below the summary; NULL: none */
    const char *examples;         /* lines */
    const char *status;           /* the exit statuses, lines */
    void (*operands)(FILE *to, char **words, int count); /* prints candidates for the word behind these */
    const char *topics;                                  /* topics to read on, "sensors, ports"; NULL: none */
    size_t settings_size; /* of the structure that the options fill; it is all zeros at first */
    int (*start)(const host_t *host, const arguments_t *arguments); /* returns the exit status */
};

/* Hands over what was printed, so that the reader of a pipe sees each line at once. errno is to be 0 before the
 * printing. Returns 0, or errno of what has failed since then. */
int output_flush(void);

#endif
