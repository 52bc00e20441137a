/* SPDX-License-Identifier: MIT */
#include "fathom/engine/edges.h"

/* Rises since arm that are told from those before it: half of what a byte can count. */
enum { MAX_RISES = 128 };

static void count(volatile uint8_t *counter)
{
    const uint8_t value = *counter;
    if (value != UINT8_MAX) *counter = (uint8_t)(value + 1u);
}

static bool is_high(const fathom_edges_t *edges)
{
    return (edges->pin != NULL) ? edges->pin->get(edges->pin->ctx) : (edges->high != 0u);
}

/* ---- in the interrupt ---- */

static void rise(fathom_edges_t *edges, uint32_t time_us)
{
    if (edges->high == 0u) {
        edges->rise_us = time_us;
        edges->timed = true;
        edges->high = 1;
        edges->rises = (uint8_t)(edges->rises + 1u);
    } else if (edges->timed && (fathom_elapsed_us(time_us, edges->rise_us) > edges->same_us)) {
        edges->timed = false;
        count(&edges->missed);
    }
}

static void fall(fathom_edges_t *edges, uint32_t time_us)
{
    const uint8_t written = edges->written;
    const bool is_pulse = edges->timed;
    edges->high = 0;
    edges->timed = false;
    if (!is_pulse) return;
    if ((uint8_t)(written - edges->taken) == FATHOM_EDGES_PULSES) {
        count(&edges->lost);
        return;
    }
    const uint8_t at = written % FATHOM_EDGES_PULSES;
    edges->pulses[at].width_us = fathom_elapsed_us(time_us, edges->rise_us);
    edges->pulses[at].end_us = time_us;
    edges->pulses[at].rise = edges->rises;
    edges->written = (uint8_t)(written + 1u);
}

void fathom_edges_feed(fathom_edges_t *edges, bool high, uint32_t time_us)
{
    if (high)
        rise(edges, time_us);
    else
        fall(edges, time_us);
}

/* ---- in the main loop ---- */

static void arm(void *ctx)
{
    fathom_edges_t *const edges = ctx;
    edges->armed = edges->rises;
    edges->taken = edges->written;
}

static int take(void *ctx, fathom_pulse_t *pulse)
{
    fathom_edges_t *const edges = ctx;
    uint8_t taken = edges->taken;
    pulse->is_high = is_high(edges);
    while (taken != edges->written) {
        const uint8_t at = taken % FATHOM_EDGES_PULSES;
        const uint8_t since = (uint8_t)(edges->pulses[at].rise - edges->armed);
        const bool is_new = (since != 0u) && (since < MAX_RISES);
        if (is_new) {
            pulse->width_us = edges->pulses[at].width_us;
            pulse->end_us = edges->pulses[at].end_us;
        }
        taken++;
        edges->taken = taken;
        if (is_new) return 1;
    }
    return 0;
}

void fathom_edges_init(fathom_edges_t *edges, const fathom_pin_t *pin)
{
    edges->rise_us = 0;
    edges->written = 0;
    edges->rises = 0;
    edges->lost = 0;
    edges->missed = 0;
    edges->timed = false;
    edges->pin = pin;
    edges->taken = 0;
    edges->armed = 0;
    edges->same_us = FATHOM_EDGES_DEFAULT_SAME_US;
    edges->high = (pin != NULL) && pin->get(pin->ctx);
}

fathom_capture_t fathom_edges_capture(fathom_edges_t *edges)
{
    fathom_capture_t capture;
    capture.arm = arm;
    capture.take = take;
    capture.ctx = edges;
    return capture;
}
