/* SPDX-License-Identifier: MIT */
#include "pulse_rig.h"

/* pulse.h and trigger.h: what a pulse means, when a cycle begins and ends, and a port that fails. */

static fathom_uart_t uart;

/* hal.h: "< 0: the port is broken", of an int: -256 is 0 in its low byte. */
static int failing_set_break(void *ctx, bool on)
{
    (void)ctx, (void)on;
    return -256;
}

static int failing_take(void *ctx, fathom_pulse_t *pulse)
{
    (void)ctx, (void)pulse;
    return -256;
}

/* A break of the UART triggers. */
static int set_up_uart(void **state)
{
    set_up_meter(state);
    uart = stand.fake.uart;
    stand.trigger = fathom_output_break(&uart);
    start_meter();
    return 0;
}

static const suite_t suite = {.set_up = set_up_meter};
static const suite_t with_uart = {.set_up = set_up_uart};

static fathom_status_t poll_after(uint32_t us)
{
    stand.fake.now_us += us;
    return poll_meter();
}

/* ---- what the pulse means ---- */

TEST(a_pulse_is_a_target_with_its_width_and_end)
{
    response_with(110 * MS, 10 * MS); /* A16 1(4) */
    run_to_trigger();
    const uint32_t edge_us = stand.fake.now_us;
    run_meter(119900);
    expect_readings(0);
    run_meter(100);
    expect_readings(1);
    expect_last(FATHOM_TARGET, 10 * MS);
    assert_int_equal(stand.last.time_us, edge_us + 120 * MS);
    run_meter(100 * MS);
    expect_readings(1);
    expect_no_responses(0);
}

/* A pulse of this width is one reading of this kind; 0: no response. */
static void expect_kind(uint32_t width_us, uint8_t kind)
{
    measure(110 * MS, width_us);
    expect_readings(kind != 0);
    assert_int_equal(stand.meter.noises, kind == 0 || kind == FATHOM_UNKNOWN);
    expect_no_responses(kind == 0);
    if (kind != 0) expect_last(kind, width_us);
}

TEST(widths_are_noise_unknown_target_no_target_or_a_fault)
{
    expect_kind(1, 0);
    expect_kind(99, 0);
    expect_kind(100, FATHOM_UNKNOWN);
    expect_kind(2699, FATHOM_UNKNOWN);
    expect_kind(2700, FATHOM_TARGET);
    expect_kind(3000, FATHOM_TARGET);
    expect_kind(86250, FATHOM_TARGET);
    expect_kind(91999, FATHOM_TARGET);
    expect_kind(92000, FATHOM_NO_TARGET);
    expect_kind(94000, FATHOM_NO_TARGET);
    expect_kind(105000, FATHOM_NO_TARGET);
    expect_kind(105001, FATHOM_FAULT);
}

