/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A05_AUTO_H
#define FATHOM_A05_AUTO_H

#include "fathom/dyp_auto.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A05 with UART automatic output (A05 1). 9600 8N1.
 * Nobody asks it: it sends FF, four distances, SUM over and over, of processed or of real-time values. Which of
 * them is decided by its RX pin in the first second after power-on, high or open for processed, low for
 * real-time: fathom_a05_auto_power_on. The datasheet gives settling times of 300 to 1500 ms and of 300 ms, and no
 * frame period. The first Modbus command ends automatic output; power alone brings it back.
 *
 * Four samples a frame, one a fitted probe, with one sequence number and one time, which is when its last byte
 * came. They are given when the line has been silent for gap_us behind it or the next frame begins. FATHOM_TARGET,
 * or what the window says that the values 0, FFFD, FFFE and FFFF are (dyp.h). The errors of fathom_poll:
 *   FATHOM_ERR_STALE      no good frame for stale_us: not wired, no supply, not in this mode, another rate, or
 *                         noise; stream.counters tell these apart. Said once every stale_us.
 *   FATHOM_ERR_MALFORMED  this probe's value is refused: outside the window, or FFFF. The other probes' samples are
 *                         given, but where the frame's place is not sure (stream.h) and in the frame in which a
 *                         probe turns odd, which may be damaged: then all of it is refused.
 *                         base.answer.refused_probe and refused_raw tell which; counted
 *   FATHOM_ERR_PORT       the HAL's port is broken; said by every poll until it works again. Or it has refused for a
 *                         second to end the break that selects; it is asked on, that is said once a second, and what
 *                         the sensor sends goes on between
 */

/* Read by init only. Members that are 0 mean their defaults. */
typedef struct {
    fathom_line_t *line; /* the line it is on, to itself or with Modbus; it becomes the line's listener */
    uint32_t stale_us; /* 0: 10 s, as the A16; the datasheet prints no period. Who knows the period of a unit
                            sets less: some 6 frames */
    uint16_t gap_us;   /* a silence of so much starts and ends a frame (stream.h); behind an operating
                            system 25000; 0: 5000 */
    fathom_dyp_window_t window; /* the distances that are believed; 0: 1 and 6000 mm */
    uint8_t probes; /* bit probe - 1: fitted; 0: all four. A probe that is not fitted has no defined value: it
                       gives neither a sample nor an error */
    /* The module's RX pin, which outlives the sensor, for fathom_a05_auto_power_on; NULL: it is the line's TX. */
    const fathom_pin_t *select;
} fathom_a05_auto_config_t;

typedef enum {
    FATHOM_A05_PROCESSED = 0, /* steady */
    FATHOM_A05_REAL_TIME = 1  /* faster */
} fathom_a05_value_t;

/* How long RX is held low for real-time values: the first second (A05 1(1)), and half of one for the supply to rise. */
#define FATHOM_A05_SELECT_US 1500000ul

typedef struct {
    fathom_dyp_auto_t base;
    uint16_t values[4];
    uint8_t storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_A05_LENGTH)];
    const fathom_pin_t *select;
    uint32_t select_left_us; /* RX is held low for so long */
    uint32_t polled_us;
    bool selecting;
} fathom_a05_auto_t;

/* Begins to listen. FATHOM_READY, or FATHOM_ERR_ARGUMENT: no line, or min_mm over max_mm, or a probe over 4. */
fathom_status_t fathom_a05_auto_init(fathom_a05_auto_t *sensor, const fathom_a05_auto_config_t *config);

/*
 * To be called right before the sensor gets power: sets its RX pin for the values that it is to send. For real-time it
 * is low for 1.5 s, by the pin or by a break of the line, and high again after that, which fathom_poll sees to; else
 * it is high. The deadline for a frame begins anew.
 * FATHOM_READY: do switch it on now.
 * FATHOM_ERR_ARGUMENT: no such value. FATHOM_ERR_UNSUPPORTED: no pin, and the port cannot hold its TX low.
 * FATHOM_ERR_BUSY: something is being sent on the line, or the break of a power-on before has not ended; try again.
 * FATHOM_ERR_PORT: the port is broken.
 */
fathom_status_t fathom_a05_auto_power_on(fathom_a05_auto_t *sensor, fathom_a05_value_t value);

/*
 * Stops listening and lets RX go high, if it is still held low; the memory is the caller's again. To be called again,
 * and not poll, unless it returns
 * FATHOM_READY: RX is high, always where it is a pin.
 * FATHOM_PENDING, FATHOM_ERR_PORT: as fathom_line_break(line, false). Where it is given up here TX stays low, and the
 * line sends nothing until that is FATHOM_READY.
 */
fathom_status_t fathom_a05_auto_deinit(fathom_a05_auto_t *sensor);

/* For fathom_poll. */
fathom_sensor_t fathom_a05_auto_sensor(fathom_a05_auto_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
