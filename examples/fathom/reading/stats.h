/* SPDX-License-Identifier: MIT */
#ifndef STATS_H
#define STATS_H

#include <stdio.h>

#include "reading/site.h"

/* The counters of a run. */
typedef struct {
    counters_t sum; /* of all sensors */
    sensor_t *const *sensors;
    size_t sensor_count;
    uint64_t requests;
    uint64_t reconnects;
    uint64_t dropped_spikes; /* if has_median */
    bool has_median;
    uint64_t time_us; /* since the start */
    bool has_port;    /* the driver of the port counts errors */
} account_t;

/* Prints the sums in two lines, and a line for each of several sensors. Counters of the line that are 0 are left out. */
void stats_print_short(const account_t *account, FILE *to);

/* Prints all counters as lines of text, or as a JSON object in one line. */
void stats_print(const account_t *account, FILE *to);
void stats_print_json(const account_t *account, FILE *to);

/* Writes the counters of one sensor as members of the open object. */
void stats_json_of_sensor(json_t *json, sensor_t *sensor);

#endif
