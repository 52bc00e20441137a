/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_SIM_BENCH_H
#define FATHOM_TESTS_SIM_BENCH_H

/* What the tests of the simulator share: a host at the near end of a line, which notes each byte and the
 * time of its last bit. No codec here: frames are literal bytes, from the datasheets where they print them. */

#include "suite.h"
#include <stdint.h>

#include "sim/sim.h"

typedef struct {
    fathom_sim_line_t line;
    uint32_t now_us;
    size_t heard; /* bytes since the last bench_forget */
    uint8_t bytes[4096];
    uint32_t end_us[4096];
} bench_t;

static const fathom_line_settings_t bench_9600 = {9600, FATHOM_PARITY_NONE, 1};
static const fathom_line_settings_t bench_19200 = {19200, FATHOM_PARITY_EVEN, 1};

/* Every test runs at each of these: nothing special, the wrap 1 s, 65 ms and 3 ms away, the sign bit. */
static const uint32_t bench_starts_us[] = {0, UINT32_C(0xFFF0BDC0), UINT32_C(0xFFFF0000),
                                           UINT32_C(0xFFFFF448), UINT32_C(0x7FFFF000)};
enum { BENCH_STARTS = sizeof bench_starts_us / sizeof bench_starts_us[0] };
static uint32_t bench_start_us;

static inline void bench_init(bench_t *bench, const fathom_line_settings_t *settings)
{
    bench->now_us = bench_start_us;
    bench->heard = 0;
    fathom_sim_line_init(&bench->line, settings, bench->now_us);
}

static inline void bench_attach(bench_t *bench, fathom_sim_device_t *device)
{
    fathom_sim_attach(&bench->line, device, bench->now_us);
}

static inline void bench_forget(bench_t *bench) { bench->heard = 0; }

static inline void bench_collect(bench_t *bench)
{
    for (;;) {
        fathom_rx_t rx = {0, 0};
        uint8_t byte;
        if (fathom_sim_transmit_timed(&bench->line, bench->now_us, &byte, 1, FATHOM_RX_TIMED, &rx) == 0)
            return;
        assert_true(bench->heard < sizeof bench->bytes);
        bench->end_us[bench->heard] = rx.last_us;
        bench->bytes[bench->heard++] = byte;
    }
}

/* Lets time pass in one jump. */
static inline void bench_wait(bench_t *bench, uint32_t by_us)
{
    bench->now_us += by_us;
    bench_collect(bench);
}

/* Returns when the last bit will have left. */
static inline uint32_t bench_say(bench_t *bench, const uint8_t *bytes, size_t count)
{
    assert_int_equal(fathom_sim_receive(&bench->line, bytes, count, bench->now_us), count);
    return bench->now_us + fathom_sim_span_us(&bench->line.settings, (uint16_t)count);
}

/* Says it, then waits until `by_us` after its last bit. */
static inline uint32_t bench_ask(bench_t *bench, const uint8_t *bytes, size_t count, uint32_t by_us)
{
    const uint32_t end_us = bench_say(bench, bytes, count);
    bench_wait(bench, fathom_elapsed_us(end_us, bench->now_us) + by_us);
    return end_us;
}

static inline void bench_expect(bench_t *bench, const uint8_t *bytes, size_t count)
{
    assert_int_equal(bench->heard, count);
    assert_memory_equal(bench->bytes, bytes, count);
    bench_forget(bench);
}

#define LITERAL(...)           (const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__})
#define SAY(bench, ...)        bench_say((bench), LITERAL(__VA_ARGS__))
#define ASK(bench, by_us, ...) bench_ask((bench), LITERAL(__VA_ARGS__), (by_us))
#define EXPECT(bench, ...)     bench_expect((bench), LITERAL(__VA_ARGS__))
#define EXPECT_SILENCE(bench)  assert_int_equal((bench)->heard, 0)

/* a <= span <= b, where span may have wrapped */
#define ASSERT_SPAN(later_us, earlier_us, from_us, to_us)                                                    \
    assert_in_range(fathom_elapsed_us((later_us), (earlier_us)), (from_us), (to_us))

/* Every test at every start. */
static inline void bench_begin_round(unsigned round) { bench_start_us = bench_starts_us[round]; }

#define BENCH_ROUNDS .begin_round = bench_begin_round, .rounds = BENCH_STARTS

#endif
