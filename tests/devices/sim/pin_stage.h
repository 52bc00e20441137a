/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_SIM_PIN_STAGE_H
#define FATHOM_TESTS_SIM_PIN_STAGE_H

/* A simulated module with a level on its TX pin, seen at the pin and on the wire. */

#include "stage.h"

enum { MAX_EDGES = 64 };
static unsigned edges;
static bool edge_high[MAX_EDGES];
static uint32_t edge_us[MAX_EDGES];

static inline void on_edge(void *ctx, bool high, uint32_t time_us)
{
    assert_true(edges < MAX_EDGES);
    edge_high[edges] = high;
    edge_us[edges++] = time_us;
}

static inline void begin(int32_t mm)
{
    stage_begin(&bench_9600, true, 0);
    bench.fixed = FIXED(mm, mm, mm, mm);
    edges = 0;
}

static inline void take_pins(void)
{
    fathom_sim_pins_init(&s.pins, bench.device, &bench.line, &s.clock);
    s.pins.on_edge = on_edge;
}

static inline bool level(void)
{
    const fathom_pin_t pin = fathom_sim_tx_pin(&s.pins);
    return pin.get(pin.ctx);
}

/* Whether it is high when so much time has passed. */
static inline bool level_in(uint32_t by_us)
{
    pass_us(by_us);
    return level();
}

/* Has just that come to the host since the last look? Bytes that were marked: as in `marked`. */
static inline bool has_heard(const char *hex, uint32_t marked)
{
    uint8_t wanted[16];
    uint32_t flags = 0;
    forget();
    wait_us(0);
    for (size_t i = 0; i != bench.heard; i++) flags |= (bench.flags[i] != 0 ? UINT32_C(1) : 0) << i;
    return bench.heard == from_hex(hex, wanted, sizeof wanted) && is_hex(bench.bytes, hex) && flags == marked;
}

#endif
