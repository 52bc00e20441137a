/* SPDX-License-Identifier: MIT */
#ifndef SENSOR_OPTIONS_H
#define SENSOR_OPTIONS_H

#include <getopt.h>

#include "stations/station.h"

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
    OPTION_RECONNECT,
    OPTION_DURATION,
    SENSOR_OPTIONS
};

/* getopt_long returns 256 for each: the row counts. */
#define SENSOR_OPTION_ROWS                                                                                   \
    [OPTION_PORT] = {"port", required_argument, NULL, 256},                                                  \
    [OPTION_BAUD] = {"baud", required_argument, NULL, 256},                                                  \
    [OPTION_PARITY] = {"parity", required_argument, NULL, 256},                                              \
    [OPTION_STOP_BITS] = {"stop-bits", required_argument, NULL, 256},                                        \
    [OPTION_INTERVAL] = {"interval", required_argument, NULL, 256},                                          \
    [OPTION_TIMEOUT] = {"timeout", required_argument, NULL, 256},                                            \
    [OPTION_RETRIES] = {"retries", required_argument, NULL, 256},                                            \
    [OPTION_ECHO] = {"echo", required_argument, NULL, 256},                                                  \
    [OPTION_RECONNECT] = {"reconnect", no_argument, NULL, 256},                                              \
    [OPTION_DURATION] = {"duration", required_argument, NULL, 256}

/* A line has 32 unit loads. */
enum { MAX_STATIONS_ON_A_LINE = 32, MAX_STATIONS = 32, MAX_PORTS = 1 };

/* The lines of a GPIO chip that a sensor hangs on; -1: none. */
typedef struct {
    int32_t trigger; /* to the sensor's RX; an output */
    int32_t echo;    /* from its TX: pulses */
    int32_t in;      /* a switch, or a relay's contact */
    uint8_t bias;    /* of the inputs; fathom_gpio_bias_t */
} pin_options_t;

/* A port, and the line behind it. */
typedef struct {
    const char *path; /* of a tty; tcp:HOST[:PORT]; or of a GPIO chip, "gpiochip0" too */
    bool is_chip;
    pin_options_t pins; /* then */
    bool rs485;         /* the kernel's driver is to drive the transceiver */
    fathom_line_settings_t line; /* with which it is opened: the slowest of its sensors' */
    bool has_mixed_lines;        /* they differ in that */
    uint8_t echo;                /* fathom_line_config_t.echo */
} port_options_t;

/* What a command was asked to read. */
typedef struct {
    station_t stations[MAX_STATIONS];
    size_t station_count;
    port_options_t ports[MAX_PORTS];
    size_t port_count;
    uint32_t count; /* attempts of each sensor; 0: endless */
    uint32_t interval_us;
    uint32_t timeout_us;
    uint64_t duration_us; /* 0: endless */
    /* What reading_options.h sets, of all that take it; the rest is each sensor's. */
    reader_settings_t reading;
    uint8_t retries;
    bool reconnect;
} sensor_options_t;

/*
 * words: SENSOR[:ADDRESS[:MODE]], word_count of them. values: what options_parse has found. address and mode: what
 * further options have said of the one sensor; NULL: nothing. False after saying what is wrong.
 */
bool sensor_options(sensor_options_t *options, const char *command, char **words, int word_count,
                    const char *const *values, const char *address, const char *mode);

/* Says which of these options have no effect because nothing is asked. */
void sensor_options_tell_useless(const sensor_options_t *options, const char *address,
                                 const char *const *values);

/* Their help, a line each. */
void sensor_options_help(FILE *to);

#endif
