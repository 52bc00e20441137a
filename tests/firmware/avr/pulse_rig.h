/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_AVR_PULSE_RIG_H
#define FATHOM_TEST_AVR_PULSE_RIG_H

#include <stdbool.h>
#include <stdint.h>

#include "board.h"
#include "profile.h"

/*
 * The image `pulses` and a signal of known edges at its two inputs, PB0 (ICP1) and PD2 (INT0). Edges are placed to the
 * cycle, by the processor's own timers and not by port/sim, which knows whole microseconds.
 */
typedef struct {
    board_t board;
    profile_t profile;

    uint64_t overflow_cycle; /* of Timer1, the last one */
    uint64_t rise_cycle;     /* of the last pulse: when its edges really were, */
    uint64_t fall_cycle;
    bool
        masked; /* and whether, at one of them, another interrupt ran or was due, or the main loop had shut them out */

    /* inside */
    uint64_t fall_at_cycle;
    uint32_t passed_over_us;
    uint32_t byte_cycles; /* of the traffic; 0: none */
    uint8_t byte;
    bool is_rising; /* the edge that is captured next */
} pulse_rig_t;

/* What the image says of one pulse. */
typedef struct {
    uint32_t icp1_us;
    uint32_t icp1_end_us;
    uint32_t int0_us;
    uint32_t int0_end_us;
    uint8_t missed; /* edges, by either, so far */
} pulse_told_t;

enum { PULSE_RIG_TICK_CYCLES = 8, PULSE_RIG_PERIOD_CYCLES = 65536 * 8 }; /* of Timer1 */

/* Starts the image and lets it get ready. */
void pulse_rig_start(pulse_rig_t *rig);
void pulse_rig_end(pulse_rig_t *rig);

/* From now on a byte comes every so many cycles, each of which is sent back; 0: no more. */
void pulse_rig_traffic(pulse_rig_t *rig, uint32_t byte_cycles);

/* One pulse, beginning at this cycle or, if that has passed, at once. Fails the test unless each way tells one pulse
 * of it. */
pulse_told_t pulse_rig_pulse(pulse_rig_t *rig, uint64_t at_cycle, uint64_t width_cycles);

/* A glitch that may be told or not, beginning then: pulse_rig_pulse passes over pulses that are told with less than
 * GLITCH_US. */
enum { PULSE_RIG_GLITCH_US = 200 };
void pulse_rig_glitch(pulse_rig_t *rig, uint64_t at_cycle, uint64_t width_cycles);

/* The error of a width, in cycles: told less true. */
int64_t pulse_rig_error(const pulse_rig_t *rig, uint32_t told_us);

/* The longest time for which one interrupt keeps the others out, INT0's own left out, in cycles. */
uint32_t pulse_rig_longest_cycles(const pulse_rig_t *rig);

#endif