TEST(the_three_widths_are_options)
{
    stand.config.noise_us = 1000;
    stand.config.no_target_us = 50000;
    stand.config.stuck_us = 60000;
    expect_kind(999, FATHOM_UNKNOWN);
    expect_kind(1000, FATHOM_TARGET);
    expect_kind(50000, FATHOM_NO_TARGET);
    expect_kind(60000, FATHOM_NO_TARGET);
    expect_kind(60001, FATHOM_FAULT);
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
    for (unsigned s = 0; s != COUNT(steps_us); s++) {
        for (unsigned n = 0; n != COUNT(starts_us); n++) {
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

TEST(who_sleeps_as_long_as_it_is_due_gets_a_reading_a_cycle)
{
    response_with(110 * MS, 10 * MS);
    for (unsigned polls = 0; polls != 31; polls++) /* trigger, release and end of ten cycles */
        (void)poll_after(fathom_pulse_due_us(&stand.meter));
    assert_int_equal(stand.readings + stand.no_responses, 15);
    expect_no_responses(0);
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
    for (unsigned i = 0; i != COUNT(rows); i++) {
        fathom_trigger_t trigger = {.output = fathom_output_pin(&stand.pin.trigger),
                                    .clock = &stand.fake.clock,
                                    .period_us = rows[i].period_us,
                                    .low_us = 30000};
        assert_int_equal(fathom_trigger_init(&trigger), rows[i].status);
    }
}

/* ---- a port that fails ---- */

TEST(a_capture_that_fails_is_said_by_every_poll_until_it_works_again)
{
    run_to_trigger();
    pulse_in(110 * MS, 10 * MS);
    run_meter(100 * MS);
    stand.pin.take_fails = true;
    for (unsigned i = 0; i != 3; i++) assert_int_equal(poll_after(100 * MS), FATHOM_ERR_PORT);
    stand.pin.take_fails = false;
    expect_poll(FATHOM_OK);
    expect_last(FATHOM_TARGET, 10 * MS);
}

/* ---- setting up ---- */

static void expect_init(fathom_status_t status) { assert_int_equal(init_meter(), status); }

TEST(a_config_without_what_it_needs_is_refused)
{
    const pulse_rig_t good = stand;
    uart = stand.fake.uart;
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

/* ---- a UART that is busy or broken ---- */

static void is_busy_for(uint32_t us) { stand.fake.busy_until_us = stand.fake.now_us + us; }

/* "never FATHOM_NO_DEADLINE": a port that was busy is asked again in 1 ms. */
TEST_IN(with_uart, where_the_port_was_busy_it_is_due_in_1_ms)
{
    is_busy_for(10 * MS);
    assert_int_equal(poll_after(2 * MS), FATHOM_PENDING);
    assert_int_equal(stand.fake.breaks, 0);
    expect_due(1000);
    stand.fake.now_us += 400;
    expect_due(600);
}

TEST_IN(with_uart, a_trigger_rises_as_soon_as_the_port_is_no_longer_busy)
{
    (void)poll_after(2 * MS);
    assert_true(stand.fake.in_break);
    is_busy_for(5 * MS);
    assert_int_equal(poll_after(2 * MS), FATHOM_PENDING);
    expect_due(1000);
    assert_int_equal(poll_after(2 * MS), FATHOM_PENDING);
    assert_true(stand.fake.in_break);
    assert_int_equal(poll_after(1 * MS), FATHOM_PENDING);
    assert_false(stand.fake.in_break);
}

/* "A cycle begins with the falling edge": what is low cannot fall. */
TEST_IN(with_uart, no_cycle_begins_before_the_trigger_has_risen)
{
    (void)poll_after(2 * MS);
    assert_int_equal(stand.pin.arms, 1);
    is_busy_for(500 * MS);
    assert_int_equal(poll_after(221 * MS), FATHOM_ERR_NO_RESPONSE);
    assert_int_equal(poll_after(1 * MS), FATHOM_PENDING);
    assert_int_equal(stand.pin.arms, 1);
    assert_int_equal(stand.fake.breaks, 1);
    assert_int_equal(poll_after(278 * MS), FATHOM_PENDING); /* 221 + 1 + 278 = 500 */
    assert_false(stand.fake.in_break);
    assert_int_equal(stand.pin.arms, 1);
    (void)poll_after(2 * MS); /* some high time */
    assert_int_equal(stand.pin.arms, 2);
    assert_true(stand.fake.in_break);
}

/* FATHOM_ERR_PORT: "the capture or the break failed; said by every poll until it works again". */
TEST_IN(with_uart, every_negative_result_of_set_break_is_a_broken_port)
{
    uart.set_break = failing_set_break;
    assert_int_equal(poll_after(2 * MS), FATHOM_ERR_PORT);
    uart.set_break = stand.fake.uart.set_break;
    assert_int_equal(poll_after(1 * MS), FATHOM_PENDING);
    assert_true(stand.fake.in_break);
    uart.set_break = failing_set_break;
    assert_int_equal(poll_after(2 * MS), FATHOM_ERR_PORT);
    assert_int_equal(poll_after(1 * MS), FATHOM_ERR_PORT);
}

TEST(every_negative_result_of_take_is_a_broken_port)
{
    stand.pin.capture.take = failing_take;
    run_to_trigger();
    assert_int_equal(poll_after(100), FATHOM_ERR_PORT);
}
