/* SPDX-License-Identifier: MIT */
#include "controlled_rig.h"

#include <string.h>

#include "suite.h"

/* Sums by hand: FF + 3F + DF = 21D, FF + FF + FD = 2FB, FF + FF + FE = 2FC. */
static const uint8_t mm_16351[] = {0xFF, 0x3F, 0xDF, 0x1D};
static const uint8_t no_object[] = {0xFF, 0xFF, 0xFD, 0xFB};
static const uint8_t interference[] = {0xFF, 0xFF, 0xFE, 0xFC};

static const suite_t suite = {.set_up = controlled_set_up};

/* ---- the trigger ---- */

TEST(a_break_of_2_ms_triggers_every_121_ms)
{
    controlled_run_to_break(1, 100);
    assert_int_equal(rig.fake.now_us, RIG_START_US + 2 * MS);
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 2 * MS);
    rig.fake.now_us += 1999;
    rig_poll();
    assert_true(rig.fake.in_break);
    rig.fake.now_us += 1;
    rig_poll();
    assert_false(rig.fake.in_break);
    for (unsigned n = 2; n <= 10; n++) {
        controlled_answer(controlled_1953, 98 * MS);
        const uint32_t edge_us = rig.fake.now_us - 2 * MS;
        controlled_run_to_break(n, 100);
        assert_int_equal(rig.fake.now_us - edge_us, 121 * MS); /* "must be greater than 120ms" (A16 3(2)) */
        assert_int_equal(rig.samples, n - 1);
        rig_run(2 * MS, 100);
    }
}

TEST(a_pin_triggers_instead_of_the_break)
{
    controlled.config.trigger = &controlled.pin.trigger;
    controlled_start();
    assert_true(controlled.pin.level);
    rig_run(2 * MS, 100);
    assert_false(controlled.pin.level);
    assert_int_equal(controlled.pin.falls, 1);
    controlled_answer(controlled_1953, 100 * MS);
    rig_run(110 * MS, 100);
    assert_int_equal(controlled.pin.low_us, 2 * MS);
    assert_int_equal(rig.samples, 1);
    rig_run(1000 * MS, 100);
    assert_true(controlled.pin.falls > 7);
    assert_true(controlled.pin.least_us >= 121 * MS);
    assert_int_equal(rig.fake.breaks, 0);
}

TEST(period_and_low_time_are_options_and_a_shorter_period_is_not_kept)
{
    controlled.config.trigger = &controlled.pin.trigger;
    controlled.config.period_us = 300 * MS;
    controlled.config.low_us = 10 * MS;
    controlled_start();
    rig_run(2000 * MS, 1 * MS);
    assert_int_equal(controlled.pin.least_us, 300 * MS);
    assert_int_equal(controlled.pin.low_us, 10 * MS);
    controlled.config.period_us = 120 * MS;
    controlled.config.latest_us = 90 * MS;
    controlled_start();
    rig_run(2000 * MS, 1 * MS);
    assert_int_equal(controlled.pin.least_us, 121 * MS);
}

TEST(a_slow_loop_leaves_the_pin_high_for_the_low_time_before_the_next_edge)
{
    controlled.config.trigger = &controlled.pin.trigger;
    controlled_start();
    for (unsigned i = 0; i != 100; i++) {
        rig.fake.now_us += i % 2 != 0 ? 300 * MS : 500;
        rig_poll();
    }
    assert_true(controlled.pin.falls > 10);
    assert_in_range(controlled.pin.least_high_us, 2 * MS, 301 * MS);
}

/* ---- the answer ---- */

TEST(the_example_of_the_datasheet_is_a_sample_with_all_its_members)
{
    controlled_run_to_break(1, 100);
    const uint32_t edge_us = rig.fake.now_us;
    controlled_answer(controlled_1953, 100 * MS);
    assert_int_equal(controlled_outcome(100), FATHOM_READY);
    assert_int_equal(rig.sample.distance_mm, 1953);
    assert_int_equal(rig.sample.raw, 1953);
    assert_int_equal(rig.sample.kind, FATHOM_TARGET);
    assert_int_equal(rig.sample.model, FATHOM_A16);
    assert_int_equal(rig.sample.sequence, 1);
    assert_int_equal(rig.sample.unit, 0);
    assert_int_equal(rig.sample.probe, 1);
    assert_int_equal(rig.sample.magnitude + rig.sample.precision + rig.sample.ambient, 0);
    assert_in_range(rig.sample.time_us, edge_us + 100 * MS, edge_us + 100 * MS + 100);
    assert_in_range(rig.fake.now_us, rig.sample.time_us + 5000, rig.sample.time_us + 5100);
}

static const struct {
    const uint8_t *frame;
    uint8_t kind; /* 0: refused */
    bool interference;
} readings[] = {
    {controlled_511, FATHOM_TARGET, false},
    {no_object, FATHOM_NO_TARGET, false},
    {interference, FATHOM_NO_TARGET, true},
    {mm_16351, 0, false},
};

