/* SPDX-License-Identifier: MIT */
#ifndef RESULTS_H
#define RESULTS_H

#include <stdio.h>

#include "reading/site.h"

void results_config_copy(results_config_t *to, const results_config_t *from);

/* Where results go. */
typedef struct {
    void (*report)(void *ctx, sensor_t *sensor, const result_t *result);
    void *ctx;
} results_to_t;

/* Starts the processing of a sensor. Call it before the first sample. */
void results_start(sensor_t *sensor, uint32_t now_us);

/*
 * For each sample and each failed attempt, and from time to time: the first state of an alarm is reported when a distance
 * decides it, or unknown_us after the start.
 */
void results_sample(sensor_t *sensor, const fathom_sample_t *sample, const results_to_t *to);
void results_failure(sensor_t *sensor, fathom_status_t status, uint32_t now_us, const results_to_t *to);
void results_pass(sensor_t *sensor, uint32_t now_us, const results_to_t *to);

/* Spikes of all probes that were dropped. */
uint64_t results_dropped(const sensor_t *sensor);

/* Prints a line for each probe that had spikes. */
void results_print_dropped(const sensor_t *sensor, FILE *to);

#endif
