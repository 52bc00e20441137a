/* SPDX-License-Identifier: MIT */
#ifndef ATTEMPT_H
#define ATTEMPT_H

#include "reading/results.h"
#include "reading/run.h"

/* What the loop does with the outcomes of a sensor's attempts. */

/* Returns true if the sensor had all attempts that the user asked for. */
bool attempt_was_last(const loop_t *loop, const sensor_t *sensor);

/* The longest time for which a sensor that does not respond is left alone: it must not slow down others on its line. */
uint32_t attempt_backoff_us(const line_t *line);

/* The listener of the line, or of the sensor if several share the line. */
listener_t *attempt_listener(line_t *line, sensor_t *sensor);

/* The listener of the sensor whose request is about to be sent, which the line has put first. ctx: the line_t. */
listener_t *attempt_whose(void *ctx);

/* Counts late responses for the sensor that sent them: they explain its failures, and not those of the sensor whose
 * request is pending. */
void attempt_count_late(line_t *line);

/* Where the results of samples go: to the sink. */
results_to_t attempt_results(loop_t *loop);

/* What is received and counted from now on belongs to the next attempt. */
void attempt_start(sensor_t *sensor);

/* Reports an outcome of the driver, which is not FATHOM_PENDING. */
void attempt_outcome(line_t *line, sensor_t *sensor, fathom_status_t status, const fathom_sample_t *sample);

/* The port of the sensor was lost. is_known: the user knows from another sensor on the line. */
void attempt_lost(line_t *line, sensor_t *sensor, bool is_known);

/* The port of the sensor is waited for. This is no attempt. */
void attempt_absent(line_t *line, sensor_t *sensor);

#endif
