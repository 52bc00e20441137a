/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A16_AUTO_H
#define FATHOM_A16_AUTO_H

#include "fathom/engine/output.h"
#include "fathom/engine/sensor.h"
#include "fathom/sensor/internal/dyp_auto.h"

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
 *   FATHOM_ERR_STALE      Nothing was received for `stale_us`: no wire, no supply, or another mode. Returned once every
 *                         `stale_us`. Also returned if the newest frame is too old (stream.h, rule 6).
 *   FATHOM_ERR_CHECKSUM   Bytes were received for `stale_us`, but no frame: damage, noise, another rate, or another
 *                         device. `base.stream.counters` show which (stream.h). Returned once every `stale_us`.
 *   FATHOM_ERR_MALFORMED  a good frame with a value that is refused: outside the window, or FFFF; it is in
 *                         base.measurement.refused_raw, and counted
 *   FATHOM_ERR_PORT       the HAL's port is broken; returned by every poll until it works again
 */

/* Read by init only. Members that are 0 mean their defaults. */
typedef struct {
    /* The line, whose listener the driver becomes. The line may also carry Modbus. */
    fathom_line_t *line;
    /* What drives the module's RX pin: a pin, or a break of the line whose TX it is (fathom_output_line_break). None:
     * it is open, or nothing is selected. */
    fathom_output_t select;
    /* Time without a frame after which fathom_poll() returns an error, in microseconds: 1 to 2^31 - 1. 0 selects 2 s.
     * The datasheet prints no period of the frames. If a unit sends less often than every 2 s, choose more. */
    uint32_t stale_us;
    /* Silence that starts and ends a frame (stream.h), in microseconds: 1042 to 65535. Behind an operating system
     * choose 25000. 0 selects 5000. */
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

/*
 * Initialises the driver and makes it the listener of the line. After an error, the driver does not listen.
 *   FATHOM_OK            The driver listens.
 *   FATHOM_ERR_ARGUMENT     `line` is NULL, or a member is outside its range: `stale_us` above 2^31 - 1, `gap_us` of 1
 *                           to 1041, `min_mm` above `max_mm`, or an unknown `value`.
 *   FATHOM_ERR_BUSY         The line has another listener; or the port is still sending, so that the break that selects
 *                           the value cannot begin.
 *   FATHOM_ERR_UNSUPPORTED  FATHOM_REAL_TIME without `select`, or the port has no break.
 *   others                  As fathom_a16_auto_select().
 */
fathom_status_t fathom_a16_auto_init(fathom_a16_auto_t *sensor, const fathom_a16_auto_config_t *config);

/*
 * UART automatic (A16 2(2)) alone: which value the module sends from now on. Its RX pin goes high for the processed
 * one, low for the real-time one, by `select`; during a break of a line nothing can be sent there. Values in the
 * first 0.5 s (real-time) or 2.5 to 7.5 s (processed) may still be of the other kind; the frames do not show it.
 * FATHOM_OK, always where there is a pin; of a break what fathom_line_break returns, after which the selection is
 * what it was: call again. FATHOM_ERR_ARGUMENT: no such value. FATHOM_ERR_UNSUPPORTED: no `select`.
 */
fathom_status_t fathom_a16_auto_select(fathom_a16_auto_t *sensor, fathom_dyp_value_t value);

/*
 * Stops listening, if the driver is the listener of the line, and ends a break that selected; the memory is the
 * caller's again. Call it again, and not poll, unless it returns
 * FATHOM_OK: no break is held, always where there is a pin, which stays as it is.
 * FATHOM_PENDING, FATHOM_ERR_PORT: as fathom_line_break(line, false). If the caller gives up here, TX stays low, and
 * the line sends nothing until that is FATHOM_OK.
 */
fathom_status_t fathom_a16_auto_deinit(fathom_a16_auto_t *sensor);

/* For fathom_poll. */
fathom_sensor_t fathom_a16_auto_sensor(fathom_a16_auto_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
