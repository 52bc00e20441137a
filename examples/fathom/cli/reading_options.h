/* SPDX-License-Identifier: MIT */
#ifndef READING_OPTIONS_H
#define READING_OPTIONS_H

#include "cli/sensor_options.h"

/* What is read of a sensor, and what its values mean: options of the commands that read on and on, the next rows of
 * their tables. */
enum {
    OPTION_PROBES = SENSOR_OPTIONS,
    OPTION_MEANS,
    OPTION_WINDOW,
    OPTION_VALUE,
    OPTION_FIRST_REGISTER,
    READING_OPTIONS
};

#define READING_OPTION_ROWS                                                                                  \
    SENSOR_OPTION_ROWS, [OPTION_PROBES] = {"probes", required_argument, NULL, 256},                          \
                        [OPTION_MEANS] = {"means", required_argument, NULL, 256},                            \
                        [OPTION_WINDOW] = {"window", required_argument, NULL, 256},                          \
                        [OPTION_VALUE] = {"value", required_argument, NULL, 256},                            \
                        [OPTION_FIRST_REGISTER] = {"first-register", required_argument, NULL, 256}

/* After sensor_options, for all of these: values as there. False after saying what is wrong. */
bool reading_options(sensor_t *const *stations, size_t count, const char *command, const char *const *values);

/* Has --NAME, one of READER_TAKES_..., an effect on any of the sensors? False after a usage error that says on which it
 * would have one. */
bool reading_option_suits(sensor_t *const *stations, size_t count, const char *command, const char *name,
                          uint8_t takes);

/* The same for --temperature[=SECONDS], which not all of these commands have. text: "" where no number was given; NULL: it
 * was not given. */
bool temperature_option(sensor_t *const *stations, size_t count, const char *command, const char *text);

/* Their help, a line each. */
void reading_options_help(FILE *to);

#endif
