/* SPDX-License-Identifier: MIT */
#include "pulse_rig.h"

static const suite_t suite = {.set_up = set_up_meter};

static void poll_after(uint32_t us)
{
    stand.fake.now_us += us;
    poll_meter();
}

/* ---- the trigger ---- */

TEST(the_pin_is_high_for_2_ms_then_low_for_2_ms_and_then_high)
{
    assert_true(stand.pin.level);
    stand.fake.now_us += 1999;
    expect_due(1);
    poll_meter();
    assert_true(stand.pin.level);
    stand.fake.now_us += 1;
    expect_due(0);
    poll_meter();
    assert_false(stand.pin.level);
    assert_int_equal(stand.pin.arms, 1);
    expect_due(2000);
    poll_after(1999);
    assert_false(stand.pin.level);
    poll_after(1);
    assert_true(stand.pin.level);
    expect_due(219 * MS);
}

TEST(the_low_time_is_an_option)
{
    stand.config.low_us = 30000;
    start_meter();
    run_meter(29900);
    expect_falls(0);
    run_meter(100);
    expect_falls(1);
    run_meter(100 * MS);
    assert_int_equal(stand.pin.low_us, 30000);
}

/* "This cycle period of the module must be greater than 220ms" (A16 1(2)) */
TEST(a_cycle_is_221_ms_from_edge_to_edge)
{
    response_with(110 * MS, 10 * MS);
    run_to_trigger();
    run_meter(220900);
    expect_falls(1);
    run_meter(100);
    expect_falls(2);
    run_meter(2210 * MS);
    expect_falls(12);
    assert_int_equal(stand.pin.least_us, 221 * MS);
    expect_readings(11);
}

TEST(a_longer_cycle_is_kept)
{
    stand.config.cycle_us = 500 * MS;
    start_meter();
    run_to_trigger();
    run_meter(2000 * MS);
    expect_falls(5);
    assert_int_equal(stand.pin.least_us, 500 * MS);
}

/* An interrupt holds the program up for 5 ms between its look at the clock and the edge, and not in the next cycle. */
TEST(the_cycle_counts_from_a_look_at_the_clock_after_the_edge)
{
    for (unsigned i = 0; i != 5; i++) {
        stand.pin.delay_us = 5 * MS;
        run_meter(2 * 221 * MS);
    }
    expect_falls(10);
    assert_int_equal(stand.pin.least_us, 221 * MS);
}

TEST(a_loop_of_300_ms_leaves_the_pin_high_for_2_ms_before_the_next_edge)
{
    response_with(110 * MS, 10 * MS);
    run_meter_in_steps(12000 * MS, 300 * MS);
    assert_true(stand.pin.falls >= 15);
    assert_int_equal(stand.pin.least_high_us, 300 * MS);
    expect_no_responses(0);
    start_meter();
    response_with(110 * MS, 10 * MS);
    for (unsigned i = 0; i != 100; i++) { /* in turn 300 ms and 500 us */
        poll_after(i % 2 != 0 ? 300 * MS : 500);
    }
    assert_true(stand.pin.falls >= 10);
    assert_in_range(stand.pin.least_high_us, 2 * MS, 301 * MS);
}

/* ---- loops and the clock ---- */

TEST(every_cycle_is_one_reading_in_loops_from_50_us_to_200_ms_and_across_the_wrap)
{
    static const uint32_t steps_us[] = {50, 333, 1000, 20000, 33333, 200000};
    static const uint32_t starts_us[] = {0,
                                         UINT32_MAX - 1000,
                                         UINT32_MAX - 100000,
                                         UINT32_MAX - 130000,
                                         UINT32_MAX - 300000,
                                         UINT32_C(0x7FFFF000)};
    for (unsigned s = 0; s != COUNT_OF(steps_us); s++) {
        for (unsigned n = 0; n != COUNT_OF(starts_us); n++) {
            start_meter_at(starts_us[n]);
            stand.pin.response_after_us = 110 * MS;
            for (uint32_t cycle = 1; cycle <= 5; cycle++) {
                stand.pin.response_width_us = 3000 + cycle * 1000;
                while (stand.readings != cycle) {
                    assert_true(stand.fake.now_us - starts_us[n] < cycle * 900 * MS);
                    run_meter_in_steps(steps_us[s], steps_us[s]);
                }
                assert_int_equal(stand.last.width_us, 3000 + cycle * 1000);
                assert_int_equal(stand.last.time_us,
                                 stand.pin.pulses[cycle - 1].rise_us + stand.last.width_us);
            }
            expect_no_responses(0);
            assert_true(stand.pin.least_us >= 221 * MS);
        }
    }
}

