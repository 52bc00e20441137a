/* SPDX-License-Identifier: MIT */
#include "bench.h"

#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/hps167s.h"
#include "sim/scene.h"
#include "sim/uart.h"

enum { MS = 1000 };

/* An application's three ports on a desk. */
typedef struct {
    fathom_sim_clock_t clock;
    fathom_sim_line_t lines[3];
    fathom_sim_uart_t uarts[3];
    fathom_sim_fixed_t fixed[3];
    fathom_sim_a16_t a16;
    fathom_sim_a05_t a05;
    fathom_sim_hps167s_t hps;
} desk_t;

static void set(desk_t *desk, uint32_t step_us)
{
    static const fathom_sim_fixed_t fixed[3] = {
        {{1953, 0, 0, 0}}, {{1000, 2000, 1953, 3562}}, {{2083, 0, 0, 0}}};
    fathom_sim_clock_init(&desk->clock, bench_start_us, step_us);
    for (size_t i = 0; i < 3; i++) {
        fathom_sim_line_init(&desk->lines[i], i == 2 ? &bench_19200 : &bench_9600, desk->clock.now_us);
        desk->lines[i].full_duplex = i != 2;
        fathom_sim_uart_init(&desk->uarts[i], &desk->lines[i], &desk->clock);
        desk->fixed[i] = fixed[i];
    }
    const fathom_sim_a16_config_t a16 = {.mode = FATHOM_SIM_A16_AUTO,
                                         .scene = fathom_sim_fixed(&desk->fixed[0])};
    const fathom_sim_a05_config_t a05 = {.mode = FATHOM_SIM_A05_AUTO,
                                         .scene = fathom_sim_fixed(&desk->fixed[1])};
    const fathom_sim_hps167s_config_t hps = {.scene = fathom_sim_fixed(&desk->fixed[2])};
    fathom_sim_a16_init(&desk->a16, &a16);
    fathom_sim_a05_init(&desk->a05, &a05);
    fathom_sim_hps167s_init(&desk->hps, &hps);
    fathom_sim_attach(&desk->lines[0], &desk->a16.device, desk->clock.now_us);
    fathom_sim_attach(&desk->lines[1], &desk->a05.device, desk->clock.now_us);
    fathom_sim_attach(&desk->lines[2], &desk->hps.device, desk->clock.now_us);
}

static const uint8_t measure[] = {0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB};
static const uint8_t measured[] = {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2,
                                   0x07, 0x01, 0x00, 0x00, 0xFD, 0x41};

static const suite_t suite = {BENCH_ROUNDS};

TEST(write_takes_all_or_nothing_and_sent_tells_when)
{
    desk_t d;
    set(&d, 0);
    const fathom_uart_t uart = fathom_sim_uart(&d.uarts[2]);
    assert_true(uart.sent(uart.ctx));
    assert_int_equal(uart.write(uart.ctx, measure, 8), 8);
    assert_false(uart.sent(uart.ctx));
    assert_int_equal(uart.write(uart.ctx, measure, 8), 0); /* busy */
    fathom_sim_clock_advance(&d.clock, 4583);              /* 8 characters of 11 bits at 19200: 4583.3 us */
    assert_false(uart.sent(uart.ctx));
    assert_int_equal(uart.write(uart.ctx, measure, 1), 0);
    fathom_sim_clock_advance(&d.clock, 1);
    assert_true(uart.sent(uart.ctx));
    assert_int_equal(d.lines[2].counters.from_host, 8);
}

TEST(read_gives_only_what_has_arrived_and_when)
{
    fathom_rx_t rx = {0, 0};
    uint8_t bytes[32];
    desk_t d;
    set(&d, 0);
    const fathom_uart_t uart = fathom_sim_uart(&d.uarts[0]);
    fathom_sim_clock_advance(&d.clock, 102 * MS);
    assert_int_equal(uart.read(uart.ctx, bytes, sizeof bytes, &rx), 1);
    assert_int_equal(bytes[0], 0xFF);
    assert_int_equal(rx.flags, FATHOM_RX_TIMED | FATHOM_RX_SILENCE);
    assert_int_equal(fathom_elapsed_us(rx.last_us, bench_start_us), 100 * MS + 1042);
    rx.flags = 0;
    assert_int_equal(uart.read(uart.ctx, bytes, sizeof bytes, &rx), 0);
    assert_int_equal(rx.flags, 0);
    fathom_sim_clock_advance(&d.clock, 3 * MS);
    assert_int_equal(uart.read(uart.ctx, bytes, sizeof bytes, &rx), 3);
    assert_int_equal(rx.flags, FATHOM_RX_TIMED);
    assert_memory_equal(bytes, ((const uint8_t[]){0x07, 0xA1, 0xA7}), 3); /* A16 2(4) */
}

TEST(a_port_may_know_nothing)
{
    fathom_rx_t rx = {0, 0};
    uint8_t bytes[32];
    desk_t d;
    set(&d, 0);
    d.uarts[0].knows = 0;
    const fathom_uart_t uart = fathom_sim_uart(&d.uarts[0]);
    fathom_sim_clock_advance(&d.clock, 250 * MS);
    assert_int_equal(uart.read(uart.ctx, bytes, sizeof bytes, &rx), 8); /* spans a silence it cannot see */
    assert_int_equal(rx.flags, 0);
}

