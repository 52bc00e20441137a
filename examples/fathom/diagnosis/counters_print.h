/* SPDX-License-Identifier: MIT */
#ifndef COUNTERS_PRINT_H
#define COUNTERS_PRINT_H

#include <stdio.h>

#include "reading/site.h"

/* All that has been counted, to be told. */
typedef struct {
    counters_t sum; /* of all sensors */
    sensor_t *const *sensors;
    size_t sensor_count;
    uint64_t requests; /* that were sent */
    uint64_t reconnects;
    uint64_t dropped_spikes; /* of the medians, ... */
    bool has_median;         /* ... where there are some */
    uint64_t time_us;        /* since the start */
    bool has_port;           /* its driver counts */
} account_t;

/* The sums, in two lines or less, and a line a sensor where there are several; what is 0 is left out. */
void counters_print(const account_t *account, FILE *to);

/* All of it, for people and as a JSON object in one line. */
void counters_print_all(const account_t *account, FILE *to);
void counters_print_json(const account_t *account, FILE *to);

#endif
