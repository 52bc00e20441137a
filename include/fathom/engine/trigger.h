/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TRIGGER_H
#define FATHOM_TRIGGER_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/output.h"
#include "fathom/hal.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The falling edges that a sensor is triggered by (A16 1, 3): low for low_us at least, high for as long at least, and
 * period_us at least from edge to edge. What pulse.h and a16_controlled.h are built on. It never waits; one context
 * only.
 *
 * Each call tries an output that is busy again. When it has refused for FATHOM_TRIGGER_REFUSED_US to begin or to end a
 * low level that is FATHOM_ERR_PORT, once in as long; shorter refusals are never added up.
 */

/* A low_us of 0 means this. The datasheet wants an edge and gives no time; no input misses 2 ms. */
#define FATHOM_TRIGGER_DEFAULT_LOW_US 2000u

#define FATHOM_TRIGGER_REFUSED_US 1000000uL

typedef struct {
    /* Set by the caller before init. */
    fathom_output_t output;
    const fathom_clock_t *clock; /* outlives the trigger */
    uint32_t period_us;          /* more than low_us */
    uint16_t low_us;

    /* The engine's; may be read. */
    bool low;            /* held low, or its end is not yet done */
    bool refused;        /* the last call of the output was */
    uint32_t refused_us; /* the clock when that began, or was last reported */
    uint32_t polled_us;  /* the clock at the last look, which an edge is */
    uint32_t left_us;    /* of the period */
} fathom_trigger_t;

/* Makes the output high; the first edge comes low_us later. FATHOM_READY, or FATHOM_ERR_ARGUMENT: no output;
 * FATHOM_ERR_UNSUPPORTED: a port without set_break. */
fathom_status_t fathom_trigger_init(fathom_trigger_t *trigger);

/* Looks at the clock: the first thing of a poll. */
void fathom_trigger_look(fathom_trigger_t *trigger);

/* Would fathom_trigger_drive begin, if it may? */
static inline bool fathom_trigger_is_due(const fathom_trigger_t *trigger)
{
    return !trigger->low && (trigger->left_us == 0u);
}

/*
 * Drives the output where it is time to; `may_begin`: the next falling edge may come.
 * FATHOM_READY    it has come; polled_us is a look at the clock after it, so that no period is too short, whatever
 *                 interrupts the two
 * FATHOM_PENDING  nothing of note; perhaps the rising edge has come
 * FATHOM_ERR_PORT the output is broken, or refuses
 */
fathom_status_t fathom_trigger_drive(fathom_trigger_t *trigger, bool may_begin);

/* How long from now until drive has something to do, or until `until_us` after the last look has passed, if that is
 * sooner; 1 ms where that time has come, for an output that refuses. */
uint32_t fathom_trigger_due_us(const fathom_trigger_t *trigger, uint32_t until_us);

/* Lets the output go high, if an edge had made it low. FATHOM_READY: it is high. FATHOM_PENDING, FATHOM_ERR_PORT: not
 * yet, to be called again. */
fathom_status_t fathom_trigger_deinit(fathom_trigger_t *trigger);

#ifdef __cplusplus
}
#endif

#endif
