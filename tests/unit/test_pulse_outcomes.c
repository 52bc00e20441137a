/* SPDX-License-Identifier: MIT */
#include "fathom/engine/wait.h"
#include "fathom/sensor/a16_pwm.h"
#include "pulse_rig.h"
#include "stream_rig.h"

#include <string.h>

/*
 * pulse.h: each cycle has one outcome, and a program that polls gets one within the bound of the header, whatever the
 * output, the capture, the line and the clock do. CYCLE_US and LOW_US are the defaults.
 */
#define CYCLE_US ((uint32_t)221000)
#define LOW_US   ((uint32_t)2000)
#define SECOND   ((uint32_t)1000000)

static fathom_uart_t uart;

static int set_up_pin(void **state)
{
    rig_seed(1);
    return set_up_meter(state);
}

static int set_up_uart(void **state)
{
    set_up_pin(state);
    uart = stand.fake.uart;
    stand.trigger = fathom_output_break(&uart);
    start_meter();
    return 0;
}

static const suite_t suite = {.set_up = set_up_pin};
static const suite_t with_uart = {.set_up = set_up_uart};

/* Polls every step_us until there is an outcome. Returns the time since the call, or fails beyond the bound. */
static uint32_t outcome_within(uint32_t bound_us, uint32_t step_us)
{
    for (uint32_t passed_us = 0;;) {
        passed_us += step_us;
        stand.fake.now_us += step_us;
        if (poll_meter() != FATHOM_PENDING) return passed_us;
        if (passed_us > bound_us) fail_msg("nothing in %lu us", (unsigned long)passed_us);
    }
}

/* "2 * cycle_us + low_us + 3 * P" */
static uint32_t bound_us(uint32_t step_us) { return 2 * CYCLE_US + LOW_US + 3 * step_us; }

/* "2 * cycle_us + low_us + 2 s + 5 * P" */
static uint32_t bound_of_break_us(uint32_t step_us) { return bound_us(step_us) + 2 * SECOND + 2 * step_us; }

/* ---- pulses below the range ---- */

TEST(a_cycle_with_only_short_pulses_is_unknown_with_the_longest_width)
{
    run_to_trigger();
    const uint32_t edge_us = stand.fake.now_us;
    pulse_in(10 * MS, 100);
    pulse_in(20 * MS, 2699);
    pulse_in(30 * MS, 200);
    run_meter(CYCLE_US - 100);
    expect_readings(0);
    run_meter(100);
    expect_readings(1);
    expect_last(FATHOM_UNKNOWN, 2699);
    assert_int_equal(stand.last.time_us, edge_us + CYCLE_US);
    assert_int_equal(stand.meter.noises, 3);
    expect_no_responses(0);
}

/* One cycle with up to two pulses, which rise 10 and 110 ms after the trigger; the next one has none. */
static const struct {
    uint32_t widths_us[2];
    bool is_high_then; /* the line, from the first pulse to the end */
    uint8_t kind;      /* of the reading; 0: no response */
    uint32_t width_us;
    uint8_t next_kind;
} cycles[] = {
    {{2000, 10000}, false, FATHOM_TARGET, 10000, 0}, /* a valid pulse later in the cycle wins */
    {{99, 99}, false, 0, 0, 0},
    {{2000, 0}, false, FATHOM_UNKNOWN, 2000, 0}, /* it says nothing about the next cycle */
    {{2000, 0}, true, FATHOM_UNKNOWN, 2000, FATHOM_FAULT},
};

static void expect_cycle(uint8_t kind, uint32_t width_us)
{
    const unsigned readings = stand.readings, no_responses = stand.no_responses;
    run_meter(CYCLE_US);
    expect_readings(readings + (kind != 0));
    expect_no_responses(no_responses + (kind == 0));
    if (kind != 0) expect_last(kind, width_us);
}

TEST(the_short_pulses_of_a_cycle_are_its_outcome_if_nothing_else_is)
{
    for (unsigned i = 0; i != COUNT(cycles); i++) {
        (void)set_up_pin(state);
        run_to_trigger();
        for (unsigned n = 0; n != 2; n++)
            if (cycles[i].widths_us[n] != 0) pulse_in((n != 0 ? 110 : 10) * MS, cycles[i].widths_us[n]);
        stand.pin.stuck_high = cycles[i].is_high_then;
        expect_cycle(cycles[i].kind, cycles[i].width_us);
        run_meter(2 * MS); /* the next trigger */
        expect_cycle(cycles[i].next_kind, 0);
    }
}

