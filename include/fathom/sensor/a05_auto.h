/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A05_AUTO_H
#define FATHOM_A05_AUTO_H

#include "fathom/engine/output.h"
#include "fathom/engine/sensor.h"
#include "fathom/sensor/internal/dyp_auto.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A05 with UART automatic output (A05 1). 9600 8N1.
 * Without a request it sends FF, four distances, SUM over and over, of processed or of real-time values. Which of
 * them is decided by its RX pin in the first second after power-on, high or open for processed, low for
 * real-time: fathom_a05_auto_select. The datasheet gives settling times of 300 to 1500 ms and of 300 ms, and no
 * frame period. The first Modbus request ends automatic output; only power-on brings it back.
 *
 * Four samples a frame, one a fitted probe, with one sequence number and one time, which is when its last byte
 * came. They are given when the line has been silent for gap_us behind it or the next frame begins. FATHOM_TARGET,
 * or what the window makes of the values 0, FFFD, FFFE and FFFF (dyp.h). The errors of fathom_poll:
 *   FATHOM_ERR_STALE      Nothing was received for `stale_us`: no wire, no supply, or another mode. Returned once every
 *                         `stale_us`. Also returned if the newest frame is too old (stream.h, rule 6).
 *   FATHOM_ERR_CHECKSUM   Bytes were received for `stale_us`, but no frame: damage, noise, another rate, or another
 *                         device. `base.stream.counters` show which (stream.h). Returned once every `stale_us`.
 *   FATHOM_ERR_MALFORMED  this probe's value is refused: outside the window, or FFFF. The other probes' samples are
 *                         given, but where the frame's place is not sure (stream.h) and in the first frame with a
 *                         refused value, which may be damaged: then all of it is refused.
 *                         base.measurement.refused_probe and refused_raw tell which; counted
 *   FATHOM_ERR_PORT       the HAL's port is broken; returned by every poll until it works again. Or it has refused for
 *                         a second to end the break that selects; it is tried on, that is returned once a second,
 *                         samples go on between
 */

/* Read by init only. Members that are 0 mean their defaults. */
typedef struct {
    /* The line, whose listener the driver becomes. The line may also carry Modbus. */
    fathom_line_t *line;
    /* Time without a frame after which fathom_poll() returns an error, in microseconds: 1 to 2^31 - 1. 0 selects 2 s.
     * The datasheet prints no period of the frames. If a unit sends less often than every 2 s, choose more. */
    uint32_t stale_us;
    /* Silence that starts and ends a frame (stream.h), in microseconds: 1042 to 65535. Behind an operating system
     * choose 25000. 0 selects 5000. */
    uint16_t gap_us;
    fathom_dyp_window_t window; /* the distances that are believed; 0: 1 and 6000 mm */
    /* Bit probe - 1: fitted; 0: all four. A probe that is not fitted gives neither a sample nor an error. */
    uint8_t probes;
    /* What drives the module's RX pin, for fathom_a05_auto_select: a pin, or a break of the line whose TX it is
     * (fathom_output_line_break). */
    fathom_output_t select;
} fathom_a05_auto_config_t;

/* How long RX is held low for real-time values: the first second (A05 1(1)), and half of one for the supply to rise. */
#define FATHOM_A05_SELECT_US 1500000uL

typedef struct {
    fathom_dyp_auto_t base;
    uint16_t values[4];
    uint8_t storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_A05_LENGTH)];
    fathom_output_t select;
    uint32_t select_left_us; /* RX is held low for so long */
    uint32_t polled_us;
    bool selecting;
    uint8_t probes; /* bit probe - 1: fitted */
    bool was_odd;   /* the frame before had a fitted probe whose value was refused, or there was none */
} fathom_a05_auto_t;

/*
 * Initialises the driver and makes it the listener of the line.
 *   FATHOM_OK         The driver listens.
 *   FATHOM_ERR_ARGUMENT  `line` is NULL, or a member is outside its range: `stale_us` above 2^31 - 1, `gap_us` of 1 to
 *                        1041, `min_mm` above `max_mm`, or `probes` above 15.
 *   FATHOM_ERR_BUSY      The line has another listener, which stays.
 */
fathom_status_t fathom_a05_auto_init(fathom_a05_auto_t *sensor, const fathom_a05_auto_config_t *config);

/*
 * To be called right before the sensor gets power: sets its RX pin for the values that it is to send. For real-time it
 * is low for 1.5 s, after which fathom_poll makes it high again; else it is high. The deadline for a frame begins anew.
 * FATHOM_OK: switch the power on now.
 * FATHOM_ERR_ARGUMENT: no such value. FATHOM_ERR_UNSUPPORTED: real-time values without `select`, or a port
 * that cannot hold its TX low.
 * FATHOM_ERR_BUSY: something is being sent on the line, or the break of a power-on before has not ended; try again.
 * FATHOM_ERR_PORT: the port is broken.
 */
fathom_status_t fathom_a05_auto_select(fathom_a05_auto_t *sensor, fathom_dyp_value_t value);

/*
 * Stops listening, if the driver is the listener of the line, and lets RX go high, if it is still held low; the memory
 * is the caller's again. Call it again, and not poll, unless it returns
 * FATHOM_OK: RX is high, always where it is a pin.
 * FATHOM_PENDING, FATHOM_ERR_PORT: as fathom_line_break(line, false). If the caller gives up here, TX stays low, and
 * the line sends nothing until that is FATHOM_OK.
 */
fathom_status_t fathom_a05_auto_deinit(fathom_a05_auto_t *sensor);

/* For fathom_poll. Where a fitted probe's value is refused, it is refused alone if the place of the frame is sure
 * (stream.h) and the frame before, if there was one, had a refused value too. Else all of it is refused: out of step
 * the other distances could be permuted, and after good frames damage is more likely, of which an 8-bit sum misses one
 * in 256. So only the first frame with a refused value is lost. */
fathom_sensor_t fathom_a05_auto_sensor(fathom_a05_auto_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
