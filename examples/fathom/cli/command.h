/* SPDX-License-Identifier: MIT */
#ifndef COMMAND_H
#define COMMAND_H

#include <stdio.h>

#include "cli/option.h"
#include "output/words.h"
#include "ports/host.h"

/* The words between the options of a command, which completion offers. */
typedef enum {
    OPERANDS_NONE,
    OPERANDS_FILE,
    OPERANDS_SENSORS,      /* several sensors */
    OPERANDS_ASKED,        /* several, in modes that send requests */
    OPERANDS_SIMULATED,    /* several, in modes that can be simulated */
    OPERANDS_ONE,          /* one, in a mode that sends requests */
    OPERANDS_RESETTABLE,   /* one that has a reset */
    OPERANDS_SETTING,      /* one, and a setting to read */
    OPERANDS_SETTING_VALUE /* one, a setting to change, and its value */
} operands_t;

/* What a command was given. */
typedef struct command command_t;
typedef struct {
    const command_t *command;
    origin_t origin;      /* of the command line */
    option_given_t given; /* which options */
    void *settings;       /* their values */
    char **words;         /* the words between the options, */
    int count;            /* and how many there are */
    bool wants_help;
} arguments_t;

/* A command of the tool: a row in the table of commands.c. Lines of its texts may be longer than 80 columns. */
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
    operands_t operands;
    const char *topics;   /* topics to read on, "sensors, ports"; NULL: none */
    size_t settings_size; /* of the structure that the options fill; it is all zeros at first */
    int (*start)(const host_t *host, const arguments_t *arguments); /* returns the exit status */
};

/* A subject of several commands, or what is too long for the help of one. */
typedef struct {
    const char *name;
    const char *summary; /* a line of `fathom help` */
    const char *text;    /* lines, which may be longer than 80 columns */
} help_topic_t;

/* Reads the options of a command from argv, the command's name in argv[0], in any order and between the words. The
 * values are stored in `settings`, the words and what was given in *arguments. False after rejecting one of them. */
bool arguments_parse(arguments_t *arguments, const command_t *command, int argc, char **argv, void *settings);

/* Was --NAME given? */
bool arguments_have(const arguments_t *arguments, const char *name);

/* Hands over what was printed, so that the reader of a pipe sees each line at once. errno is to be 0 before the
 * printing. Returns 0, or errno of what has failed since then. */
int output_flush(void);

/* `fathom COMMAND --help` and `fathom help TOPIC`, in lines of at most 80 columns. */
void help_print(FILE *to, const command_t *command);
void help_print_topic(FILE *to, const help_topic_t *topic);

/* Prints the keys of an option, a line each. */
void help_print_keys(FILE *to, const option_t *keys);

/* The same as pages of man: of a command, and of the tool with all topics. Tables end with NULL and a row without a
 * name. */
void man_print(FILE *to, const command_t *command);
void man_print_tool(FILE *to, const command_t *const *commands, const help_topic_t *topics,
                    const char *examples);

/* `fathom complete WORD...`: prints what can stand in place of the last word, one candidate in a line, with its help
 * behind a tabulator. The line ":files" stands for files. The words are those behind "fathom" on the command line. */
void complete(FILE *to, const command_t *const *commands, const help_topic_t *topics, char **words,
              int count);

/* The names of the models, for option_t.list. */
const char *model_name(size_t n);

#endif
