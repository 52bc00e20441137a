/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_PULSE_H
#define FATHOM_PULSE_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/trigger.h"
#include "fathom/hal.h"
#include "fathom/sample.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Triggers a sensor and measures the one high pulse that comes back, over and over (A16 1). The pulse is measured by
 * a fathom_capture_t, so a slow loop loses time and no precision. It never waits, and keeps no state but in the
 * struct below, which the caller owns. One context only.
 *
 * A cycle begins with the falling edge of the trigger. What the pulse means, by its width:
 *   under noise_us                noise: it is forgotten, and the capture goes on looking
 *   noise_us .. no_target_us      a target. Wherever after the trigger the pulse stands: the 110 ms of the datasheet
 *                                 are information only
 *   no_target_us .. stuck_us      nothing in range; the datasheet has one fixed pulse of about 94 ms for that
 *   more, or high when the cycle is over     FATHOM_FAULT: no pulse of a working sensor, a line that is stuck
 *   none when the cycle is over, and low     FATHOM_ERR_NO_RESPONSE: no supply, a cut wire; never "nothing in range"
 * The first that is no noise decides; the rest of its cycle is not looked at.
 *
 * What it cannot do: a pulse of another source, between noise_us and stuck_us long, looks like the sensor's.
 */

/* Zero-valued members of fathom_pulse_config_t mean these. */
#define FATHOM_PULSE_DEFAULT_CYCLE_US     221000uL
#define FATHOM_PULSE_DEFAULT_NOISE_US     2700u
#define FATHOM_PULSE_DEFAULT_NO_TARGET_US 92000uL
#define FATHOM_PULSE_DEFAULT_STUCK_US     105000uL

/* Read by init only; what it points at outlives the meter. */
typedef struct {
    const fathom_clock_t *clock;
    const fathom_capture_t *capture; /* of the sensor's output; the meter's alone */
    /* The sensor's input: a pin, or the break of a UART whose TX it is and which has no other user. */
    fathom_output_t trigger;
    /* From one falling edge to the next, at least. It "must be greater than 220ms" (A16 1(2)), also by a clock that
     * counts in ms; 0 and anything less: 221 ms. */
    uint32_t cycle_us;
    /* How long the trigger is low, at least, and how long high before it falls; 0: 2 ms (trigger.h). */
    uint16_t low_us;
    /* Pulses below it are noise. The shortest one is 3 ms (A16 1(3)), of which 10 % are left for the clocks of both
     * sides; 0: 2.7 ms. */
    uint16_t noise_us;
    /* Pulses from it on are "nothing in range": "about 94ms" (A16 1(2)); 0: 92 ms. */
    uint32_t no_target_us;
    /* Pulses over it are a fault; 0: 105 ms, 94 and 10 % and some. */
    uint32_t stuck_us;
} fathom_pulse_config_t;

/* What came of one cycle. */
typedef struct {
    uint32_t width_us; /* 0: there was none, the line is high and stays so */
    uint32_t time_us;  /* the clock at the end of the pulse, or of the cycle where the line stays high */
    uint8_t kind;      /* FATHOM_TARGET, FATHOM_NO_TARGET or FATHOM_FAULT */
} fathom_pulse_reading_t;

typedef struct {
    fathom_trigger_t trigger;
    const fathom_capture_t *capture;
    uint32_t no_target_us;
    uint32_t stuck_us;
    uint16_t noise_us;
    uint16_t noises; /* pulses that were too short; stops at 65535, and the user may set it to 0 */
    bool waiting;    /* for a pulse */
} fathom_pulse_meter_t;

/*
 * Makes a meter ready and the trigger pin high; the first trigger comes low_us later.
 * FATHOM_READY, or FATHOM_ERR_ARGUMENT: no clock, no capture, no trigger, or widths that are not in order;
 * FATHOM_ERR_UNSUPPORTED: the UART has no set_break.
 */
fathom_status_t fathom_pulse_init(fathom_pulse_meter_t *meter, const fathom_pulse_config_t *config);

/*
 * Does all that can be done without waiting: it triggers when a cycle is over and takes pulses.
 * FATHOM_READY: *reading is new. The next cycle has begun, if it was time.
 * FATHOM_PENDING: nothing new. *reading is untouched, as after every error:
 * FATHOM_ERR_NO_RESPONSE: a cycle without a pulse.
 * FATHOM_ERR_PORT: the capture or the break failed; returned by every poll until it works again. Or the UART has
 * refused for a second to begin or to end the break; it is tried on, and that is returned once a second.
 * Correct across the wrap of the clock, if it is called once in 71 minutes. In a slow loop cycles are longer, and the
 * trigger is low until the call after low_us.
 */
fathom_status_t fathom_pulse_poll(fathom_pulse_meter_t *meter, fathom_pulse_reading_t *reading);

/* How long from now until poll has something to do if no pulse ends, in microseconds; never FATHOM_NO_DEADLINE. The
 * end of a pulse should wake a program that sleeps so long; if it does not, the reading comes when the cycle is
 * over. */
uint32_t fathom_pulse_due_us(const fathom_pulse_meter_t *meter);

/*
 * Lets the trigger go high again, if a cycle had made it low; the memory is the caller's. Call it again, and not poll,
 * unless it returns
 * FATHOM_READY: the trigger is high, always where it is a pin.
 * FATHOM_PENDING: the UART has refused to end the break; the trigger is low until a later call.
 * FATHOM_ERR_PORT: the break failed, or the UART has refused for a second. If the caller gives up here, it stays low.
 */
fathom_status_t fathom_pulse_deinit(fathom_pulse_meter_t *meter);

#ifdef __cplusplus
}
#endif

#endif
