/* SPDX-License-Identifier: MIT */
#include "stage.h"

/* An application's three ports on a desk: an A16 and an A05 that send, an HPS-167S that is asked. */
static fathom_sim_clock_t desk_clock;
static fathom_clock_t hal_clock;
static fathom_sim_line_t lines[3];
static fathom_sim_uart_t ports[3];
static fathom_uart_t uarts[3];

static void set(uint32_t step_us)
{
    fathom_sim_clock_init(&desk_clock, bench_start_us, step_us);
    hal_clock = fathom_sim_clock(&desk_clock);
    static fathom_sim_fixed_t wall = {{1953, 0, 0, 0}};
    bench.fixed = FIXED(1000, 2000, 1953, 3562);
    bench.processed = FIXED(2083); /* of the HPS-167S */
    for (size_t i = 0; i < 3; i++) {
        bench_begin(i == 2 ? &bench_19200 : &bench_9600, i != 2);
        lines[i] = bench.line;
        fathom_sim_uart_init(&ports[i], &lines[i], &desk_clock);
        uarts[i] = fathom_sim_uart(&ports[i]);
    }
    fathom_sim_a16_init(&bench.a16,
                        &(a16_config_t){.mode = FATHOM_SIM_A16_AUTO, .scene = fathom_sim_fixed(&wall)});
    fathom_sim_a05_init(
        &bench.a05, &(a05_config_t){.mode = FATHOM_SIM_A05_AUTO, .scene = fathom_sim_fixed(&bench.fixed)});
    fathom_sim_hps167s_init(&bench.hps, &(hps_config_t){.scene = PROCESSED});
    fathom_sim_attach(&lines[0], &bench.a16.device, desk_clock.now_us);
    fathom_sim_attach(&lines[1], &bench.a05.device, desk_clock.now_us);
    fathom_sim_attach(&lines[2], &bench.hps.device, desk_clock.now_us);
}

static const uint8_t request[] = {0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB};
#define MEASURED "01 03 08 08 23 DC B2 07 01 00 00 FD 41"

static fathom_rx_t rx; /* of the last read */
static uint8_t bytes[32];

static int read_from(unsigned port, size_t capacity)
{
    rx = (fathom_rx_t){0, 0};
    return uarts[port].read(uarts[port].ctx, bytes, capacity, &rx);
}
static int write_to_hps(size_t count) { return uarts[2].write(uarts[2].ctx, request, count); }
static bool hps_sent(void) { return uarts[2].sent(uarts[2].ctx); }
static uint32_t hps_leaves_in_us(void) { return uarts[2].leaves_in_us(uarts[2].ctx); }

/* Two starts: the long runs pass every wrap anyhow. */
EACH_BEGINS(set(0))
static const suite_t suite = {BENCH_TWO_ROUNDS, .set_up = begins};

TEST(write_takes_all_or_nothing_and_sent_tells_when)
{
    assert_true(hps_sent());
    assert_int_equal(hps_leaves_in_us(), 0);
    assert_int_equal(write_to_hps(8), 8);
    assert_false(hps_sent());
    assert_int_equal(hps_leaves_in_us(), 4584);
    assert_int_equal(write_to_hps(8), 0);        /* busy */
    fathom_sim_clock_advance(&desk_clock, 4583); /* 8 characters of 11 bits at 19200: 4583.3 us */
    assert_false(hps_sent());
    assert_int_equal(hps_leaves_in_us(), 1);
    assert_int_equal(write_to_hps(1), 0);
    fathom_sim_clock_advance(&desk_clock, 1);
    assert_true(hps_sent());
    assert_int_equal(hps_leaves_in_us(), 0);
    assert_int_equal(lines[2].counters.from_host, 8);
}

static int set_hps_line(uint32_t baud, uint8_t parity, uint8_t stop_bits)
{
    const fathom_line_settings_t settings = {baud, parity, stop_bits};
    return uarts[2].set_line(uarts[2].ctx, &settings);
}

