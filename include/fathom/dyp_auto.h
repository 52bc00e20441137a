/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_DYP_AUTO_H
#define FATHOM_DYP_AUTO_H

#include "fathom/dyp.h"
#include "fathom/line.h"
#include "fathom/sensor.h"
#include "fathom/stream.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a16_auto.h and a05_auto.h are built on: an ultrasonic sensor that sends frames by itself. Their users
 * need not know it. */
typedef struct {
    fathom_stream_t stream;
    fathom_stream_config_t stream_config;
    fathom_dyp_answer_t answer;
    fathom_line_t *line;
    uint8_t probes; /* bit probe - 1: fitted */
    bool was_odd;   /* the frame before had a fitted probe whose value was refused, or there was none */
} fathom_dyp_auto_t;

/*
 * Begins to listen on the line, instead of whoever did before. The caller has set the line, the probes, the
 * stream_config, and values, window, model and first of the answer. FATHOM_READY, or FATHOM_ERR_ARGUMENT: no
 * line, or a window that is upside down.
 */
fathom_status_t fathom_dyp_auto_init(fathom_dyp_auto_t *sensor, uint16_t default_max_mm);

/* Stops listening. */
void fathom_dyp_auto_deinit(fathom_dyp_auto_t *sensor);

/* For fathom_poll and fathom_due_us. Where a fitted probe's value is refused, it is refused alone if the place of the
 * frame is sure (stream.h) and the frame before, if there was one, had an odd probe too. Else all of it is refused: out
 * of step the other distances could be permuted, and after frames in which all was well, damage is more likely, of
 * which an 8-bit sum misses one in 256. So one frame is lost when a probe turns odd, and none after it. */
fathom_sensor_t fathom_dyp_auto_sensor(fathom_dyp_auto_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
