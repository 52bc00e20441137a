/* SPDX-License-Identifier: MIT */
#ifndef CALIBRATE_MEASURE_H
#define CALIBRATE_MEASURE_H

#include "cli/session_options.h"

enum { CALIBRATE_LEAST_SAMPLES = 5, CALIBRATE_SAMPLES = 25, CALIBRATE_MOST_SAMPLES = 200 };

typedef struct {
    uint32_t samples;   /* of a batch */
    uint32_t spread_mm; /* the largest difference that the samples of a batch may have */
} calibrate_batch_t;

typedef struct {
    int32_t median_mm;
    uint32_t spread_mm;
} calibrate_measurement_t;

/*
 * Measures until the medians of two consecutive batches, 2 s apart, differ by at most half their tolerance: a sensor
 * with a filter settles slowly. A batch with a sample that is no distance, or with a larger spread, is discarded.
 * is_after_write: samples of the first second are discarded, since the sensor may have measured them before the write.
 * Returns false after printing why there are no two such batches.
 */
bool calibrate_measure(session_t *session, const calibrate_batch_t *batch, bool is_after_write,
                       calibrate_measurement_t *measurement);

#endif
