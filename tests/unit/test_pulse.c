/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "pulse_rig.h"

static const suite_t suite = {.set_up = pulse_rig_set_up};

/* ---- what the pulse means ---- */

TEST(a_pulse_is_a_target_with_its_width_and_end)
{
    stand.pin.answer_after_us = 110 * MS;
    stand.pin.answer_width_us = 10 * MS; /* A16 1(4) */
    pulse_rig_run_to_trigger();
    const uint32_t edge_us = stand.fake.now_us;
    pulse_rig_run(119900, 100);
    assert_int_equal(stand.readings, 0);
    pulse_rig_run(100, 100);
    assert_int_equal(stand.readings, 1);
    assert_int_equal(stand.last.kind, FATHOM_TARGET);
    assert_int_equal(stand.last.width_us, 10 * MS);
    assert_int_equal(stand.last.time_us, edge_us + 120 * MS);
    pulse_rig_run(100 * MS, 100);
    assert_int_equal(stand.readings, 1);
    assert_int_equal(stand.no_answers, 0);
}

static const struct {
    uint32_t width_us;
    uint8_t kind; /* 0: noise */
} widths[] = {
    {1, 0},
    {2699, 0},
    {2700, FATHOM_TARGET},
    {3000, FATHOM_TARGET},
    {86250, FATHOM_TARGET},
    {91999, FATHOM_TARGET},
    {92000, FATHOM_NO_TARGET},
    {94000, FATHOM_NO_TARGET},
    {105000, FATHOM_NO_TARGET},
    {105001, FATHOM_FAULT},
};

TEST(widths_are_noise_target_no_target_or_a_fault)
{
    for (unsigned i = 0; i != sizeof widths / sizeof *widths; i++) {
        pulse_rig_start(1000);
        pulse_rig_run_to_trigger();
        fake_pulse(&stand.pin, 110 * MS, widths[i].width_us);
        pulse_rig_run(222 * MS, 100);
        assert_int_equal(stand.readings, widths[i].kind != 0);
        assert_int_equal(stand.meter.noises, widths[i].kind == 0);
        assert_int_equal(stand.no_answers, widths[i].kind == 0);
        if (widths[i].kind == 0) continue;
        assert_int_equal(stand.last.kind, widths[i].kind);
        assert_int_equal(stand.last.width_us, widths[i].width_us);
    }
}

TEST(the_three_widths_are_options)
{
    static const uint8_t kinds[] = {0, FATHOM_TARGET, FATHOM_NO_TARGET, FATHOM_NO_TARGET, FATHOM_FAULT};
    static const uint32_t us[] = {999, 1000, 50000, 60000, 60001};
    for (unsigned i = 0; i != 5; i++) {
        stand.config.noise_us = 1000;
        stand.config.no_target_us = 50000;
        stand.config.stuck_us = 60000;
        pulse_rig_start(1000);
        pulse_rig_run_to_trigger();
        fake_pulse(&stand.pin, 110 * MS, us[i]);
        pulse_rig_run(222 * MS, 100);
        assert_int_equal(stand.readings, kinds[i] != 0);
        if (kinds[i] != 0) assert_int_equal(stand.last.kind, kinds[i]);
    }
}

/* "T1 = 110ms" is information: a module that answers at once, or late, is right too. */
TEST(a_pulse_anywhere_after_the_trigger_counts)
{
    static const uint32_t after_us[] = {0, 1, 1000, 2500, 90000, 110000, 130000, 200000, 217999};
    for (unsigned i = 0; i != sizeof after_us / sizeof *after_us; i++) {
        pulse_rig_start(1000);
        pulse_rig_run_to_trigger();
        fake_pulse(&stand.pin, after_us[i], 3000);
        pulse_rig_run(222 * MS, 100);
        assert_int_equal(stand.readings, 1);
        assert_int_equal(stand.last.width_us, 3000);
        assert_int_equal(stand.no_answers, 0);
    }
}

