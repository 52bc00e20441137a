/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_DYP_AUTO_H
#define FATHOM_DYP_AUTO_H

#include "fathom/engine/line.h"
#include "fathom/engine/stream.h"
#include "fathom/sensor/internal/dyp.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a16_auto.h and a05_auto.h are built on: an ultrasonic sensor that sends frames by itself. Their users
 * need not know it. */
typedef struct {
    fathom_stream_t stream;
    fathom_dyp_measurement_t measurement;
    fathom_line_t *line;
} fathom_dyp_auto_t;

/*
 * Initialises what both drivers share and makes the stream the listener of the line. The driver has set `line`, the
 * members that fathom_stream_start() needs, and `values`, `window`, `model`, `address` and `first` of the measurement.
 *   FATHOM_OK         The stream listens.
 *   FATHOM_ERR_ARGUMENT  `line` is NULL, or a member of the window or the stream is outside its range.
 *   FATHOM_ERR_BUSY      The line has another listener, which stays.
 */
fathom_status_t fathom_dyp_auto_init(fathom_dyp_auto_t *sensor, uint16_t default_max_mm);

/* Stops listening, if the stream is the listener of the line. */
void fathom_dyp_auto_deinit(fathom_dyp_auto_t *sensor);

/*
 * Polls the line and takes the newest frame. FATHOM_OK: its values are those of the measurement, of which probe 1
 * waits to be returned. FATHOM_PENDING: there is no new frame. FATHOM_ERR_STALE, FATHOM_ERR_CHECKSUM, FATHOM_ERR_PORT:
 * as in a16_auto.h.
 */
fathom_status_t fathom_dyp_auto_take(fathom_dyp_auto_t *sensor);

/* How long, in us, until take has something to do if no byte comes. */
uint32_t fathom_dyp_auto_due_us(const fathom_dyp_auto_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
