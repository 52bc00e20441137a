/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_EDGES_H
#define FATHOM_EDGES_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Measures pulses with a pin interrupt, for boards without capture hardware on that pin.
 *
 * The interrupt passes each edge with its time to fathom_edges_feed(). The main loop takes the pulses through the
 * fathom_capture_t that fathom_edges_capture() returns.
 *
 * An interrupt can miss an edge, if two edges come before it runs. An interrupt can see an edge twice, if a slow edge
 * bounces. These rules keep a wrong width from being measured:
 *
 * | edge | line was | rule |
 * |---|---|---|
 * | rise | high, for at most `same_us` | The edge is the same rise again. The time of the first one counts. |
 * | rise | high, for longer | A fall was missed. The pulse is discarded up to the next fall, and `missed` counts it. |
 * | fall | low | The edge is the same fall again, or a rise was missed. There is no pulse. |
 *
 * A pulse shorter than `same_us` within a bounce is not seen. A pulse that began before `arm` never counts, however
 * long it lasts. A pulse whose last edge was missed lasts until the next edge.
 *
 * Widths are correct up to 71 minutes, also across the wrap of the clock. If the clock was set back by up to 100 ms
 * between the two edges, the width is 0, which is noise to pulse.h.
 *
 * No function waits. The row `a16_pwm_edges` of include/COST.md has the size of a driver with this file.
 *
 * @code
 * static fathom_edges_t edges;                              // the interrupt calls fathom_edges_feed()
 * static fathom_capture_t capture;                          // must stay valid as long as the driver
 * fathom_edges_init(&edges, &pin);
 * capture = fathom_edges_capture(&edges);
 * fathom_a16_pwm_init(&a16, &capture, &clock, &trigger, NULL);
 * @endcode
 *
 * No lock is needed, also on 8-bit machines. There is one writer (the interrupt, or several interrupts of one priority)
 * and one reader (the main loop) on one core. What both sides access is single bytes, which every machine reads and
 * writes whole.
 */

/** @brief Sizes and defaults. */
enum {
    FATHOM_EDGES_PULSES = 4, /**< Pulses that can wait to be taken. Later pulses are lost and counted. */
    FATHOM_EDGES_DEFAULT_SAME_US = 50 /**< Default of `same_us`. */
};

/** @brief A place in the ring of pulses. */
typedef struct {
    uint32_t width_us; /**< From its rising to its falling edge. */
    uint32_t end_us;   /**< Time of its falling edge. */
    bool is_full;      /**< A pulse waits here. Written last by either side. */
} fathom_edges_pulse_t;

/** @brief The state of one pin. The caller owns the memory; all members but `same_us` belong to the functions below. */
typedef struct {
    /* Written by the interrupt. */
    volatile fathom_edges_pulse_t pulses[FATHOM_EDGES_PULSES]; /**< The ring of pulses. */
    uint32_t rise_us;                                          /**< Time of the last rise, if `is_timed`. */
    volatile uint8_t lost;   /**< Pulses that found no free place; stops at 255. May be read. */
    volatile uint8_t missed; /**< Edges that must have been missed; stops at 255. May be read. */
    volatile bool is_high;   /**< Level after the last edge. */
    bool is_timed;           /**< A pulse is in progress and `rise_us` is the time of its rise. */
    uint8_t write_at;        /**< The place of the next pulse. */
    volatile bool
        was_armed; /**< `arm` was called since the last edge: set by the reader, reset by the interrupt. */

    /* Written by the reader. */
    uint8_t read_at;         /**< The place of the oldest pulse, if there is one. */
    const fathom_pin_t *pin; /**< NULL: the level is that of the last edge. */

    /** Time within which a second rise is the same rise, 0..65535 us. The caller may change it between
     * fathom_edges_init() and the start of the interrupt. */
    uint16_t same_us;
} fathom_edges_t;

/**
 * @brief Initialises the state of a pin. Call it before the interrupt is enabled.
 * @param edges  The memory; must stay valid while the interrupt is enabled.
 * @param pin    A pin whose `get` reads the level at any time; must stay valid as long as `edges`. If `pin` is NULL, or
 *               has no `get`, the line counts as low until the first edge, and later as the last edge left it.
 */
void fathom_edges_init(fathom_edges_t *edges, const fathom_pin_t *pin);

/**
 * @brief Stores an edge. Call it from the interrupt.
 *
 * @param edges    The state of the pin.
 * @param high     The level after the edge. For an interrupt on both edges: the level that the pin has when it is read.
 * @param time_us  Time of the edge, by the clock of the HAL or a counter that agrees with it.
 */
void fathom_edges_feed(fathom_edges_t *edges, bool high, uint32_t time_us);

/** @brief Returns the capture for fathom_a16_pwm_init(). Its functions must be called from the main loop only. */
fathom_capture_t fathom_edges_capture(fathom_edges_t *edges);

/** @brief Returns true if the next pulse would find no free place. For the writer. */
static inline bool fathom_edges_is_full(const fathom_edges_t *edges)
{
    return edges->pulses[edges->write_at].is_full;
}

#ifdef __cplusplus
}
#endif

#endif