TEST(frames_are_target_no_target_or_refused)
{
    for (unsigned i = 0; i != sizeof readings / sizeof *readings; i++) {
        controlled_start();
        controlled_run_to_break(1, 100);
        controlled_answer(readings[i].frame, 100 * MS);
        assert_int_equal(controlled_outcome(100),
                         readings[i].kind != 0 ? FATHOM_READY : FATHOM_ERR_MALFORMED);
        assert_int_equal(controlled.a16.answer.implausible, readings[i].kind == 0);
        if (readings[i].kind == 0) continue;
        assert_int_equal(rig.sample.kind, readings[i].kind);
        assert_true(rig.sample.interference == readings[i].interference);
    }
    controlled_start();
    controlled.a16.answer.implausible = UINT16_MAX;
    controlled_run_to_break(1, 100);
    controlled_answer(mm_16351, 100 * MS);
    assert_int_equal(controlled_outcome(100), FATHOM_ERR_MALFORMED);
    assert_int_equal(controlled.a16.answer.implausible, UINT16_MAX);
}

TEST(a_window_of_the_users_own_is_kept)
{
    controlled.config.window.min_mm = 1954;
    controlled_start();
    controlled_run_to_break(1, 100);
    controlled_answer(controlled_1953, 100 * MS);
    assert_int_equal(controlled_outcome(100), FATHOM_ERR_MALFORMED);
}

/* ---- the port ---- */

TEST(a_busy_port_delays_the_edges_and_costs_no_answer)
{
    rig.fake.never_sent = true;
    rig_run(50 * MS, 100);
    assert_int_equal(rig.fake.breaks, 0);
    assert_in_range(fathom_due_us(&rig.sensor, 1), 0, 1 * MS);
    rig.fake.never_sent = false;
    rig_run(100, 100);
    assert_int_equal(rig.fake.breaks, 1);
    controlled_answer(controlled_1953, 100 * MS);
    rig.fake.never_sent = true;
    rig_run(50 * MS, 100);
    assert_true(rig.fake.in_break);
    rig.fake.never_sent = false;
    rig_run(100, 100);
    assert_false(rig.fake.in_break);
    rig_run(60 * MS, 100);
    assert_int_equal(rig.samples, 1);
}

TEST(a_broken_port_is_said_by_every_poll_until_it_works_again)
{
    controlled_run_to_break(1, 100);
    rig.fake.read_fails = true;
    for (unsigned i = 0; i != 5; i++) {
        rig.fake.now_us += 100 * MS;
        assert_int_equal(rig_poll(), FATHOM_ERR_PORT);
    }
    rig.fake.read_fails = false;
    assert_int_equal(rig_poll(), FATHOM_ERR_NO_ANSWER);
    assert_false(rig.fake.in_break);
    controlled_run_to_break(2, 100);
    controlled_answer(controlled_1953, 100 * MS);
    assert_int_equal(controlled_outcome(100), FATHOM_READY);
}

static int broken(void *ctx, bool on)
{
    (void)ctx;
    (void)on;
    return -1;
}

TEST(a_break_that_fails_is_said_by_every_poll_until_it_works_again)
{
    int (*const works)(void *ctx, bool on) = rig.fake.uart.set_break;
    rig.fake.uart.set_break = broken;
    rig.fake.now_us += 2 * MS;
    for (unsigned i = 0; i != 3; i++) assert_int_equal(rig_poll(), FATHOM_ERR_PORT);
    rig.fake.uart.set_break = works;
    assert_int_equal(rig_poll(), FATHOM_PENDING);
    assert_int_equal(rig.fake.breaks, 1);
}

/* ---- setting up ---- */

TEST(a_config_that_cannot_work_is_refused_and_nothing_listens)
{
    fathom_a16_controlled_t other;
    fathom_line_listen(&rig.line, NULL);
    controlled.config.window.min_mm = 16351;
    assert_int_equal(fathom_a16_controlled_init(&other, &controlled.config), FATHOM_ERR_ARGUMENT);
    controlled.config.window.min_mm = 0;
    controlled.config.earliest_us = 131 * MS;
    assert_int_equal(fathom_a16_controlled_init(&other, &controlled.config), FATHOM_ERR_ARGUMENT);
    controlled.config.earliest_us = 0;
    controlled.config.line = NULL;
    assert_int_equal(fathom_a16_controlled_init(&other, &controlled.config), FATHOM_ERR_ARGUMENT);
    controlled.config.line = &rig.line;
    rig.fake.uart.set_break = NULL;
    assert_int_equal(fathom_a16_controlled_init(&other, &controlled.config), FATHOM_ERR_UNSUPPORTED);
    assert_null(rig.line.listener);
    controlled.config.trigger = &controlled.pin.trigger;
    assert_int_equal(fathom_a16_controlled_init(&other, &controlled.config), FATHOM_READY);
    assert_ptr_equal(rig.line.listener, &other.listener);
}

TEST(deinit_ends_the_break_and_stops_listening_unless_another_does)
{
    fathom_a16_controlled_t other;
    controlled_run_to_break(1, 100);
    assert_int_equal(fathom_a16_controlled_init(&other, &controlled.config), FATHOM_READY);
    fathom_a16_controlled_deinit(&controlled.a16);
    assert_false(rig.fake.in_break);
    assert_ptr_equal(rig.line.listener, &other.listener);
    fathom_a16_controlled_deinit(&other);
    assert_null(rig.line.listener);
}
