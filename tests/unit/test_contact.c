/* SPDX-License-Identifier: MIT */
#include "contact_rig.h"
#include "fathom/contact.h"

#define MS ((int32_t)1000) /* an int may have 16 bits */
enum { START_US = 1000, SETTLE_US = 20000 };

/* A fine loop, one of 20 ms, and what lies between and beyond. */
static const uint32_t steps_us[] = {50, 1000, 7000, 20000, 33000};
enum { STEPS = sizeof steps_us / sizeof *steps_us };

/* Nothing special, and the wrap in what follows. */
static const uint32_t starts_us[] = {START_US, UINT32_MAX - 10000, UINT32_MAX - 60000, UINT32_MAX - 200000};
enum { STARTS = sizeof starts_us / sizeof *starts_us };

static fathom_contact_timing_t timing;
static bool near_is_high;
static fathom_contact_t contact;

static void start_at(uint32_t now_us, bool level)
{
    pins_start(now_us);
    pins.level = level;
    memset(&contact, 0x5A, sizeof contact);
    contact.pin = &pins.pin;
    contact.clock = &pins.fake.clock;
    contact.line = NULL;
    contact.near_is_high = near_is_high;
    contact.model = FATHOM_A05;
    contact.unit = 7;
    assert_int_equal(fathom_contact_init(&contact, &timing), FATHOM_READY);
    pins.sensor = fathom_contact_sensor(&contact);
}

static void start(void) { start_at(START_US, false); }

