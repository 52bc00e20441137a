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