/* The README's loop: it polls, and each look at the clock is a little later. */
TEST(a_bare_polling_loop_hears_all_three_sensors)
{
    desk_t d;
    size_t heard[3] = {0, 0, 0};
    uint8_t last[3][32];
    uint32_t looks = 0;
    set(&d, 50);
    const fathom_clock_t clock = fathom_sim_clock(&d.clock);
    fathom_uart_t uarts[3];
    for (size_t i = 0; i < 3; i++) uarts[i] = fathom_sim_uart(&d.uarts[i]);
    assert_int_equal(uarts[2].write(uarts[2].ctx, measure, 8), 8);
    const uint32_t begin_us = clock.now_us(clock.ctx);
    while (fathom_elapsed_us(clock.now_us(clock.ctx), begin_us) < 320 * MS) {
        looks++;
        for (size_t i = 0; i < 3; i++) {
            fathom_rx_t rx = {0, 0};
            uint8_t byte;
            if (uarts[i].read(uarts[i].ctx, &byte, 1, &rx) == 1) last[i][heard[i]++] = byte;
        }
    }
    assert_in_range(looks, 6395, 6401); /* 320 ms / 50 us: deterministic */
    assert_int_equal(heard[0], 12);
    assert_memory_equal(last[0], ((const uint8_t[]){0xFF, 0x07, 0xA1, 0xA7}), 4);
    assert_int_equal(heard[1], 10);
    assert_memory_equal(last[1],
                        ((const uint8_t[]){0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x60}), 10);
    assert_int_equal(heard[2], 13);
    assert_memory_equal(last[2], measured, 13);
}

/* A blocking wait: poll, and idle when there is nothing. */
TEST(an_idle_hook_leads_through_an_exchange_in_few_steps)
{
    uint8_t bytes[32];
    size_t heard = 0;
    int idles = 0;
    desk_t d;
    set(&d, 0);
    const fathom_clock_t clock = fathom_sim_clock(&d.clock);
    const fathom_uart_t uart = fathom_sim_uart(&d.uarts[2]);
    assert_int_equal(uart.write(uart.ctx, measure, 8), 8);
    while (heard < 13) {
        fathom_rx_t rx = {0, 0};
        heard += (size_t)uart.read(uart.ctx, bytes + heard, sizeof bytes - heard, &rx);
        fathom_sim_clock_idle(&d.clock, 500 * MS);
        idles++;
        assert_true(idles < 50);
    }
    assert_memory_equal(bytes, measured, 13);
    assert_in_range(fathom_elapsed_us(clock.now_us(clock.ctx), bench_start_us), 14 * MS, 100 * MS);
}

TEST(idle_goes_no_further_than_it_may)
{
    desk_t d;
    set(&d, 0);
    fathom_sim_clock_idle(&d.clock, 30 * MS);
    assert_int_equal(fathom_elapsed_us(d.clock.now_us, bench_start_us), 30 * MS);
    fathom_sim_clock_idle(&d.clock, 0);
    assert_int_equal(fathom_elapsed_us(d.clock.now_us, bench_start_us), 30 * MS);
    fathom_sim_clock_idle(&d.clock, 500 * MS); /* the A16's frame is due before that */
    assert_int_equal(fathom_elapsed_us(d.clock.now_us, bench_start_us), 100 * MS);
    fathom_sim_clock_idle(&d.clock, FATHOM_NO_DEADLINE); /* its first byte */
    assert_int_equal(fathom_elapsed_us(d.clock.now_us, bench_start_us), 100 * MS + 1042);
}

TEST(idle_with_nothing_to_come_moves_a_second)
{
    fathom_sim_clock_t clock;
    fathom_sim_clock_init(&clock, bench_start_us, 0);
    fathom_sim_clock_idle(&clock, FATHOM_NO_DEADLINE);
    assert_int_equal(fathom_elapsed_us(clock.now_us, bench_start_us), 1000 * MS);
}

TEST(any_advance_is_lived_through)
{
    desk_t d;
    set(&d, 0);
    fathom_sim_clock_advance(&d.clock, UINT32_C(4200000000)); /* 70 minutes at once */
    assert_int_equal(fathom_elapsed_us(d.clock.now_us, bench_start_us), UINT32_C(4200000000));
    assert_int_equal(d.a16.device.counters.automatic, 42000);
    assert_int_equal(d.a05.device.counters.automatic, 14000);
}

TEST(a_line_that_nobody_polls_keeps_up_with_a_stepping_clock)
{
    desk_t d;
    set(&d, 100 * MS);
    const fathom_clock_t clock = fathom_sim_clock(&d.clock);
    for (int i = 0; i < 60000; i++) (void)clock.now_us(clock.ctx); /* 100 minutes */
    fathom_sim_clock_advance(&d.clock, 0);
    assert_int_equal(d.a16.device.counters.automatic, 60000);
    set(&d, UINT32_C(2000000000));
    const fathom_clock_t leaps = fathom_sim_clock(&d.clock);
    (void)leaps.now_us(leaps.ctx);
    (void)leaps.now_us(leaps.ctx);
    assert_int_equal(d.a16.device.counters.automatic, 40000);
}

TEST(two_uarts_on_one_line_are_one_line_on_the_clock)
{
    fathom_sim_uart_t again;
    desk_t d;
    set(&d, 0);
    for (size_t i = 0; i < 3; i++) fathom_sim_uart_init(&again, &d.lines[i], &d.clock);
    size_t lines = 0;
    for (const fathom_sim_line_t *at = d.clock.lines; at != NULL; at = at->next) {
        lines++;
        assert_true(lines <= 3);
    }
    assert_int_equal(lines, 3);
}
