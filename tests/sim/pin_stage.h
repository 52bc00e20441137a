/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_SIM_PIN_STAGE_H
#define FATHOM_TESTS_SIM_PIN_STAGE_H

/* A simulated module with a level on its TX pin, seen at the pin and on the wire. */

#include <string.h>

#include "bench.h"
#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/pin.h"
#include "sim/scene.h"

enum { MS = 1000 };

typedef struct {
    fathom_sim_clock_t clock;
    fathom_sim_line_t line;
    fathom_sim_fixed_t fixed;
    fathom_sim_a16_t a16;
    fathom_sim_a05_t a05;
    fathom_sim_pins_t pins;
    fathom_pin_t pin;
    unsigned edges;
    uint32_t edge_us;
} stage_t;

static inline void on_edge(void *ctx, bool high, uint32_t time_us)
{
    stage_t *const s = ctx;
    (void)high;
    s->edges++;
    s->edge_us = time_us;
}

static inline void attach(stage_t *s, fathom_sim_device_t *device)
{
    s->line.full_duplex = true;
    fathom_sim_attach(&s->line, device, s->clock.now_us);
    fathom_sim_pins_init(&s->pins, device, &s->line, &s->clock);
    s->pins.on_edge = on_edge;
    s->pins.on_edge_ctx = s;
    s->pin = fathom_sim_tx_pin(&s->pins);
}

static inline void begin(stage_t *s)
{
    memset(s, 0, sizeof *s);
    fathom_sim_clock_init(&s->clock, bench_start_us, 0);
    fathom_sim_line_init(&s->line, &bench_9600, bench_start_us);
}

static inline void wait(stage_t *s, uint32_t by_us) { fathom_sim_clock_advance(&s->clock, by_us); }

static inline bool level(const stage_t *s) { return s->pin.get(s->pin.ctx); }

static inline size_t receive(stage_t *s, uint8_t *bytes, uint8_t *bad)
{
    size_t count = 0;
    *bad = 0;
    for (;;) {
        fathom_rx_t rx = {0, 0};
        const size_t n = fathom_sim_transmit_timed(&s->line, s->clock.now_us, bytes + count, 1, 0xFF, &rx);
        if (n == 0) return count;
        if ((rx.flags & FATHOM_RX_FRAMING) != 0) *bad |= (uint8_t)(1u << count);
        count++;
    }
}

static inline void say(stage_t *s, const uint8_t *bytes, size_t count)
{
    assert_int_equal(fathom_sim_receive(&s->line, bytes, count, s->clock.now_us), count);
}

#endif