/* A short pulse is a sample of the driver, without a distance. */
TEST(an_a16_with_short_pulses_is_unknown)
{
    static fathom_a16_pwm_t a16;
    fathom_sample_t sample;
    response_with(110 * MS, 1500);
    assert_int_equal(fathom_a16_pwm_init(&a16, stand.capture, stand.clock, &stand.trigger, NULL), FATHOM_OK);
    const fathom_sensor_t sensor = fathom_a16_pwm_sensor(&a16);
    fathom_status_t status = FATHOM_PENDING;
    for (unsigned polls = 0; polls != 1000 && status == FATHOM_PENDING; polls++) {
        stand.fake.now_us += 1 * MS;
        status = fathom_poll(&sensor, &sample);
    }
    assert_int_equal(status, FATHOM_OK);
    assert_int_equal(sample.kind, FATHOM_UNKNOWN);
    assert_int_equal(sample.raw, 1500);
    assert_int_equal(sample.distance_mm, 0);
    assert_int_equal(a16.implausible, 0);
}

/* ---- every wait ends ---- */

/* Noise that is there whenever the capture is asked. */
static uint32_t noise_us;

static int always_noise(void *ctx, fathom_pulse_t *pulse)
{
    const fake_pin_t *const pin = ctx;
    *pulse = (fathom_pulse_t){noise_us, pin->fake->now_us, false};
    return 1;
}

TEST(noise_faster_than_polls_take_it_does_not_hold_up_the_outcome)
{
    static const uint32_t steps_us[] = {1000, 20000, 600 * SECOND};
    stand.pin.capture.take = always_noise;
    for (unsigned i = 0; i != COUNT(steps_us); i++) {
        start_meter();
        stand.pin.capture.take = always_noise;
        noise_us = 50;
        for (unsigned n = 0; n != 5; n++) outcome_within(bound_us(steps_us[i]), steps_us[i]);
        expect_no_responses(5);
        noise_us = 150;
        for (unsigned n = 0; n != 5; n++) outcome_within(bound_us(steps_us[i]), steps_us[i]);
        expect_readings(5);
        expect_last(FATHOM_UNKNOWN, 150);
    }
}

TEST_IN(with_uart, a_port_that_never_begins_the_break_is_an_error_once_a_second)
{
    static const uint32_t steps_us[] = {1000, 20000, 600 * SECOND};
    for (unsigned i = 0; i != COUNT(steps_us); i++) {
        start_meter();
        stand.fake.refuses_begin = true;
        stand.fake.refusals = -1;
        for (unsigned n = 1; n != 5; n++) {
            assert_true(outcome_within(bound_of_break_us(steps_us[i]), steps_us[i]) <=
                        SECOND + 2 * steps_us[i] + 2 * MS);
            assert_int_equal(stand.port_errors, n);
        }
    }
}

TEST_IN(with_uart, a_port_that_never_ends_the_break_is_an_error_once_a_second)
{
    static const uint32_t steps_us[] = {1000, 20000, 600 * SECOND};
    for (unsigned i = 0; i != COUNT(steps_us); i++) {
        start_meter();
        while (!stand.meter.trigger.low) run_meter_in_steps(steps_us[i], steps_us[i]);
        stand.fake.refusals = -1;
        for (unsigned n = 0; n != 5; n++) outcome_within(bound_of_break_us(steps_us[i]), steps_us[i]);
        assert_true(stand.port_errors >= 3);
        assert_true(stand.meter.trigger.low);
    }
}

TEST(polls_every_10_minutes_have_an_outcome_in_every_second_poll_at_least)
{
    response_with(110 * MS, 10 * MS);
    for (unsigned n = 0; n != 20; n++) outcome_within(2 * 600 * SECOND, 600 * SECOND);
    expect_readings(0); /* they are all too old */
    expect_no_responses(0);
    assert_int_equal(stand.meter.stales, 20);
}

/* ---- age ---- */

