/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A16_AUTO_H
#define FATHOM_A16_AUTO_H

#include "fathom/engine/output.h"
#include "fathom/engine/sensor.h"
#include "fathom/sensor/dyp_auto.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A16 with automatic output: UART automatic (A16 2) and RS232 (A16 5) before its first Modbus request. 9600 8N1.
 * Without a request it sends FF H L SUM over and over, of the processed or of the real-time value. Which of them
 * is decided by its RX pin, high or open for processed, low for real-time; the datasheet gives settling times
 * of 2.5 to 7.5 s and of 500 ms for them, and no frame period.
 *
 * One sample a frame, given when the line has been silent for gap_us behind it or the next frame begins;
 * time_us is when its last byte came. FATHOM_TARGET, or what the window makes of the values 0, FFFD, FFFE and FFFF
 * (dyp.h). The errors of fathom_poll:
 *   FATHOM_ERR_STALE      no good frame for stale_us: not wired, no supply, not in this mode, another rate, or
 *                         noise; stream.counters tell these apart. Returned once every stale_us.
 *   FATHOM_ERR_MALFORMED  a good frame with a value that is refused: outside the window, or FFFF; it is in
 *                         base.measurement.refused_raw, and counted
 *   FATHOM_ERR_PORT       the HAL's port is broken; returned by every poll until it works again
 */

/* Read by init only. Members that are 0 mean their defaults. */
typedef struct {
    fathom_line_t *line; /* the line it is on, to itself or with Modbus; it becomes the line's listener */
    /* What drives the module's RX pin: a pin, or a break of the line whose TX it is (fathom_output_line_break). None:
     * it is open, or nothing is selected. */
    fathom_output_t select;
    /* 0: 10 s: the datasheet prints no period, and 7.5 s for the processed value to settle. Up to 35 minutes. */
    uint32_t stale_us;
    /* A silence of so much starts and ends a frame (stream.h); behind an operating system 25000; 0: 5000. */
    uint16_t gap_us;
    fathom_dyp_window_t window; /* the distances that are believed; 0: 1 and 16350 mm */
    uint8_t value;              /* fathom_dyp_value_t: what fathom_a16_auto_select selects at init */
} fathom_a16_auto_config_t;

typedef struct {
    fathom_dyp_auto_t base;
    fathom_output_t select;
    uint8_t value; /* fathom_dyp_value_t, as it was selected last */
    uint16_t values[1];
    uint8_t storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_A16_LENGTH)];
} fathom_a16_auto_t;

/* Begins to listen. FATHOM_READY, or FATHOM_ERR_ARGUMENT: no line, min_mm over max_mm, or no such value;
 * FATHOM_ERR_UNSUPPORTED: FATHOM_REAL_TIME without `select`, or a port that has no break; with it also the other errors
 * of fathom_a16_auto_select, FATHOM_ERR_BUSY where that returns FATHOM_PENDING. */
fathom_status_t fathom_a16_auto_init(fathom_a16_auto_t *sensor, const fathom_a16_auto_config_t *config);

/*
 * UART automatic (A16 2(2)) alone: which value the module sends from now on. Its RX pin goes high for the processed
 * one, low for the real-time one, by `select`; during a break of a line nothing can be sent there. Values in the
 * first 0.5 s (real-time) or 2.5 to 7.5 s (processed) may still be of the other kind; the frames do not show it.
 * FATHOM_READY, always where there is a pin; of a break what fathom_line_break returns, after which the selection is
 * what it was: call again. FATHOM_ERR_ARGUMENT: no such value. FATHOM_ERR_UNSUPPORTED: no `select`.
 */
fathom_status_t fathom_a16_auto_select(fathom_a16_auto_t *sensor, fathom_dyp_value_t value);

/*
 * Stops listening and ends a break that selected; the memory is the caller's again. Call it again, and not poll,
 * unless it returns
 * FATHOM_READY: no break is held, always where there is a pin, which stays as it is.
 * FATHOM_PENDING, FATHOM_ERR_PORT: as fathom_line_break(line, false). If the caller gives up here, TX stays low, and
 * the line sends nothing until that is FATHOM_READY.
 */
fathom_status_t fathom_a16_auto_deinit(fathom_a16_auto_t *sensor);

/* For fathom_poll. */
fathom_sensor_t fathom_a16_auto_sensor(fathom_a16_auto_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