static int set_up(void **state)
{
    memset(&timing, 0, sizeof timing);
    near_is_high = true;
    start();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static uint32_t due_us(void) { return fathom_due_us(&pins.sensor, 1); }

/* ---- readings ---- */

TEST(the_first_level_is_a_sample_when_it_has_stood_for_20_ms)
{
    assert_int_equal(pins_poll(), FATHOM_PENDING);
    pins.fake.now_us += SETTLE_US - 1;
    assert_int_equal(pins_poll(), FATHOM_PENDING);
    pins.fake.now_us += 1;
    assert_int_equal(pins_poll(), FATHOM_READY);
    assert_int_equal(pins.sample.kind, FATHOM_FAR);
    assert_int_equal(pins.sample.raw, 0);
    assert_int_equal(pins.sample.time_us, START_US);
    assert_int_equal(pins.sample.model, FATHOM_A05);
    assert_int_equal(pins.sample.unit, 7);
    assert_int_equal(pins.sample.probe, 1);
    assert_int_equal(pins.sample.distance_mm, 0);
    assert_int_equal(pins.sample.magnitude + pins.sample.precision + pins.sample.ambient, 0);
    assert_false(pins.sample.interference);
    assert_int_equal(pins_poll(), FATHOM_PENDING);
    pins_run(60000 * MS, 20000);
    pins_expect(1, FATHOM_FAR);
    assert_int_equal(pins.stales, 0);
}

TEST(each_new_level_is_one_sample_in_any_loop_and_across_the_wrap)
{
    for (unsigned s = 0; s != STEPS; s++) {
        for (unsigned at = 0; at != STARTS; at++) {
            const uint32_t step_us = steps_us[s];
            start_at(starts_us[at], true);
            pins_run(100 * MS, step_us);
            pins_expect(1, FATHOM_NEAR);
            for (unsigned n = 2; n != 12; n++) {
                const uint32_t turned_us = pins.fake.now_us + 1;
                pins_turn(1);
                pins_run(SETTLE_US + 2 * step_us, step_us);
                pins_expect(n, n % 2 == 0 ? FATHOM_FAR : FATHOM_NEAR);
                assert_int_equal(pins.sample.raw, n % 2);
                /* seen by the next look after it */
                assert_true(fathom_elapsed_us(pins.sample.time_us, turned_us) < step_us);
            }
            pins_run(200 * MS, step_us);
            assert_int_equal(pins.samples, 11);
            assert_int_equal(pins.stales, 0);
        }
    }
}

TEST(a_contact_that_bounces_is_one_change)
{
    for (unsigned s = 0; s != STEPS; s++) {
        start();
        pins_run(100 * MS, steps_us[s]);
        const uint32_t from_us = pins.fake.now_us;
        /* 13 edges within 9.1 ms */
        for (uint32_t i = 0; i != 13; i++) pins_turn(i * 700 + i % 3 * 100 + 1);
        pins_run(200 * MS, steps_us[s]);
        pins_expect(2, FATHOM_NEAR);
        assert_true(fathom_elapsed_us(pins.sample.time_us, from_us) < 9100 + steps_us[s]);
    }
}

TEST(a_level_that_does_not_stand_for_20_ms_is_nothing)
{
    pins_run(100 * MS, 1000);
    for (uint32_t i = 0; i != 5; i++) {
        pins_turn(1000 + i * 50000);
        pins_turn(20000 + i * 50000);
    }
    pins_run(300 * MS, 1000);
    pins_expect(1, FATHOM_FAR);
    pins_turn(1000);
    pins_turn(22000);
    pins_run(20 * MS, 1000);
    pins_expect(1, FATHOM_FAR);
    pins_run(1 * MS, 1000);
    pins_expect(2, FATHOM_NEAR);
    pins_run(30 * MS, 1000);
    pins_expect(3, FATHOM_FAR);
}

TEST(how_long_a_level_stands_is_an_option)
{
    timing.settle_us = 1;
    start();
    assert_int_equal(pins_poll(), FATHOM_PENDING); /* no time has passed */
    pins_run(50, 50);
    pins_expect(1, FATHOM_FAR);
    pins_turn(50);
    pins_run(100, 50);
    pins_expect(2, FATHOM_NEAR);
    timing.settle_us = 300000;
    start();
    pins_run(299 * MS, 1000);
    assert_int_equal(pins.samples, 0);
    pins_run(1 * MS, 1000);
    assert_int_equal(pins.samples, 1);
}

TEST(what_a_high_level_means_is_an_option)
{
    near_is_high = false;
    start();
    pins_run(20 * MS, 1000);
    pins_expect(1, FATHOM_NEAR);
    assert_int_equal(pins.sample.raw, 0);
    pins_turn(0);
    pins_run(21 * MS, 1000);
    pins_expect(2, FATHOM_FAR);
    assert_int_equal(pins.sample.raw, 1);
}

/* ---- the meaning changes ---- */

TEST(a_meaning_and_a_level_that_turn_together_are_no_change)
{
    pins_run(50 * MS, 1000);
    pins_expect(1, FATHOM_FAR);
    fathom_contact_set_near_is_high(&contact, false);
    pins_turn(15 * MS);
    pins_run(500 * MS, 1000);
    pins_expect(1, FATHOM_FAR);
    pins_turn(0);
    pins_run(50 * MS, 1000);
    pins_expect(2, FATHOM_NEAR);
    assert_int_equal(pins.sample.raw, 0);
}

TEST(a_level_that_stays_when_the_meaning_turns_is_a_change_after_it_has_settled)
{
    pins_run(50 * MS, 1000);
    fathom_contact_set_near_is_high(&contact, false);
    pins_run(19 * MS, 1000);
    pins_expect(1, FATHOM_FAR);
    pins_run(1 * MS, 1000);
    pins_expect(2, FATHOM_NEAR);
}

/* ---- repeated ---- */

TEST(with_a_period_the_level_is_repeated)
{
    for (unsigned at = 0; at != STARTS; at++) {
        timing.period_us = 50000;
        start_at(starts_us[at], true);
        pins_run(20 * MS, 1000);
        pins_expect(1, FATHOM_NEAR);
        pins_run(49 * MS, 1000);
        assert_int_equal(pins.samples, 1);
        pins_run(1 * MS, 1000);
        pins_expect(2, FATHOM_NEAR);
        assert_int_equal(pins.sample.time_us, pins.fake.now_us); /* it is so now */
        pins_run(500 * MS, 1000);
        pins_expect(12, FATHOM_NEAR);
        pins_turn(10 * MS);
        pins_run(30 * MS, 1000);
        pins_expect(13, FATHOM_FAR); /* a change does not wait for the period, and begins it anew */
        pins_run(49 * MS, 1000);
        assert_int_equal(pins.samples, 13);
        pins_run(1 * MS, 1000);
        pins_expect(14, FATHOM_FAR);
    }
}

TEST(a_level_that_is_settling_is_not_repeated)
{
    timing.period_us = 50000;
    start();
    pins_run(20 * MS, 1000);
    pins_expect(1, FATHOM_FAR);
    /* it flickers from 40 ms after that to 80 ms */
    for (uint32_t i = 0; i != 20; i++) pins_turn(40 * MS + i * 2000);
    pins_run(97 * MS, 1000);
    assert_int_equal(pins.samples, 1);
    pins_run(1 * MS, 1000);
    pins_expect(2, FATHOM_FAR);
}

/* ---- stale ---- */

TEST(a_level_that_never_stands_still_is_stale_every_2_s)
{
    pins_run(50 * MS, 1000);
    pins_expect(1, FATHOM_FAR);
    for (unsigned i = 0; i != 5900; i++) {
        pins.level = !pins.level;
        pins.fake.now_us += 1000;
        pins_poll();
        assert_int_equal(pins.stales, i / 2000);
    }
    pins_expect(1, FATHOM_FAR);
    pins_run(100 * MS, 1000);
    pins.level = !pins.level;
    pins_run(2000 * MS, 1000);
    assert_int_equal(pins.stales, 2);
}

TEST(when_it_is_stale_is_an_option)
{
    timing.stale_us = 100000;
    start();
    for (unsigned i = 0; i != 110; i++) {
        pins.level = !pins.level;
        pins.fake.now_us += 1000;
        pins_poll();
        assert_int_equal(pins.stales, i >= 99);
    }
}

/* A change that is first seen after a long pause has not flickered for that long. */
TEST(a_loop_slower_than_the_limit_does_not_make_a_level_stale)
{
    pins_run(9000 * MS, 3000 * MS);
    for (unsigned i = 0; i != 10; i++) {
        pins_turn(1000);
        pins_run(9000 * MS, 3000 * MS);
    }
    assert_int_equal(pins.samples, 11);
    assert_int_equal(pins.stales, 0);
    for (unsigned i = 0; i != 10; i++) {
        pins.level = !pins.level;
        pins_run(3000 * MS, 3000 * MS);
    }
    assert_int_equal(pins.stales, 9);
}

/* ---- when to look ---- */

TEST(the_next_look_is_due_in_10_ms_or_when_the_level_has_settled)
{
    assert_int_equal(due_us(), 10000);
    pins_run(14 * MS, 7000);
    assert_int_equal(due_us(), 6000);
    pins.fake.now_us += 2000;
    assert_int_equal(due_us(), 4000);
    pins.fake.now_us += 5000;
    assert_int_equal(due_us(), 0);
    assert_int_equal(pins_poll(), FATHOM_READY);
    assert_int_equal(due_us(), 10000);
    pins.fake.now_us += 20000;
    assert_int_equal(due_us(), 0);
}

TEST(where_an_interrupt_wakes_the_program_nothing_is_due_while_the_level_stands)
{
    timing.look_us = FATHOM_NO_DEADLINE;
    start();
    assert_int_equal(due_us(), 20000);
    pins_run(20 * MS, 20000);
    assert_int_equal(pins.samples, 1);
    assert_int_equal(due_us(), FATHOM_NO_DEADLINE);
    pins_turn(0);
    pins_poll();
    assert_int_equal(due_us(), 20000);
    pins_run(20 * MS, 20000);
    assert_int_equal(pins.samples, 2);
    timing.period_us = 500000;
    start();
    pins_run(20 * MS, 20000);
    assert_int_equal(due_us(), 500000);
}

TEST(a_loop_that_sleeps_until_it_is_due_misses_nothing)
{
    timing.period_us = 45000;
    start_at(UINT32_MAX - 500 * MS, false);
    pins_turn(100 * MS);
    pins_turn(333 * MS);
    const uint32_t from_us = pins.fake.now_us;
    unsigned looks = 0;
    for (; fathom_elapsed_us(pins.fake.now_us, from_us) < 1000 * MS; looks++) {
        pins.fake.now_us += due_us();
        pins_poll();
    }
    /* At 20, 65; changed by 130, 175, ..; and so on: one in 45 ms and the changes */
    assert_in_range(pins.samples, 22, 25);
    assert_in_range(looks, 100, 130);
    assert_int_equal(pins.sample.kind, FATHOM_FAR);
}

/* ---- init ---- */

TEST(init_refuses_what_it_cannot_read)
{
    const fathom_pin_t output = {NULL, NULL, NULL};
    contact.pin = NULL;
    assert_int_equal(fathom_contact_init(&contact, &timing), FATHOM_ERR_ARGUMENT);
    contact.pin = &output;
    assert_int_equal(fathom_contact_init(&contact, &timing), FATHOM_ERR_ARGUMENT);
    contact.pin = &pins.pin;
    contact.clock = NULL;
    assert_int_equal(fathom_contact_init(&contact, &timing), FATHOM_ERR_ARGUMENT);
    contact.clock = &pins.fake.clock;
    assert_int_equal(fathom_contact_init(&contact, &timing), FATHOM_READY);
}

/* ---- everything, against a slow reference ---- */

enum { LOOKS = 14 };

/* The kind that is said at look `n`, or 0: from all levels seen so far, anew each time. */
static uint8_t refer(unsigned levels, unsigned n, uint32_t step_us)
{
    uint8_t said = 0;
    for (unsigned at = 0; at <= n; at++) {
        unsigned from = at;
        while (from != 0 && (levels >> (from - 1) & 1) == (levels >> at & 1)) from--;
        const uint8_t kind = (levels >> at & 1) != 0 ? FATHOM_NEAR : FATHOM_FAR;
        const bool says = (at - from) * step_us >= SETTLE_US && kind != said;
        if (says) said = kind;
        if (at == n) return says ? kind : 0;
    }
    return 0;
}

TEST(every_sequence_of_levels_at_14_looks_is_right)
{
    for (unsigned s = 0; s != STEPS; s++) {
        const uint32_t step_us = steps_us[s];
        for (unsigned levels = 0; levels != 1u << LOOKS; levels++) {
            start_at(UINT32_MAX - 3 * step_us, (levels & 1) != 0); /* init is the first look */
            for (unsigned n = 1; n != LOOKS; n++) {
                pins.level = (levels >> n & 1) != 0;
                pins.fake.now_us += step_us;
                const uint8_t kind = refer(levels, n, step_us);
                if (pins_poll() != (kind != 0 ? FATHOM_READY : FATHOM_PENDING)) fail();
                if (kind != 0 && pins.sample.kind != kind) fail();
            }
        }
    }
}
