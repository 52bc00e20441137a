/* SPDX-License-Identifier: MIT */
#ifndef CALIBRATE_MEASURE_H
#define CALIBRATE_MEASURE_H

#include "device/session.h"

enum { CALIBRATE_LEAST_SAMPLES = 5, CALIBRATE_SAMPLES = 25, CALIBRATE_MOST_SAMPLES = 200 };

typedef struct {
    uint32_t samples;   /* of a batch */
    uint32_t spread_mm; /* of a batch, most - least, at most */
} calibrate_batch_t;

typedef struct {
    int32_t median_mm;
    uint32_t spread_mm;
} calibrate_measurement_t;

/*
 * Measures until the medians of two batches in succession, two seconds apart, differ by no more than half their tolerance:
 * a sensor with a filter settles slowly. is_after_write: what was measured before it is dropped first. In a batch all
 * samples are targets; one that has another sample, or too large a spread, does not count. False after saying why
 * there were no two such batches, and what to try.
 */
bool calibrate_measure(session_t *session, const calibrate_batch_t *asked, bool is_after_write,
                       calibrate_measurement_t *measurement);

#endif