TEST(a_pulse_of_300_s_ago_is_no_reading_and_the_next_one_is)
{
    response_with(110 * MS, 10 * MS);
    run_to_trigger();
    stand.fake.now_us += 300 * SECOND;
    expect_poll(FATHOM_ERR_STALE);
    assert_int_equal(stand.meter.stales, 1);
    run_meter(240 * MS);
    expect_readings(1);
    assert_true(stand.fake.now_us - stand.last.time_us < CYCLE_US);
}

/* "A pulse that ended more than 2.5 s before the poll": the pulse ends 120 ms after the edge. */
TEST(a_pulse_may_be_2500_ms_old)
{
    for (uint32_t late_us = 0; late_us != 2; late_us++) {
        start_meter();
        response_with(110 * MS, 10 * MS);
        run_to_trigger();
        stand.fake.now_us += 120 * MS + 2500000u + late_us;
        expect_poll(late_us == 0 ? FATHOM_OK : FATHOM_ERR_STALE);
    }
}

TEST(a_short_pulse_of_300_s_ago_is_no_reading_either)
{
    run_to_trigger();
    pulse_in(110 * MS, 1500);
    stand.fake.now_us += 300 * SECOND;
    expect_poll(FATHOM_ERR_STALE);
    expect_readings(0);
}

TEST(the_count_of_old_pulses_stops_at_65535)
{
    stand.meter.stales = 65534;
    response_with(110 * MS, 10 * MS);
    for (unsigned n = 0; n != 6; n++) run_meter_in_steps(300 * SECOND, 300 * SECOND);
    assert_int_equal(stand.meter.stales, 65535);
}

TEST(init_forgets_the_pulse_of_the_cycle_before)
{
    run_to_trigger();
    pulse_in(5 * MS, 10 * MS);
    stand.fake.now_us += 20 * MS;
    assert_int_equal(init_meter(), FATHOM_OK);
    run_meter(240 * MS);
    expect_readings(0);
    expect_no_responses(1);
}

/* ---- the clock ---- */

TEST(a_clock_that_stands_still_and_goes_on_costs_its_time_and_no_more)
{
    run_to_trigger();
    for (uint32_t n = 0; n != 1000; n++) expect_poll(FATHOM_PENDING);
    outcome_within(CYCLE_US, 1 * MS);
    expect_no_responses(1);
}

TEST(a_clock_that_is_set_back_by_100_ms_does_not_shorten_the_cycle)
{
    for (uint32_t at_us = 1 * MS; at_us < CYCLE_US; at_us += 1 * MS) {
        start_meter_at(at_us % 2 == 0 ? 1000 : UINT32_MAX - at_us);
        run_to_trigger();
        run_meter_in_steps(at_us, 1 * MS);
        stand.fake.now_us -= 100 * MS;
        const unsigned falls = stand.pin.falls;
        expect_poll(FATHOM_PENDING);
        const uint32_t left_us = CYCLE_US - at_us;
        run_meter_in_steps(left_us - 1 * MS, 1 * MS);
        assert_int_equal(stand.pin.falls, falls);
        outcome_within(1 * MS, 1 * MS);
    }
}

/* ---- any of it ---- */

static uint32_t step_of(uint32_t world)
{
    static const uint32_t steps_us[] = {500, 3000, 20000, 300000, 3000000, 600000000};
    return 1 + rig_random_below(steps_us[world % COUNT(steps_us)]);
}

/* Everything that a cycle can meet, at random. The time between two outcomes is the clock's, without its jumps. */
static void run_world(uint32_t world, bool is_break)
{
    start_meter_at(rig_random_below(UINT32_MAX));
    uint32_t longest_us = 0;
    uint32_t since_us = 0;
    for (unsigned polls = 0; polls != 400; polls++) {
        const uint32_t step_us = step_of(world);
        if (step_us > longest_us) longest_us = step_us;
        stand.fake.now_us += step_us;
        since_us += step_us;
        if (rig_random_below(20) == 0) {
            const uint32_t back_us = rig_random_below(100001);
            stand.fake.now_us -= back_us;
            since_us = since_us > back_us ? since_us - back_us : 0;
        }
        if (rig_random_below(10) == 0) stand.pin.stuck_high = rig_random_below(2) != 0;
        if (rig_random_below(10) == 0) stand.pin.take_fails = rig_random_below(4) == 0;
        if (rig_random_below(10) == 0)
            response_with(rig_random_below(250000), rig_random_below(3) == 0 ? 0 : rig_random_below(110000));
        if (is_break && rig_random_below(10) == 0) stand.fake.refuses_begin = rig_random_below(2) != 0;
        if (is_break && rig_random_below(10) == 0) stand.fake.refusals = rig_random_below(2) != 0 ? -1 : 0;
        if (stand.pin.last - stand.pin.first > FAKE_PULSES / 2) stand.pin.first = stand.pin.last;
        if (poll_meter() != FATHOM_PENDING) {
            since_us = 0;
            if (stand.readings != 0)
                assert_true((int32_t)(stand.fake.now_us - stand.last.time_us) <= INT32_MAX);
        }
        const uint32_t bound = is_break ? bound_of_break_us(longest_us) : bound_us(longest_us);
        if (since_us > bound)
            fail_msg("world %lu: nothing in %lu us", (unsigned long)world, (unsigned long)since_us);
    }
}

