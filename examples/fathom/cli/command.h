/* SPDX-License-Identifier: MIT */
#ifndef COMMAND_H
#define COMMAND_H

#include <stddef.h>
#include <stdio.h>

#include "cli/option.h"
#include "output/status.h"
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
    const char *summary;    /* a line of `fathom --help` */
    void (*help)(FILE *to); /* `fathom NAME --help` */
    /* argv[0] is the command's name; returns the exit status */
    int (*run)(const host_t *host, int argc, char **argv);

    const char *usage; /* behind the name: "SENSOR... [OPTIONS]"; further lines behind line feeds */
    const option_table_t *tables; /* its options */
    const char *common;           /* the names of those that most people need, with blanks between them */
    const char *own_group;        /* the name of GROUP_COMMAND */
    const char *about;            /* lines below the summary; NULL: none */
    const char *examples;         /* lines */
    const char *status;           /* the exit statuses, lines */
    void (*operands)(FILE *to, char **words, int count); /* prints candidates for the word behind these */
    const char *topics;                                  /* topics to read on, "sensors, ports"; NULL: none */
    size_t settings_size; /* of the structure that the options fill; it is all zeros at first */
    int (*start)(const host_t *host, const arguments_t *arguments); /* returns the exit status */
};

/* Prints its help on stdout; returns the exit status. */
int command_help(const command_t *command);

/* Hands over what was printed, so that the reader of a pipe sees each line at once. errno is to be 0 before the
 * printing. Returns 0, or errno of what has failed since then. */
int output_flush(void);

/* Says on stderr, in one line, what is wrong with the command line and where help is. command: "" before one
 * is known. Returns STATUS_USAGE. */
int usage_error(const char *command, const char *format, ...);

/* Where the words stand that are looked at: in a file, and not on the command line. What is wrong is told with the file and
 * the line then, and an option is named as the file names it, `interval:` for --interval. */
typedef struct {
    const char *file; /* NULL: the command line */
    unsigned line;    /* from 1, where neither of the next two says it better */
    const unsigned
        *lines; /* of each word, where those of several sensors are looked at together; NULL: there is one */
    /* Of an option, the first `length` bytes of this name; 0: not known. NULL: none is. */
    unsigned (*line_of)(const void *ctx, const char *option, size_t length);
    const void *ctx;
} usage_place_t;

/* From now on that is the place; NULL: the command line. */
void usage_at(const usage_place_t *place);
void usage_at_line(const char *file, unsigned line);

/* Which of several words is looked at now. On the command line there is nothing to say of that. */
void usage_of_word(size_t number);

/* The same as an origin, and the line of an option. */
origin_t usage_origin(const char *command, size_t word);
unsigned usage_line_of(const char *option);

#endif
