/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_EDGES_H
#define FATHOM_EDGES_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Makes a fathom_capture_t out of a pin interrupt, for boards without capture hardware on that pin: the interrupt
 * feeds each edge with its time, the main loop takes the pulses.
 *
 * An interrupt can miss an edge, when two come before it runs, or see one twice, when a slow edge bounces. So that no
 * wrong width comes of that:
 *   high, when it was high   within same_us of the rise: the same edge again, and the first one counts. Later: the
 *                            fall before it was missed, and with it the width; the pulse is given up and counted,
 *                            and so is what lasts until the next fall, which may be the end of either
 *   low, when it was low     the same edge again, or the rise before it was missed: there is no pulse
 * A pulse whose last edge was missed goes on until the next one; the level that take() reports is the pin's, if the
 * pin is given, and not that of the last edge.
 *
 * Times are differences of a clock that wraps: widths are right up to 71 minutes. A pulse that begins before arm()
 * never counts, however long it lasts. What a bounce within same_us hides is a pulse shorter than that.
 *
 * Safe on 8-bit machines without a lock: there is one writer, the interrupt (or interrupts of one priority, which
 * cannot interrupt each other), and one reader, the main loop, on one core. Both sides write different members; what
 * both look at is single bytes, volatile, which no machine reads in halves; a pulse is in place before the byte that
 * announces it, and is not written to again before the reader has marked it as taken.
 */
enum {
    FATHOM_EDGES_PULSES = 4, /* that wait to be taken; more are dropped and counted. A power of two */
    FATHOM_EDGES_DEFAULT_SAME_US = 50
};

typedef struct {
    uint32_t width_us;
    uint32_t end_us;
    uint8_t rise; /* the number of its rise */
} fathom_edges_pulse_t;

typedef struct {
    /* The interrupt's. */
    volatile fathom_edges_pulse_t pulses[FATHOM_EDGES_PULSES];
    uint32_t rise_us;
    volatile uint8_t written; /* pulses so far; wraps */
    volatile uint8_t rises;   /* so far; wraps */
    volatile uint8_t lost;    /* pulses that found no free place; stops at 255 */
    volatile uint8_t missed;  /* edges that must have been missed; stops at 255 */
    volatile uint8_t high;    /* 1, or 0: low */
    bool timed;               /* rise_us is the time of the rise */

    /* The reader's. */
    const fathom_pin_t *pin;
    volatile uint8_t taken; /* pulses so far; wraps */
    uint8_t armed;          /* `rises` at arm */

    /* The caller's to change before the interrupt is enabled. */
    uint16_t same_us;
} fathom_edges_t;

/*
 * Makes it ready. pin: where `get` tells the level at any time, or NULL; it outlives the edges. Without it the line
 * is taken as low until the first edge. To be called before the interrupt is enabled.
 */
void fathom_edges_init(fathom_edges_t *edges, const fathom_pin_t *pin);

/*
 * An edge, for the interrupt to call: the level after it (of an interrupt on both edges: what the pin is when it is
 * read), and when it was, by the clock of the HAL or a counter of the hardware that agrees with it.
 */
void fathom_edges_feed(fathom_edges_t *edges, bool high, uint32_t time_us);

/* For a fathom_pulse_config_t. arm and take belong to the main loop. */
fathom_capture_t fathom_edges_capture(fathom_edges_t *edges);

#ifdef __cplusplus
}
#endif

#endif