TEST(noise_is_passed_over_and_the_pulse_behind_it_counts)
{
    pulse_rig_run_to_trigger();
    for (uint32_t i = 0; i != 20; i++) fake_pulse(&stand.pin, 5 * MS + i * 4 * MS, 10 + i * 100);
    fake_pulse(&stand.pin, 110 * MS, 10 * MS);
    pulse_rig_run(222 * MS, 100);
    assert_int_equal(stand.readings, 1);
    assert_int_equal(stand.last.width_us, 10 * MS);
    assert_int_equal(stand.meter.noises, 20);
}

TEST(more_noise_than_one_poll_takes_is_taken_by_the_next_ones)
{
    pulse_rig_run_to_trigger();
    for (uint32_t i = 0; i != 20; i++) fake_pulse(&stand.pin, 5 * MS + i * MS, 100);
    fake_pulse(&stand.pin, 110 * MS, 10 * MS);
    stand.fake.now_us += 250 * MS;
    assert_int_equal(pulse_rig_poll(), FATHOM_PENDING); /* 8 of them */
    assert_int_equal(stand.meter.noises, 8);
    assert_in_range(fathom_pulse_due_us(&stand.meter), 0, 2 * MS);
    assert_int_equal(pulse_rig_poll(), FATHOM_PENDING);
    assert_int_equal(pulse_rig_poll(), FATHOM_READY);
    assert_int_equal(stand.last.width_us, 10 * MS);
}

TEST(the_count_of_noise_stops_at_65535)
{
    stand.meter.noises = 65534;
    pulse_rig_run_to_trigger();
    for (uint32_t i = 0; i != 3; i++) fake_pulse(&stand.pin, 5 * MS + i * MS, 100);
    pulse_rig_run(100 * MS, 100);
    assert_int_equal(stand.meter.noises, 65535);
}

TEST(a_pulse_that_began_before_the_trigger_does_not_count)
{
    fake_pulse(&stand.pin, 500, 20 * MS);
    pulse_rig_run_to_trigger();
    pulse_rig_run(222 * MS, 100);
    assert_int_equal(stand.readings, 0);
    assert_int_equal(stand.no_answers, 1);
}

TEST(no_pulse_at_all_is_no_answer_when_the_cycle_is_over_and_it_tries_again)
{
    pulse_rig_run_to_trigger();
    pulse_rig_run(220900, 100);
    assert_int_equal(stand.no_answers, 0);
    stand.fake.now_us += 100;
    assert_int_equal(pulse_rig_poll(), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(stand.pin.falls, 2); /* at once */
    pulse_rig_run(10 * 221 * MS, 100);
    assert_int_equal(stand.no_answers, 11);
    assert_int_equal(stand.readings, 0);
    fake_pulse(&stand.pin, 110 * MS, 10 * MS);
    pulse_rig_run(222 * MS, 100);
    assert_int_equal(stand.readings, 1);
}

TEST(a_line_that_is_high_when_the_cycle_is_over_is_a_fault)
{
    stand.pin.stuck_high = true;
    pulse_rig_run_to_trigger();
    const uint32_t edge_us = stand.fake.now_us;
    pulse_rig_run(221 * MS, 100);
    assert_int_equal(stand.readings, 1);
    assert_int_equal(stand.last.kind, FATHOM_FAULT);
    assert_int_equal(stand.last.width_us, 0);
    assert_int_equal(stand.last.time_us, edge_us + 221 * MS);
    pulse_rig_run(221 * MS, 100);
    assert_int_equal(stand.readings, 2);
    stand.pin.stuck_high = false;
    pulse_rig_run(221 * MS, 100);
    assert_int_equal(stand.readings, 2);
    assert_int_equal(stand.no_answers, 1);
}

TEST(a_pulse_that_never_ends_is_a_fault_when_the_cycle_is_over)
{
    pulse_rig_run_to_trigger();
    fake_pulse(&stand.pin, 110 * MS, 5000 * MS);
    pulse_rig_run(221 * MS, 100);
    assert_int_equal(stand.readings, 1);
    assert_int_equal(stand.last.kind, FATHOM_FAULT);
}