TEST(any_pulses_any_polls_and_any_clock_have_an_outcome_within_the_bound)
{
    const uint32_t worlds = suite_is_long ? 100000 : 600;
    for (uint32_t world = 0; world != worlds; world++) run_world(world, false);
}

TEST_IN(with_uart, any_refusals_have_an_outcome_within_the_bound)
{
    const uint32_t worlds = suite_is_long ? 100000 : 600;
    for (uint32_t world = 0; world != worlds; world++) run_world(world, true);
}

/* ---- fathom_wait ---- */

static void sleep_for(void *ctx, uint32_t max_us)
{
    (void)ctx;
    assert_true(max_us <= CYCLE_US);
    stand.fake.now_us += max_us;
}

static fathom_status_t wait_for_a16(uint8_t kind)
{
    static fathom_a16_pwm_t a16;
    fathom_sample_t sample;
    assert_int_equal(fathom_a16_pwm_init(&a16, stand.capture, stand.clock, &stand.trigger, NULL), FATHOM_OK);
    const fathom_sensor_t sensor = fathom_a16_pwm_sensor(&a16);
    fathom_status_t status = FATHOM_PENDING;
    for (unsigned n = 0; n != 5; n++) status = fathom_wait(&sensor, &sample, sleep_for, NULL);
    if (status == FATHOM_OK) assert_int_equal(sample.kind, kind);
    return status;
}

TEST(wait_returns_whatever_the_line_does)
{
    assert_int_equal(wait_for_a16(0), FATHOM_ERR_NO_RESPONSE);
    stand.pin.stuck_high = true;
    assert_int_equal(wait_for_a16(FATHOM_FAULT), FATHOM_OK);
    stand.pin.stuck_high = false;
    noise_us = 99;
    stand.pin.capture.take = always_noise;
    assert_int_equal(wait_for_a16(0), FATHOM_ERR_NO_RESPONSE);
    noise_us = 2699;
    assert_int_equal(wait_for_a16(FATHOM_UNKNOWN), FATHOM_OK);
}

TEST_IN(with_uart, wait_returns_for_a_port_that_refuses_the_break)
{
    stand.fake.refuses_begin = true;
    stand.fake.refusals = -1;
    assert_int_equal(wait_for_a16(0), FATHOM_ERR_PORT);
}

/* ---- zeroed memory ---- */

TEST(a_meter_in_zeroed_memory_has_an_error_in_each_poll_and_no_function_is_called)
{
    memset(&stand.meter, 0, sizeof stand.meter);
    expect_poll(FATHOM_ERR_ARGUMENT);
    expect_due(0);
    assert_int_equal(fathom_pulse_deinit(&stand.meter), FATHOM_OK);
}

TEST(an_init_that_fails_leaves_the_meter_zeroed)
{
    const fathom_pulse_meter_t zeroed = {0};
    const fathom_pin_t input = {NULL, NULL, NULL};
    memset(&stand.meter, 0x5A, sizeof stand.meter);
    stand.trigger = fathom_output_pin(&input);
    assert_int_equal(init_meter(), FATHOM_ERR_UNSUPPORTED);
    assert_memory_equal(&stand.meter, &zeroed, sizeof zeroed);
    stand.trigger = fathom_output_pin(NULL);
    assert_int_equal(init_meter(), FATHOM_ERR_UNSUPPORTED);
    stand.trigger = fathom_output_break(NULL);
    assert_int_equal(init_meter(), FATHOM_ERR_UNSUPPORTED);
}
