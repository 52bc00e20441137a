/* SPDX-License-Identifier: MIT */
/*
 * Any edges at any times, taken and armed at any time. The interrupt may come between any two accesses of the main loop:
 * what both share is volatile, which EVA reads as any value each time, whatever was written.
 *
 * proves: src/engine/edges.c
 * volatile: kept
 */
#include "fathom/engine/edges.h"
#include "assumptions.h"

static void any_edges(const fathom_pin_t *pin)
{
    static fathom_edges_t edges;
    fathom_pulse_t pulse;
    fathom_edges_init(&edges, pin);
    /* fathom_edges_init() writes zeros through a volatile pointer, after which EVA knows none of the members. */
    edges.read_at = 0;
    edges.write_at = 0;
    edges.is_timed = false;
    edges.pin =
        (pin == &assumed_output) ? NULL : pin; /* fathom_edges_init() does not keep a pin without `get`. */
    edges.same_us = any_16();
    const fathom_capture_t capture = fathom_edges_capture(&edges);
    while (any_bool()) {
        if (any_bool()) fathom_edges_feed(&edges, any_bool(), any_32());
        if (any_bool()) capture.arm(capture.ctx);
        (void)capture.take(capture.ctx, &pulse);
    }
}

int main(void)
{
    any_edges(NULL);
    any_edges(&assumed_output);
    any_edges(&assumed_input);
    return 0;
}