TEST(what_is_over_stays_over_however_late_the_poll)
{
    static const uint32_t late_us[] = {221000, 1000000, UINT32_C(0x80000000), UINT32_MAX - 105000};
    for (unsigned i = 0; i != 4; i++) {
        start_meter();
        run_to_trigger();
        stand.fake.now_us += late_us[i];
        expect_due(0);
        expect_poll(FATHOM_ERR_NO_RESPONSE);
        poll_after(3 * MS);
        expect_falls(2);
    }
}

TEST(who_sleeps_as_long_as_it_is_due_gets_a_reading_a_cycle)
{
    response_with(110 * MS, 10 * MS);
    for (unsigned polls = 0; polls != 31; polls++) { /* trigger, release and end of ten cycles */
        poll_after(fathom_pulse_due_us(&stand.meter));
    }
    assert_int_equal(stand.readings + stand.no_responses, 15);
    expect_no_responses(0);
}

/* A module that answers at once. */
TEST(a_pulse_that_ends_while_the_trigger_is_low_counts_and_the_low_time_is_kept)
{
    stand.config.low_us = 30 * MS;
    start_meter();
    response_with(500, 3000);
    run_meter(2000 * MS);
    expect_falls(9); /* 30 ms, 8 * 221 ms */
    expect_readings(9);
    assert_int_equal(stand.pin.low_us, 30 * MS);
    assert_int_equal(stand.pin.least_us, 221 * MS);
}

/* trigger.h: "period_us: low_us + 1..FATHOM_MAX_DURATION_US". */
TEST(the_period_of_a_trigger_is_longer_than_its_low_time)
{
    static const struct {
        uint32_t period_us;
        fathom_status_t status;
    } rows[] = {{0, FATHOM_ERR_ARGUMENT},
                {30000, FATHOM_ERR_ARGUMENT},
                {30001, FATHOM_OK},
                {FATHOM_MAX_DURATION_US, FATHOM_OK},
                {FATHOM_MAX_DURATION_US + 1, FATHOM_ERR_ARGUMENT}};
    for (unsigned i = 0; i != COUNT_OF(rows); i++) {
        fathom_trigger_t trigger = {.output = fathom_output_pin(&stand.pin.trigger),
                                    .clock = &stand.fake.clock,
                                    .period_us = rows[i].period_us,
                                    .low_us = 30000};
        assert_int_equal(fathom_trigger_init(&trigger), rows[i].status);
    }
}

/* ---- the break ---- */

static void trigger_by_break(void)
{
    stand.trigger = fathom_output_break(&stand.fake.uart);
    start_meter();
}

TEST(without_a_pin_a_break_of_the_uart_triggers)
{
    trigger_by_break();
    run_meter(1900);
    assert_int_equal(stand.fake.breaks, 0);
    stand.fake.busy_until_us = stand.fake.now_us + 5 * MS; /* bytes are leaving */
    run_meter(4900);
    assert_int_equal(stand.fake.breaks, 0);
    assert_in_range(fathom_pulse_due_us(&stand.meter), 1, 1 * MS);
    run_meter(200);
    assert_int_equal(stand.fake.breaks, 1);
    assert_true(stand.fake.in_break);
    pulse_in(110 * MS, 10 * MS);
    stand.fake.busy_until_us = stand.fake.now_us + 5 * MS;
    run_meter(4900);
    assert_true(stand.fake.in_break);
    run_meter(200);
    assert_false(stand.fake.in_break);
    run_meter(120 * MS);
    expect_readings(1);
}

/* ---- the capture looks for pulses before the trigger falls ---- */

/* Or what an interrupt lets pass between the two would be lost. The sensor answers in the very moment of the edge. */
static void expect_every_trigger_answered(void)
{
    static const uint32_t starts_us[] = {1000, UINT32_MAX - 300000};
    static const uint32_t loops_us[] = {500, 20000};
    int (*const set_break)(void *ctx, bool on) = stand.fake.uart.set_break;
    for (unsigned i = 0; i != 4; i++) {
        start_meter_at(starts_us[i / 2]);
        stand.fake.uart.set_break = set_break;
        stand.fake.busy_until_us = stand.fake.now_us + 5 * MS; /* a break cannot begin yet */
        response_with(0, 10 * MS);
        run_meter_in_steps(2100 * MS, loops_us[i % 2]);
        assert_in_range(stand.readings, 8, 10); /* cycles of 221 to 240 ms */
        expect_readings(stand.pin.falls + stand.fake.breaks);
        expect_no_responses(0);
        assert_int_equal(stand.port_errors, 0); /* a busy port is none */
        expect_last(FATHOM_TARGET, 10 * MS);
    }
}

