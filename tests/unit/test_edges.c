/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/engine/edges.h"

static fathom_edges_t edges;
static fathom_capture_t capture;
static fathom_pulse_t pulse;
static bool level;

static bool get(void *ctx) { return *(const bool *)ctx; }

static const fathom_pin_t pin = {NULL, get, &level};

static void init_on(uint8_t fill)
{
    memset(&edges, fill, sizeof edges);
    fathom_edges_init(&edges, NULL);
    capture = fathom_edges_capture(&edges);
}

static int set_up(void **state)
{
    init_on(0x5A);
    capture.arm(capture.ctx);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static void rise(uint32_t at_us) { fathom_edges_feed(&edges, true, at_us); }
static void fall(uint32_t at_us) { fathom_edges_feed(&edges, false, at_us); }
static void feed(uint32_t rise_us, uint32_t fall_us)
{
    rise(rise_us);
    fall(fall_us);
}

static int take(void) { return capture.take(capture.ctx, &pulse); }
static void arm(void) { capture.arm(capture.ctx); }

#define expect_none() assert_int_equal(take(), 0)

static void assert_pulse(uint32_t width_us, uint32_t end_us)
{
    assert_int_equal(take(), 1);
    assert_int_equal(pulse.width_us, width_us);
    assert_int_equal(pulse.end_us, end_us);
}

/* "the line is taken as low until the first edge": a fall is the end of nothing. */
TEST(new_edges_hold_no_pulse_and_a_fall_makes_none_whatever_the_memory_held)
{
    static const uint8_t fills[] = {0x00, 0x01, 0xA5, 0xFF};
    for (unsigned i = 0; i != sizeof fills; i++) {
        init_on(fills[i]);
        expect_none();
        assert_false(pulse.is_high);
        assert_int_equal(edges.lost, 0);
        assert_int_equal(edges.missed, 0);
        assert_int_equal(edges.same_us, FATHOM_EDGES_DEFAULT_SAME_US);
        init_on(fills[i]);
        fall(5000);
        expect_none();
    }
}

TEST(a_rise_and_a_fall_are_a_pulse)
{
    expect_none();
    assert_false(pulse.is_high);
    rise(1000);
    expect_none();
    assert_true(pulse.is_high);
    fall(11000);
    assert_pulse(10000, 11000);
    assert_false(pulse.is_high);
    expect_none();
}

TEST(pulses_come_out_in_their_order_and_the_fifth_is_dropped_and_counted)
{
    for (uint32_t i = 1; i <= 6; i++) feed(i * 1000, i * 1000 + i);
    assert_int_equal(edges.lost, 2);
    for (uint32_t i = 1; i <= 4; i++) assert_pulse(i, i * 1000 + i);
    expect_none();
    feed(9000, 9009);
    assert_pulse(9, 9009);
}

TEST(a_clock_that_is_set_back_within_a_pulse_makes_a_width_of_0)
{
    feed(6000, 5999);
    assert_pulse(0, 5999);
    feed(205999, 106000); /* by 99999 us */
    assert_pulse(0, 106000);
}

TEST(many_pulses_go_through_as_the_counts_wrap)
{
    for (uint32_t i = 0; i != 1000; i++) {
        if (i % 50 == 0) arm();
        feed(i * 100, i * 100 + i % 90);
        assert_pulse(i % 90, i * 100 + i % 90);
    }
    assert_int_equal(edges.lost, 0);
    assert_int_equal(edges.missed, 0);
}

/* ---- arm ---- */

TEST(arm_forgets_what_was_captured)
{
    feed(100, 200);
    feed(300, 400);
    arm();
    expect_none();
    feed(500, 600);
    assert_pulse(100, 600);
}

TEST(arm_makes_room)
{
    for (uint32_t i = 1; i <= 4; i++) feed(i * 1000, i * 1000 + i);
    arm();
    feed(9000, 9009);
    assert_pulse(9, 9009);
    assert_int_equal(edges.lost, 0);
}

TEST(a_pulse_that_began_before_arm_does_not_count)
{
    rise(100);
    arm();
    fall(20100);
    expect_none();
    feed(30000, 30010);
    assert_pulse(10, 30010);
}

/* A line that is stuck high for long sees arm more often than a byte can count. */
TEST(a_pulse_that_began_before_257_arms_does_not_count)
{
    for (unsigned arms = 255; arms <= 257; arms++) {
        rise(100);
        for (unsigned i = 0; i != arms; i++) arm();
        fall(20100);
        expect_none();
    }
}

TEST(a_pin_without_get_is_no_pin)
{
    const fathom_pin_t output = {NULL, NULL, NULL};
    fathom_edges_init(&edges, &output);
    rise(100);
    expect_none();
    assert_true(pulse.is_high);
}

TEST(it_is_full_when_the_next_pulse_would_be_lost)
{
    for (uint32_t i = 1; i <= FATHOM_EDGES_PULSES; i++) {
        assert_false(fathom_edges_is_full(&edges));
        feed(i * 1000, i * 1000 + i);
    }
    assert_true(fathom_edges_is_full(&edges));
    assert_int_equal(take(), 1);
    assert_false(fathom_edges_is_full(&edges));
}

/* ---- doubled and missed edges ---- */

TEST(a_rise_seen_twice_within_50_us_is_one_and_the_first_counts)
{
    rise(UINT32_MAX - 20);
    rise(10);
    rise(29); /* 50 us after the first */
    fall(9979);
    assert_pulse(10000, 9979);
    assert_int_equal(edges.missed, 0);
}

TEST(a_fall_seen_twice_is_one_and_the_first_counts)
{
    feed(1000, 11000);
    fall(11010);
    fall(15000);
    assert_pulse(10000, 11000);
    expect_none();
}

TEST(rises_without_a_fall_are_counted_once)
{
    rise(1000);
    rise(1051);
    rise(1052);
    feed(9000, 11000);
    expect_none();
    assert_int_equal(edges.missed, 1);
}

TEST(a_rise_that_was_missed_loses_its_pulse_and_no_other)
{
    fall(1000);
    feed(2000, 2500);
    fall(4000);
    feed(5000, 5600);
    assert_pulse(500, 2500);
    assert_pulse(600, 5600);
    expect_none();
}

TEST(the_time_within_which_edges_are_the_same_is_the_users)
{
    edges.same_us = 10;
    rise(1000);
    feed(1010, 2000);
    assert_pulse(1000, 2000);
    rise(3000);
    feed(3011, 4000);
    expect_none();
}

TEST(the_counts_of_what_went_wrong_stop_at_255)
{
    for (uint32_t i = 0; i != 300; i++) {
        rise(i * 1000);
        feed(i * 1000 + 100, i * 1000 + 200);
        feed(i * 1000 + 300, i * 1000 + 400);
    }
    assert_int_equal(edges.missed, 255);
    assert_int_equal(edges.lost, 255);
}

/* ---- the level ---- */

TEST(with_a_pin_the_level_is_its_and_not_that_of_the_last_edge)
{
    level = false;
    fathom_edges_init(&edges, &pin);
    arm();
    rise(1000); /* the fall is missed */
    expect_none();
    assert_false(pulse.is_high);
    level = true;
    expect_none();
    assert_true(pulse.is_high);
}
