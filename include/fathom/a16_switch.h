/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A16_SWITCH_H
#define FATHOM_A16_SWITCH_H

#include "fathom/contact.h"
#include "fathom/sensor.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A16 with switch output (A16 4): a level on its TX pin says whether something is nearer than its threshold, 1 m
 * from the factory. It measures every 500 ms and changes the level after 3 measurements in a row below the threshold,
 * or 5 above it: 1.5 and 2.5 s. The pin has no driving capability: an input of 3 V logic reads it, no load hangs on
 * it. debounce.h is the same rule in software, for any sensor in any mode.
 *
 * A sample for the first level and for each new one: FATHOM_NEAR or FATHOM_FAR, without a distance; time_us is when
 * the level was first seen, raw is the level. What the level was before the module's first decision the datasheet
 * does not say; nor can a switch say "no answer": a cut wire reads as the level that the board pulls it to, so pull
 * it to the harmless one. The errors of fathom_poll:
 *   FATHOM_ERR_STALE  no level stood still for settle_us in stale_us: noise, or a line that is never silent
 *   FATHOM_ERR_PORT   the port of the line on the same pins is broken; said by every poll that has no sample
 *
 * Threshold and polarity are set by Modbus on the same pins (A16 6: registers 0x0206 and 0x0205), 9600 8N1. RX is
 * the UART's input, and TX carries the answers: with `line` in the config, the level is not looked at while a request
 * is under way there, nor until 5 ms after the last byte. To the host's UART a low level is a break: bytes with
 * framing errors may stand before an answer, and behind it, which the line drops and counts
 * (FATHOM_LINE_BAD_BYTES). A UART that reports a break again and again while it lasts makes the line look busy for
 * ever; switch its receiver off while nothing is asked.
 */

/* What a high level means. */
typedef enum {
    FATHOM_A16_SWITCH_POSITIVE = 1, /* high is FATHOM_NEAR (A16 4(2)); register 0x0205 is 1 */
    FATHOM_A16_SWITCH_NEGATIVE = 2  /* low is; register 0x0205 is 0 */
} fathom_a16_switch_polarity_t;

/* Read by init only; what it points to outlives the sensor. Members that are 0 mean their defaults. */
typedef struct {
    const fathom_pin_t *pin; /* reads TX */
    const fathom_clock_t *clock;
    fathom_line_t
        *line;          /* on the same pins; this driver polls it too. NULL: none, settings are not touched */
    uint32_t settle_us; /* how long a level stands before it counts; 0: 20 ms, longer than any answer */
    uint32_t period_us; /* a sample that repeats the level, so long after the last one; 0: changes alone */
    uint32_t look_us;  /* the longest that due_us advises between looks; FATHOM_NO_DEADLINE where an interrupt
                            of the pin wakes the program; 0: 10 ms */
    uint32_t stale_us; /* FATHOM_ERR_STALE after so long without a level that counts; 0: 2 s */
    uint8_t
        polarity; /* fathom_a16_switch_polarity_t; 0: positive. The factory's is not printed, but "less than
                            1 meter" is printed as high (A16 4(2)) */
    uint8_t address; /* its Modbus address, which becomes the samples' unit; 0 where nobody asks it */
} fathom_a16_switch_config_t;

typedef struct {
    fathom_contact_t base;
} fathom_a16_switch_t;

/* FATHOM_READY, or FATHOM_ERR_ARGUMENT: no clock, no pin that can be read, or no such polarity. */
fathom_status_t fathom_a16_switch_init(fathom_a16_switch_t *sensor, const fathom_a16_switch_config_t *config);

/*
 * Register 0x0205 has been set to another polarity: from now on levels are read so, after settle_us. Call it as
 * soon as the write has ended. There is no sample, since the level turns with it; one of the wrong kind can come
 * where the module takes longer than settle_us to obey. FATHOM_READY, or FATHOM_ERR_ARGUMENT: no such polarity.
 */
fathom_status_t fathom_a16_switch_set_polarity(fathom_a16_switch_t *sensor, uint8_t polarity);

/* For fathom_poll. There is nothing to undo: forget the sensor when it is no longer polled. */
fathom_sensor_t fathom_a16_switch_sensor(fathom_a16_switch_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
