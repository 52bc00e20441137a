/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "pulse_rig.h"

static const suite_t suite = {.set_up = pulse_rig_set_up};

/* ---- the trigger ---- */

TEST(the_pin_is_high_for_2_ms_then_low_for_2_ms_and_then_high)
{
    assert_true(stand.pin.level);
    stand.fake.now_us += 1999;
    assert_int_equal(fathom_pulse_due_us(&stand.meter), 1);
    pulse_rig_poll();
    assert_true(stand.pin.level);
    stand.fake.now_us += 1;
    assert_int_equal(fathom_pulse_due_us(&stand.meter), 0);
    pulse_rig_poll();
    assert_false(stand.pin.level);
    assert_int_equal(stand.pin.arms, 1);
    assert_int_equal(fathom_pulse_due_us(&stand.meter), 2000);
    stand.fake.now_us += 1999;
    pulse_rig_poll();
    assert_false(stand.pin.level);
    stand.fake.now_us += 1;
    pulse_rig_poll();
    assert_true(stand.pin.level);
    assert_int_equal(fathom_pulse_due_us(&stand.meter), 219 * MS);
}

TEST(the_low_time_is_an_option)
{
    stand.config.low_us = 30000;
    pulse_rig_start(1000);
    pulse_rig_run(29900, 100);
    assert_int_equal(stand.pin.falls, 0);
    pulse_rig_run(100, 100);
    assert_int_equal(stand.pin.falls, 1);
    pulse_rig_run(100 * MS, 100);
    assert_int_equal(stand.pin.low_us, 30000);
}

/* "This cycle period of the module must be greater than 220ms" (A16 1(2)) */
TEST(a_cycle_is_221_ms_from_edge_to_edge)
{
    stand.pin.answer_after_us = 110 * MS;
    stand.pin.answer_width_us = 10 * MS;
    pulse_rig_run_to_trigger();
    pulse_rig_run(220900, 100);
    assert_int_equal(stand.pin.falls, 1);
    pulse_rig_run(100, 100);
    assert_int_equal(stand.pin.falls, 2);
    pulse_rig_run(2210 * MS, 100);
    assert_int_equal(stand.pin.falls, 12);
    assert_int_equal(stand.pin.least_us, 221 * MS);
    assert_int_equal(stand.readings, 11);
}

TEST(a_longer_cycle_is_kept_and_a_shorter_one_is_not)
{
    stand.config.cycle_us = 500 * MS;
    pulse_rig_start(1000);
    pulse_rig_run_to_trigger();
    pulse_rig_run(2000 * MS, 100);
    assert_int_equal(stand.pin.falls, 5);
    assert_int_equal(stand.pin.least_us, 500 * MS);
    stand.config.cycle_us = 219 * MS;
    pulse_rig_start(1000);
    pulse_rig_run_to_trigger();
    pulse_rig_run(2210 * MS, 100);
    assert_int_equal(stand.pin.least_us, 221 * MS);
}

/* An interrupt holds the program up for 5 ms between its look at the clock and the edge, and not in the next cycle. */
TEST(the_cycle_counts_from_a_look_at_the_clock_after_the_edge)
{
    for (unsigned i = 0; i != 5; i++) {
        stand.pin.delay_us = 5 * MS;
        pulse_rig_run(2 * 221 * MS, 100);
    }
    assert_int_equal(stand.pin.falls, 10);
    assert_int_equal(stand.pin.least_us, 221 * MS);
}

