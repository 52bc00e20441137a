/* SPDX-License-Identifier: MIT */
#ifndef SENSOR_OPTIONS_H
#define SENSOR_OPTIONS_H

#include <getopt.h>

#include "cli/options.h"
#include "reading/station.h"

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

enum { MAX_PORTS = MAX_STATIONS };

/* What a command was asked to read. */
typedef struct sensor_options {
    /* Without a MODE each is asked, also one that is alone at its port: to be set before. */
    bool asks_all;
    /* Options whose stations are being read meanwhile, and are left alone: to be set before. NULL: none, for the tool runs
     * one command at a time. */
    const struct sensor_options *beside;
    station_t *stations[MAX_STATIONS]; /* in the order of the words */
    size_t station_count;
    port_options_t ports[MAX_PORTS];
    size_t port_count;
    uint32_t count;       /* attempts of each sensor; 0: endless */
    uint64_t duration_us; /* 0: endless */
    bool reconnect;
    bool persists; /* with reconnect: also where a port is there and cannot be opened, now; to be set after */
} sensor_options_t;

/*
 * words: of place.h, word_count of them, which it cuts. values: what options_parse has found. address and mode: what
 * further options have said of the one sensor; NULL: nothing. False after saying what is wrong.
 */
bool sensor_options(sensor_options_t *options, const char *command, char **words, int word_count,
                    const char *const *values, const char *address, const char *mode);

/* Those of the above that each sensor has for itself, of these: --interval, --timeout and --retries. */
bool station_options(station_t *const *stations, size_t count, const char *command,
                     const char *const *values);

/* Says which of these options, and keys, have no effect on a sensor because nothing is asked. */
void sensor_options_tell_useless(const sensor_options_t *options, const char *address,
                                 const char *const *values);

/* Their help, a line each. */
void sensor_options_help(FILE *to);

#endif
