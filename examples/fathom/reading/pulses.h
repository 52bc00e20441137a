/* SPDX-License-Identifier: MIT */
#ifndef PULSES_H
#define PULSES_H

#include <stdio.h>

#include "sensors/reader.h"

/* How exact pulses are measured on this board: the widths of those that were distances, and what was rejected. It says
 * something of the board while the target stands still. */
typedef struct {
    uint64_t count; /* since the last print, as all of it */
    uint32_t least_us;
    uint32_t most_us;
    double mean_us;
    double squares; /* the sum of squared differences from the mean */
    uint64_t no_targets;
    uint64_t faults;         /* longer than any of the sensor, or without an end */
    uint64_t noises;         /* shorter */
    uint64_t missed;         /* edges, of which no event came */
    uint64_t lost_events;    /* that found no place in the kernel's queue */
    uint32_t attempt_noises; /* of the last attempt */
} pulses_t;

/* An attempt of a sensor that has pulses has ended. sample: NULL unless the status is FATHOM_OK. */
void pulses_add(pulses_t *pulses, const reader_counters_t *counted, const fathom_sample_t *sample);

/* Prints one line and resets the counters. */
void pulses_print(pulses_t *pulses, const char *name, FILE *to);
void pulses_print_json(pulses_t *pulses, const char *name, FILE *to);

#endif