TEST(settings_that_no_line_has_are_refused_and_those_before_hold)
{
    static const fathom_line_settings_t wrong[] = {
        {0, FATHOM_PARITY_EVEN, 1},          {1199, FATHOM_PARITY_EVEN, 1}, {1000001, FATHOM_PARITY_EVEN, 1},
        {UINT32_MAX, FATHOM_PARITY_EVEN, 1}, {57600, 3 /* none such */, 1}, {57600, FATHOM_PARITY_EVEN, 0},
        {57600, FATHOM_PARITY_EVEN, 3}};
    assert_int_equal(write_to_hps(8), 8); /* refused at once, also while bytes leave */
    for (size_t i = 0; i != sizeof wrong / sizeof wrong[0]; i++)
        assert_int_equal(set_hps_line(wrong[i].baud, wrong[i].parity, wrong[i].stop_bits), -1);
    assert_int_equal(set_hps_line(57600, FATHOM_PARITY_NONE, 2), 0);
    assert_int_equal(hps_leaves_in_us(), 4584); /* 8 characters of 11 bits at 19200 baud */
    fathom_sim_clock_advance(&desk_clock, 4584);
    assert_int_equal(set_hps_line(1199, FATHOM_PARITY_NONE, 1), -1);
    assert_int_equal(write_to_hps(8), 8);
    assert_int_equal(hps_leaves_in_us(), 4584);
    fathom_sim_clock_advance(&desk_clock, 4584);
    assert_int_equal(set_hps_line(1200, FATHOM_PARITY_ODD, 2), 1);
    assert_int_equal(write_to_hps(8), 8);
    assert_int_equal(hps_leaves_in_us(), 80000); /* 8 * 12 bits */
    fathom_sim_clock_advance(&desk_clock, 80000);
    assert_int_equal(set_hps_line(1000000, FATHOM_PARITY_NONE, 1), 1);
    assert_int_equal(write_to_hps(8), 8);
    assert_int_equal(hps_leaves_in_us(), 80); /* 8 * 10 bits */
}

TEST(read_gives_only_what_has_arrived_and_when)
{
    fathom_sim_clock_advance(&desk_clock, 102 * MS);
    assert_int_equal(read_from(0, sizeof bytes), 1);
    assert_int_equal(bytes[0], 0xFF);
    assert_int_equal(rx.flags, FATHOM_RX_TIMED | FATHOM_RX_SILENCE);
    assert_int_equal(fathom_elapsed_us(rx.last_us, bench_start_us), 100 * MS + 1042);
    assert_int_equal(read_from(0, sizeof bytes), 0);
    assert_int_equal(rx.flags, 0);
    fathom_sim_clock_advance(&desk_clock, 3 * MS);
    assert_int_equal(read_from(0, sizeof bytes), 3);
    assert_int_equal(rx.flags, FATHOM_RX_TIMED);
    assert_true(is_hex(bytes, "07 A1 A7")); /* A16 2(4) */
}

TEST(a_port_may_know_nothing)
{
    ports[0].knows = 0;
    fathom_sim_clock_advance(&desk_clock, 250 * MS);
    assert_int_equal(read_from(0, sizeof bytes), 8); /* spans a silence it cannot see */
    assert_int_equal(rx.flags, 0);
}

/* The README's loop: it polls, and each look at the clock is a little later. */
TEST(a_bare_polling_loop_hears_all_three_sensors)
{
    size_t heard[3] = {0, 0, 0};
    uint8_t last[3][32];
    uint32_t looks = 0;
    set(50);
    assert_int_equal(write_to_hps(8), 8);
    const uint32_t begin_us = hal_clock.now_us(hal_clock.ctx);
    while (fathom_elapsed_us(hal_clock.now_us(hal_clock.ctx), begin_us) < 320 * MS) {
        looks++;
        for (unsigned i = 0; i < 3; i++) {
            if (read_from(i, 1) == 1) last[i][heard[i]++] = bytes[0];
        }
    }
    assert_in_range(looks, 6395, 6401); /* 320 ms / 50 us: deterministic */
    assert_int_equal(heard[0], 12);
    assert_true(is_hex(last[0], "FF 07 A1 A7"));
    assert_int_equal(heard[1], 10);
    assert_true(is_hex(last[1], "FF 03 E8 07 D0 07 A1 0D EA 60"));
    assert_int_equal(heard[2], 13);
    assert_true(is_hex(last[2], MEASURED));
}

