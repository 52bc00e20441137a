/* SPDX-License-Identifier: MIT */
#ifndef RESULT_OPTIONS_H
#define RESULT_OPTIONS_H

#include "cli/reading_options.h"
#include "reading/site.h"

/* What is made of the readings: options of the commands that tell results, the next rows of their tables. */
enum { OPTION_MEDIAN = READING_OPTIONS, OPTION_GATE, OPTION_LEVEL, OPTION_ALARM, RESULT_OPTIONS };

#define RESULT_OPTION_ROWS                                                                                   \
    READING_OPTION_ROWS, [OPTION_MEDIAN] = {"median", required_argument, NULL, 256},                         \
                         [OPTION_GATE] = {"gate", required_argument, NULL, 256},                             \
                         [OPTION_LEVEL] = {"level", required_argument, NULL, 256},                           \
                         [OPTION_ALARM] = {"alarm", required_argument, NULL, 256}

/* For sensors with this interval: values as of sensor_options; *config is all zeros. False after saying what is wrong. */
bool result_options(results_config_t *config, uint32_t interval_us, const char *command,
                    const char *const *values);

/* Their help, a line each. */
void result_options_help(FILE *to);

#endif
