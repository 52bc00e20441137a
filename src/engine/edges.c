/* SPDX-License-Identifier: MIT */
#include "fathom/engine/edges.h"

#include "../common.h"

/*
 * Pulses from the edges of a pin. The interrupt writes pulses into a ring, and the main loop takes them out:
 *
 *   pulses   [ full ][ full ][ free ][ free ]
 *               ^               ^
 *            read_at         write_at
 *
 * Invariant: the interrupt writes to a free place only, and the main loop reads and frees full places only. `is_full`
 * is the last member of a place that either side writes, so neither side sees a half of a pulse.
 */

static uint8_t next_place(uint8_t at) { return (at == (FATHOM_EDGES_PULSES - 1)) ? 0u : (uint8_t)(at + 1u); }

static void count(volatile uint8_t *counter)
{
    const uint8_t value = *counter;
    if (value != UINT8_MAX) *counter = (uint8_t)(value + 1u);
}

/* ---- In the interrupt ---- */

static void rise(fathom_edges_t *edges, uint32_t time_us)
{
    if (!edges->is_high) {
        edges->rise_us = time_us;
        edges->is_timed = true;
        edges->is_high = true;
    } else if (edges->is_timed && (time_since_us(time_us, edges->rise_us) > edges->same_us)) {
        edges->is_timed = false;
        count(&edges->missed);
    }
}

static void fall(fathom_edges_t *edges, uint32_t time_us)
{
    const uint8_t write_at = edges->write_at;
    volatile fathom_edges_pulse_t *const place = &edges->pulses[write_at];
    const bool is_pulse = edges->is_timed;
    edges->is_high = false;
    edges->is_timed = false;
    if (!is_pulse) return;
    if (place->is_full) {
        count(&edges->lost);
        return;
    }
    place->width_us = time_since_us(time_us, edges->rise_us);
    place->end_us = time_us;
    place->is_full = true;
    edges->write_at = next_place(write_at);
}

void fathom_edges_feed(fathom_edges_t *edges, bool high, uint32_t time_us)
{
    /* A pulse that is high now began before arm(). */
    if (edges->was_armed) edges->is_timed = false;
    edges->was_armed = false;
    if (high)
        rise(edges, time_us);
    else
        fall(edges, time_us);
}

/* ---- In the main loop ---- */

static void free_place(fathom_edges_t *edges)
{
    const uint8_t read_at = edges->read_at;
    edges->pulses[read_at].is_full = false;
    edges->read_at = next_place(read_at);
}

static void arm(void *ctx)
{
    fathom_edges_t *const edges = ctx;
    /* First: a pulse that ends from here on began after arm(), or is void. All older pulses are in the ring. */
    edges->was_armed = true;
    for (uint8_t left = FATHOM_EDGES_PULSES; (left != 0u) && edges->pulses[edges->read_at].is_full; left--)
        free_place(edges);
}

static int take(void *ctx, fathom_pulse_t *pulse)
{
    fathom_edges_t *const edges = ctx;
    const fathom_pin_t *const pin = edges->pin;
    const volatile fathom_edges_pulse_t *const place = &edges->pulses[edges->read_at];
    pulse->is_high = (pin != NULL) ? pin->get(pin->ctx) : edges->is_high;
    if (!place->is_full) return 0;
    pulse->width_us = place->width_us;
    pulse->end_us = place->end_us;
    free_place(edges);
    return 1;
}

void fathom_edges_init(fathom_edges_t *edges, const fathom_pin_t *pin)
{
    clear(edges, sizeof *edges);
    edges->same_us = FATHOM_EDGES_DEFAULT_SAME_US;
    if ((pin == NULL) || (pin->get == NULL)) return;
    edges->pin = pin;
    edges->is_high = pin->get(pin->ctx);
}

fathom_capture_t fathom_edges_capture(fathom_edges_t *edges)
{
    fathom_capture_t capture;
    capture.arm = arm;
    capture.take = take;
    capture.ctx = edges;
    return capture;
}
