/* SPDX-License-Identifier: MIT */
#ifndef READ_OPTIONS_H
#define READ_OPTIONS_H

#include "output.h"

/* What `fathom read` was asked to do. */
typedef struct {
    const sensor_t *sensor;
    const sensor_mode_t *mode;
    const format_t *format;
    const char *port;
    fathom_line_settings_t line;
    reader_settings_t reader;
    uint32_t count; /* attempts; 0: endless */
    uint32_t interval_us;
    uint32_t stats_us; /* all counters so often; 0: at the end only */
    uint8_t echo;      /* fathom_line_config_t.echo */
    bool stats;        /* all counters at the end */
    bool reconnect;
    bool wants_help;
} read_options_t;

/* False after saying what is wrong with them. */
bool read_options(read_options_t *options, int argc, char **argv);

void read_help(FILE *to);

#endif
