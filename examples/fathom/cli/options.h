/* SPDX-License-Identifier: MIT */
#ifndef OPTIONS_H
#define OPTIONS_H

#include <getopt.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "output/words.h"

/* What getopt_long returns for a long option, of which the row counts: option.val. */
enum {
    OPTION_ANY = 256, /* of several the last one counts */
    OPTION_ONCE       /* --port: a second one is wrong usage, since one of two would be dropped silently */
};

/*
 * Reads a command line. What was given to row i of the table (long options, ended by a row of zeros; --help, --port
 * and --quiet have -h, -p and -q) stands in values[i] ("" for an option without a value), else NULL; of a repeated
 * option the last one counts. Where --port was not given, it is the port of the environment. Returns
 * the index of the first argument that is no option, all of which stand last in argv then; or -1 after
 * saying what is wrong.
 */
int options_parse(const char *command, int argc, char **argv, const struct option *table,
                  const char **values);

/* The same for options that may come several times: `each` is told every one of them, in order. */
typedef void (*option_each_t)(void *ctx, int row, const char *value);
int options_parse_each(const char *command, int argc, char **argv, const struct option *table,
                       const char **values, option_each_t each, void *ctx);

/* Below the line of --port in a help. */
#define OPTIONS_PORT_HELP                                                                                    \
    "                    Also -p PATH; where none is given, that of FATHOM_PORT in the environment\n"

/* FATHOM_PORT; NULL: there is none. values[] has the same pointer then. */
const char *options_port_of_environment(void);

/* A number option; text NULL: it was not given, *number stays. False after saying what is wrong. */
bool option_number(const char *command, const char *name, const char *text, uint32_t min, uint32_t max,
                   uint32_t *number);

/* A --format that is text or json; NULL: text. False after saying what is wrong. */
bool option_json(const char *command, const char *text, bool *is_json);

/* --port of a command that takes no port behind a sensor: it has to be there. False after saying that it is not. */
bool option_port(const char *command, const char *path);

#endif
