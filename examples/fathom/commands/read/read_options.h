/* SPDX-License-Identifier: MIT */
#ifndef READ_OPTIONS_H
#define READ_OPTIONS_H

#include "commands/read/output.h"
#include "output/file.h"
#include "reading/results.h"

/* What `fathom read` was asked to do, besides reading. */
typedef struct {
    const format_t *format;
    output_file_t file;
    results_config_t results;
    uint32_t stats_us; /* all counters so often; 0: at the end only */
    bool stats;        /* all counters at the end */
    bool until_alarm;  /* ends when an alarm is on */
    bool quiet;        /* says only what ends it, and what `stats` has asked for */
    bool no_header;    /* of csv */
    bool wants_help;
} read_options_t;

/* False after saying what is wrong with them. */
bool read_options(read_options_t *options, sensor_options_t *sensors, int argc, char **argv);

void read_help(FILE *to);

#endif