TEST(a_pulse_that_begins_with_the_edge_counts) { expect_every_trigger_answered(); }

static int break_and_response(void *ctx, bool on)
{
    fake_t *const fake = ctx;
    if (on && (int32_t)(fake->now_us - fake->busy_until_us) < 0) return 0;
    if (on && !fake->in_break) pulse_in(0, 10 * MS);
    fake->breaks += on && !fake->in_break;
    fake->in_break = on;
    return 1;
}

TEST(a_pulse_that_begins_with_a_break_counts)
{
    trigger_by_break();
    stand.fake.uart.set_break = break_and_response;
    expect_every_trigger_answered();
}

/* ---- a port that fails ---- */

static int broken(void *ctx, bool on) { return (void)ctx, (void)on, -1; }

TEST(a_break_that_fails_is_said_by_every_poll_until_it_works_again)
{
    int (*const works)(void *ctx, bool on) = stand.fake.uart.set_break;
    trigger_by_break();
    stand.fake.uart.set_break = broken;
    stand.fake.now_us += 2 * MS;
    for (unsigned i = 0; i != 3; i++) expect_poll(FATHOM_ERR_PORT);
    stand.fake.uart.set_break = works;
    expect_poll(FATHOM_PENDING);
    assert_true(stand.fake.in_break);
    stand.fake.uart.set_break = broken;
    stand.fake.now_us += 2 * MS;
    for (unsigned i = 0; i != 3; i++) expect_poll(FATHOM_ERR_PORT);
    stand.fake.uart.set_break = works;
    expect_poll(FATHOM_PENDING);
    assert_false(stand.fake.in_break);
}

TEST(a_capture_that_fails_is_said_by_every_poll_until_it_works_again)
{
    run_to_trigger();
    pulse_in(110 * MS, 10 * MS);
    run_meter(100 * MS);
    stand.pin.take_fails = true;
    for (unsigned i = 0; i != 3; i++) {
        stand.fake.now_us += 100 * MS;
        expect_poll(FATHOM_ERR_PORT);
    }
    stand.pin.take_fails = false;
    expect_poll(FATHOM_OK);
    expect_last(FATHOM_TARGET, 10 * MS);
}

/* ---- setting up ---- */

static void expect_init(fathom_status_t status) { assert_int_equal(init_meter(), status); }

TEST(a_config_without_what_it_needs_is_refused)
{
    const pulse_rig_t good = stand;
    fathom_uart_t uart = stand.fake.uart;
    stand.clock = NULL;
    expect_init(FATHOM_ERR_ARGUMENT);
    stand.clock = good.clock;
    stand.capture = NULL;
    expect_init(FATHOM_ERR_ARGUMENT);
    stand.capture = good.capture;
    stand.trigger.set = NULL;
    expect_init(FATHOM_ERR_ARGUMENT);
    stand.trigger = fathom_output_break(&uart);
    expect_init(FATHOM_OK);
    uart.set_break = NULL;
    expect_init(FATHOM_ERR_UNSUPPORTED);
    stand.trigger = good.trigger;
    stand.config.noise_us = 50000;
    stand.config.no_target_us = 50000;
    expect_init(FATHOM_ERR_ARGUMENT);
    stand.config.noise_us = 49999;
    expect_init(FATHOM_OK);
    stand.config.stuck_us = 49999;
    expect_init(FATHOM_ERR_ARGUMENT);
    stand.config.stuck_us = 50000;
    expect_init(FATHOM_OK);
}

TEST(deinit_lets_the_trigger_go_high)
{
    run_to_trigger();
    assert_false(stand.pin.level);
    fathom_pulse_deinit(&stand.meter);
    assert_true(stand.pin.level);
    const unsigned sets = stand.pin.sets;
    fathom_pulse_deinit(&stand.meter);
    assert_int_equal(stand.pin.sets, sets);
}
