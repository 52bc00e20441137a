/* SPDX-License-Identifier: MIT */
#include "pulse_rig.h"

static const suite_t suite = {.set_up = set_up_meter};

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

/* "T1 = 110ms" is information: a module that answers at once, or late, is right too. */
TEST(a_pulse_anywhere_after_the_trigger_counts)
{
    static const uint32_t after_us[] = {0, 1, 1000, 2500, 90000, 110000, 130000, 200000, 217999};
    for (unsigned i = 0; i != COUNT_OF(after_us); i++) {
        measure(after_us[i], 3000);
        expect_readings(1);
        expect_last(FATHOM_TARGET, 3000);
        expect_no_responses(0);
    }
}

TEST(noise_is_passed_over_and_the_pulse_behind_it_counts)
{
    run_to_trigger();
    for (uint32_t i = 0; i != 20; i++) pulse_in(5 * MS + i * 4 * MS, 10 + i * 100);
    pulse_in(110 * MS, 10 * MS);
    run_meter(222 * MS);
    expect_readings(1);
    expect_last(FATHOM_TARGET, 10 * MS);
    assert_int_equal(stand.meter.noises, 20);
}

TEST(more_noise_than_one_poll_takes_is_taken_by_the_next_ones)
{
    run_to_trigger();
    for (uint32_t i = 0; i != 20; i++) pulse_in(5 * MS + i * MS, 99);
    pulse_in(110 * MS, 10 * MS);
    stand.fake.now_us += 200 * MS;
    expect_poll(FATHOM_PENDING); /* 16 of them */
    assert_int_equal(stand.meter.noises, 16);
    expect_poll(FATHOM_OK);
    expect_last(FATHOM_TARGET, 10 * MS);
}

TEST(the_count_of_noise_stops_at_65535)
{
    stand.meter.noises = 65534;
    run_to_trigger();
    for (uint32_t i = 0; i != 3; i++) pulse_in(5 * MS + i * MS, 100);
    run_meter(100 * MS);
    assert_int_equal(stand.meter.noises, 65535);
}

TEST(a_pulse_that_began_before_the_trigger_does_not_count)
{
    pulse_in(500, 20 * MS);
    run_to_trigger();
    run_meter(222 * MS);
    expect_readings(0);
    expect_no_responses(1);
}

TEST(no_pulse_at_all_is_no_response_when_the_cycle_is_over_and_it_tries_again)
{
    run_to_trigger();
    run_meter(220900);
    expect_no_responses(0);
    stand.fake.now_us += 100;
    expect_poll(FATHOM_ERR_NO_RESPONSE);
    expect_falls(2); /* at once */
    run_meter(10 * 221 * MS);
    expect_no_responses(11);
    expect_readings(0);
    pulse_in(110 * MS, 10 * MS);
    run_meter(222 * MS);
    expect_readings(1);
}

TEST(a_line_that_is_high_when_the_cycle_is_over_is_a_fault)
{
    stand.pin.stuck_high = true;
    run_to_trigger();
    const uint32_t edge_us = stand.fake.now_us;
    run_meter(221 * MS);
    expect_readings(1);
    expect_last(FATHOM_FAULT, 0);
    assert_int_equal(stand.last.time_us, edge_us + 221 * MS);
    run_meter(221 * MS);
    expect_readings(2);
    stand.pin.stuck_high = false;
    run_meter(221 * MS);
    expect_readings(2);
    expect_no_responses(1);
}

TEST(a_pulse_that_never_ends_is_a_fault_when_the_cycle_is_over)
{
    run_to_trigger();
    pulse_in(110 * MS, 5000 * MS);
    run_meter(221 * MS);
    expect_readings(1);
    assert_int_equal(stand.last.kind, FATHOM_FAULT);
}