TEST(a_loop_of_300_ms_leaves_the_pin_high_for_2_ms_before_the_next_edge)
{
    stand.pin.answer_after_us = 110 * MS;
    stand.pin.answer_width_us = 10 * MS;
    pulse_rig_run(12000 * MS, 300 * MS);
    assert_true(stand.pin.falls >= 15);
    assert_int_equal(stand.pin.least_high_us, 300 * MS);
    assert_int_equal(stand.no_answers, 0);
    pulse_rig_start(1000);
    stand.pin.answer_after_us = 110 * MS;
    stand.pin.answer_width_us = 10 * MS;
    for (unsigned i = 0; i != 100; i++) { /* in turn 300 ms and 500 us */
        stand.fake.now_us += i % 2 != 0 ? 300 * MS : 500;
        pulse_rig_poll();
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
    for (unsigned s = 0; s != sizeof steps_us / sizeof *steps_us; s++) {
        for (unsigned n = 0; n != sizeof starts_us / sizeof *starts_us; n++) {
            pulse_rig_start(starts_us[n]);
            stand.pin.answer_after_us = 110 * MS;
            for (uint32_t cycle = 1; cycle <= 5; cycle++) {
                stand.pin.answer_width_us = 3000 + cycle * 1000;
                while (stand.readings != cycle) {
                    assert_true(stand.fake.now_us - starts_us[n] < cycle * 900 * MS);
                    pulse_rig_run(steps_us[s], steps_us[s]);
                }
                assert_int_equal(stand.last.width_us, 3000 + cycle * 1000);
                assert_int_equal(stand.last.time_us,
                                 stand.pin.pulses[cycle - 1].rise_us + stand.last.width_us);
            }
            assert_int_equal(stand.no_answers, 0);
            assert_true(stand.pin.least_us >= 221 * MS);
        }
    }
}

TEST(what_is_over_stays_over_however_late_the_poll)
{
    static const uint32_t late_us[] = {221000, 1000000, UINT32_C(0x80000000), UINT32_MAX - 5000};
    for (unsigned i = 0; i != 4; i++) {
        pulse_rig_start(1000);
        pulse_rig_run_to_trigger();
        stand.fake.now_us += late_us[i];
        assert_int_equal(fathom_pulse_due_us(&stand.meter), 0);
        assert_int_equal(pulse_rig_poll(), FATHOM_ERR_NO_ANSWER);
        stand.fake.now_us += 3 * MS;
        pulse_rig_poll();
        assert_int_equal(stand.pin.falls, 2);
    }
}

TEST(who_sleeps_as_long_as_it_is_due_gets_a_reading_a_cycle)
{
    stand.pin.answer_after_us = 110 * MS;
    stand.pin.answer_width_us = 10 * MS;
    for (unsigned polls = 0; polls != 31; polls++) { /* trigger, release and end of ten cycles */
        stand.fake.now_us += fathom_pulse_due_us(&stand.meter);
        pulse_rig_poll();
    }
    assert_int_equal(stand.readings + stand.no_answers, 15);
    assert_int_equal(stand.no_answers, 0);
}

/* A module that answers at once. */
TEST(a_pulse_that_ends_while_the_trigger_is_low_counts_and_the_low_time_is_kept)
{
    stand.config.low_us = 30 * MS;
    pulse_rig_start(1000);
    stand.pin.answer_after_us = 500;
    stand.pin.answer_width_us = 3000;
    pulse_rig_run(2000 * MS, 100);
    assert_int_equal(stand.pin.falls, 9); /* 30 ms, 8 * 221 ms */
    assert_int_equal(stand.readings, 9);
    assert_int_equal(stand.pin.low_us, 30 * MS);
    assert_int_equal(stand.pin.least_us, 221 * MS);
}

/* ---- the break ---- */

TEST(without_a_pin_a_break_of_the_uart_triggers)
{
    stand.config.trigger = NULL;
    stand.config.uart = &stand.fake.uart;
    pulse_rig_start(1000);
    pulse_rig_run(1900, 100);
    assert_int_equal(stand.fake.breaks, 0);
    stand.fake.busy_until_us = stand.fake.now_us + 5 * MS; /* bytes are leaving */
    pulse_rig_run(4900, 100);
    assert_int_equal(stand.fake.breaks, 0);
    assert_in_range(fathom_pulse_due_us(&stand.meter), 1, 1 * MS);
    pulse_rig_run(200, 100);
    assert_int_equal(stand.fake.breaks, 1);
    assert_true(stand.fake.in_break);
    fake_pulse(&stand.pin, 110 * MS, 10 * MS);
    stand.fake.busy_until_us = stand.fake.now_us + 5 * MS;
    pulse_rig_run(4900, 100);
    assert_true(stand.fake.in_break);
    pulse_rig_run(200, 100);
    assert_false(stand.fake.in_break);
    pulse_rig_run(120 * MS, 100);
    assert_int_equal(stand.readings, 1);
}

static int broken(void *ctx, bool on)
{
    (void)ctx;
    (void)on;
    return -1;
}

TEST(a_break_that_fails_is_said_by_every_poll_until_it_works_again)
{
    int (*const works)(void *ctx, bool on) = stand.fake.uart.set_break;
    stand.config.trigger = NULL;
    stand.config.uart = &stand.fake.uart;
    pulse_rig_start(1000);
    stand.fake.uart.set_break = broken;
    stand.fake.now_us += 2 * MS;
    for (unsigned i = 0; i != 3; i++) assert_int_equal(pulse_rig_poll(), FATHOM_ERR_PORT);
    stand.fake.uart.set_break = works;
    assert_int_equal(pulse_rig_poll(), FATHOM_PENDING);
    assert_true(stand.fake.in_break);
    stand.fake.uart.set_break = broken;
    stand.fake.now_us += 2 * MS;
    for (unsigned i = 0; i != 3; i++) assert_int_equal(pulse_rig_poll(), FATHOM_ERR_PORT);
    stand.fake.uart.set_break = works;
    assert_int_equal(pulse_rig_poll(), FATHOM_PENDING);
    assert_false(stand.fake.in_break);
}

TEST(a_capture_that_fails_is_said_by_every_poll_until_it_works_again)
{
    pulse_rig_run_to_trigger();
    fake_pulse(&stand.pin, 110 * MS, 10 * MS);
    pulse_rig_run(100 * MS, 100);
    stand.pin.take_fails = true;
    for (unsigned i = 0; i != 3; i++) {
        stand.fake.now_us += 100 * MS;
        assert_int_equal(pulse_rig_poll(), FATHOM_ERR_PORT);
    }
    stand.pin.take_fails = false;
    assert_int_equal(pulse_rig_poll(), FATHOM_READY);
    assert_int_equal(stand.last.width_us, 10 * MS);
}

/* ---- setting up ---- */

TEST(a_config_without_what_it_needs_is_refused)
{
    fathom_pulse_config_t bad;
    fathom_uart_t uart = stand.fake.uart;
    bad = stand.config;
    bad.clock = NULL;
    assert_int_equal(fathom_pulse_init(&stand.meter, &bad), FATHOM_ERR_ARGUMENT);
    bad = stand.config;
    bad.capture = NULL;
    assert_int_equal(fathom_pulse_init(&stand.meter, &bad), FATHOM_ERR_ARGUMENT);
    bad = stand.config;
    bad.trigger = NULL;
    assert_int_equal(fathom_pulse_init(&stand.meter, &bad), FATHOM_ERR_ARGUMENT);
    bad.uart = &uart;
    assert_int_equal(fathom_pulse_init(&stand.meter, &bad), FATHOM_READY);
    uart.set_break = NULL;
    assert_int_equal(fathom_pulse_init(&stand.meter, &bad), FATHOM_ERR_UNSUPPORTED);
    bad = stand.config;
    bad.noise_us = 50000;
    bad.no_target_us = 50000;
    assert_int_equal(fathom_pulse_init(&stand.meter, &bad), FATHOM_ERR_ARGUMENT);
    bad.noise_us = 49999;
    assert_int_equal(fathom_pulse_init(&stand.meter, &bad), FATHOM_READY);
    bad.stuck_us = 49999;
    assert_int_equal(fathom_pulse_init(&stand.meter, &bad), FATHOM_ERR_ARGUMENT);
    bad.stuck_us = 50000;
    assert_int_equal(fathom_pulse_init(&stand.meter, &bad), FATHOM_READY);
}

TEST(deinit_lets_the_trigger_go_high)
{
    pulse_rig_run_to_trigger();
    assert_false(stand.pin.level);
    fathom_pulse_deinit(&stand.meter);
    assert_true(stand.pin.level);
    const unsigned sets = stand.pin.sets;
    fathom_pulse_deinit(&stand.meter);
    assert_int_equal(stand.pin.sets, sets);
}