/* A blocking wait: poll, and idle when there is nothing. */
TEST(an_idle_hook_leads_through_a_transaction_in_few_steps)
{
    uint8_t response[32];
    size_t heard = 0;
    int idles = 0;
    assert_int_equal(write_to_hps(8), 8);
    while (heard < 13) {
        const size_t count = (size_t)read_from(2, sizeof response - heard);
        memcpy(response + heard, bytes, count);
        heard += count;
        fathom_sim_clock_idle(&desk_clock, 500 * MS);
        idles++;
        assert_true(idles < 50);
    }
    assert_true(is_hex(response, MEASURED));
    assert_in_range(fathom_elapsed_us(hal_clock.now_us(hal_clock.ctx), bench_start_us), 14 * MS, 100 * MS);
}

TEST(idle_goes_no_further_than_it_may)
{
    fathom_sim_clock_idle(&desk_clock, 30 * MS);
    assert_int_equal(fathom_elapsed_us(desk_clock.now_us, bench_start_us), 30 * MS);
    fathom_sim_clock_idle(&desk_clock, 0);
    assert_int_equal(fathom_elapsed_us(desk_clock.now_us, bench_start_us), 30 * MS);
    fathom_sim_clock_idle(&desk_clock, 500 * MS); /* the A16's frame is due before that */
    assert_int_equal(fathom_elapsed_us(desk_clock.now_us, bench_start_us), 100 * MS);
    fathom_sim_clock_idle(&desk_clock, FATHOM_NO_DEADLINE); /* its first byte */
    assert_int_equal(fathom_elapsed_us(desk_clock.now_us, bench_start_us), 100 * MS + 1042);
}

TEST(idle_with_nothing_to_come_moves_a_second)
{
    fathom_sim_clock_init(&desk_clock, bench_start_us, 0);
    fathom_sim_clock_idle(&desk_clock, FATHOM_NO_DEADLINE);
    assert_int_equal(fathom_elapsed_us(desk_clock.now_us, bench_start_us), 1000 * MS);
}

TEST(any_advance_is_lived_through)
{
    fathom_sim_clock_advance(&desk_clock, UINT32_C(4200000000)); /* 70 minutes at once */
    assert_int_equal(fathom_elapsed_us(desk_clock.now_us, bench_start_us), UINT32_C(4200000000));
    assert_int_equal(bench.a16.device.counters.automatic, 42000);
    assert_int_equal(bench.a05.device.counters.automatic, 14000);
}

TEST(a_line_that_is_not_polled_keeps_up_with_a_stepping_clock)
{
    set(100 * MS);
    for (int i = 0; i < 60000; i++) (void)hal_clock.now_us(hal_clock.ctx); /* 100 minutes */
    fathom_sim_clock_advance(&desk_clock, 0);
    assert_int_equal(bench.a16.device.counters.automatic, 60000);
    set(UINT32_C(2000000000));
    (void)hal_clock.now_us(hal_clock.ctx);
    (void)hal_clock.now_us(hal_clock.ctx);
    assert_int_equal(bench.a16.device.counters.automatic, 40000);
}

TEST(two_uarts_on_one_line_are_one_line_on_the_clock)
{
    fathom_sim_uart_t again;
    for (size_t i = 0; i < 3; i++) fathom_sim_uart_init(&again, &lines[i], &desk_clock);
    size_t count = 0;
    for (const fathom_sim_line_t *at = desk_clock.lines; at != NULL; at = at->next) {
        count++;
        assert_true(count <= 3);
    }
    assert_int_equal(count, 3);
}
