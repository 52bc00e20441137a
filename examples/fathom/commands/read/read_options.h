/* SPDX-License-Identifier: MIT */
#ifndef READ_OPTIONS_H
#define READ_OPTIONS_H

#include "cli/rows.h"
#include "output/file.h"

/* The options of `fathom read`. */
typedef struct {
    sensor_settings_t sensors;
    results_config_t results;
    output_file_t file;
    uint32_t count;    /* attempts of each sensor; 0: endless */
    uint32_t stats_us; /* from one print of all counters to the next; 0: at the end only */
    uint8_t format;    /* its row in read_formats */
    bool stats;        /* print all counters */
    bool until_alarm;  /* stop when an alarm is on */
    bool quiet;        /* print only fatal errors and counters */
    bool no_header;    /* of csv */
} read_options_t;

extern const option_table_t read_tables[];

#endif
