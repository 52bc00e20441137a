/* SPDX-License-Identifier: MIT */
#ifndef SENSOR_OPTIONS_H
#define SENSOR_OPTIONS_H

#include <getopt.h>

#include "cli/options.h"
#include "cli/rows.h"
#include "reading/site.h"

/* The options of every command that reads sensors: the first rows of its table. */
enum {
    OPTION_PORT,
    OPTION_BAUD,
    OPTION_PARITY,
    OPTION_STOP_BITS,
    OPTION_INTERVAL,
    OPTION_TIMEOUT,
    OPTION_RETRIES,
    OPTION_ECHO,
    OPTION_RS485,
    OPTION_RECONNECT,
    OPTION_DURATION,
    SENSOR_OPTIONS
};

/* getopt_long returns 256 for each: the row counts. */
#define SENSOR_OPTION_ROWS                                                                                   \
    [OPTION_PORT] = {"port", required_argument, NULL, OPTION_ONCE},                                          \
    [OPTION_BAUD] = {"baud", required_argument, NULL, 256},                                                  \
    [OPTION_PARITY] = {"parity", required_argument, NULL, 256},                                              \
    [OPTION_STOP_BITS] = {"stop-bits", required_argument, NULL, 256},                                        \
    [OPTION_INTERVAL] = {"interval", required_argument, NULL, 256},                                          \
    [OPTION_TIMEOUT] = {"timeout", required_argument, NULL, 256},                                            \
    [OPTION_RETRIES] = {"retries", required_argument, NULL, 256},                                            \
    [OPTION_ECHO] = {"echo", required_argument, NULL, 256},                                                  \
    [OPTION_RS485] = {"rs485", no_argument, NULL, 256},                                                      \
    [OPTION_RECONNECT] = {"reconnect", no_argument, NULL, 256},                                              \
    [OPTION_DURATION] = {"duration", required_argument, NULL, 256}

/*
 * words: of sensor_word.h, word_count of them, which it cuts. values: what options_parse has found. address and mode: what
 * further options have said of the one sensor; NULL: nothing. False after saying what is wrong.
 */
bool sensor_options(site_t *site, const char *command, char **words, int word_count,
                    const char *const *values, const char *address, const char *mode);

/* Those of the above that each sensor has for itself, of these: --interval, --timeout and --retries. */
bool station_options(sensor_t *const *stations, size_t count, const char *command, const char *const *values);

/* Says which of these options, and keys, have no effect on a sensor because nothing is asked. */
void sensor_options_tell_useless(const site_t *site, const char *address, const char *const *values);

/* Stores what `values` has for the options of these rows, found by their names. */
bool values_store(const option_t *rows, const char *const *values, void *structure, const char *command);

/* Their help, a line each, and that of the options of ports alone. */
void port_options_help(FILE *to);
void sensor_options_help(FILE *to);

#endif
