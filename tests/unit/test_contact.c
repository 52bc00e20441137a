/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "fathom/engine/wait.h"
#include "fathom/sensor/a05_relay.h"
#include "fathom/sensor/a16_switch.h"
#include "stream_rig.h"

enum { START_US = 1000, SETTLE_US = 20000 };
#define SECOND ((uint32_t)1000000)

/* A fine loop, one of 20 ms, and what lies between and beyond. */
static const uint32_t steps_us[] = {50, 1000, 7000, 20000, 33000};

/* Nothing special, and the wrap in what follows. */
static const uint32_t starts_us[] = {START_US, UINT32_MAX - 10000, UINT32_MAX - 60000, UINT32_MAX - 200000};

static fathom_contact_timing_t timing;
static fathom_contact_t contact;
static bool is_guard_clear;
static fathom_status_t guard_status;

static fathom_status_t guard_poll(void *ctx) { return (void)ctx, guard_status; }
static bool guard_is_clear(void *ctx, uint32_t now_us) { return (void)ctx, (void)now_us, is_guard_clear; }
static uint32_t guard_due_us(void *ctx) { return (void)ctx, FATHOM_NO_DEADLINE; }
static const fathom_contact_guard_t guard = {guard_poll, guard_is_clear, guard_due_us, NULL};

#define expect_init(status) assert_int_equal(fathom_contact_init(&contact, &timing), status)

static void init_on(uint8_t fill, const fathom_contact_guard_t *with)
{
    memset(&contact, fill, sizeof contact);
    contact.pin = &rig.pin;
    contact.clock = &rig.fake.clock;
    contact.guard = with;
    contact.near_is_high = true;
    contact.model = FATHOM_A05;
    contact.address = 7;
    expect_init(FATHOM_OK);
    rig.sensor = fathom_contact_sensor(&contact);
}

static void start_at(uint32_t now_us, bool level)
{
    rig_start(now_us);
    rig.level = level;
    init_on(0x5A, NULL);
}

static void start(void) { start_at(START_US, false); }

static int set_up_default(void **state)
{
    (void)state;
    memset(&timing, 0, sizeof timing);
    rig_seed(1);
    is_guard_clear = true;
    guard_status = FATHOM_PENDING;
    start();
    return 0;
}

static int set_up(void **state)
{
    set_up_default(state);
    timing.period_us = FATHOM_MAX_DURATION_US; /* changes alone */
    start();
    return 0;
}

static const suite_t suite = {.set_up = set_up};
static const suite_t by_default = {.set_up = set_up_default};

static fathom_status_t poll_after(uint32_t us)
{
    rig.fake.now_us += us;
    return rig_poll();
}

static void run(uint32_t ms) { rig_run(ms * MS, 1000); }

/* The next sample comes after so many ms and not before. */
static void expect_next(uint32_t ms, uint8_t kind)
{
    const unsigned samples = rig.samples;
    run(ms - 1);
    assert_int_equal(rig.samples, samples);
    run(1);
    rig_expect(samples + 1, kind);
}

#define expect_due(us) assert_int_equal(fathom_due_us(&rig.sensor, 1), us)

/* ---- readings ---- */

TEST(the_first_level_is_a_sample_when_it_has_stood_for_20_ms)
{
    const bool no = false; /* the rig hands over a sample full of A5 */
    assert_int_equal(rig_poll(), FATHOM_PENDING);
    rig.fake.now_us += SETTLE_US - 1;
    assert_int_equal(rig_poll(), FATHOM_PENDING);
    rig.fake.now_us += 1;
    assert_int_equal(rig_poll(), FATHOM_OK);
    assert_int_equal(rig.sample.kind, FATHOM_FAR);
    assert_int_equal(rig.sample.raw, 0);
    assert_int_equal(rig.sample.time_us, START_US);
    assert_int_equal(rig.sample.model, FATHOM_A05);
    assert_int_equal(rig.sample.address, 7);
    assert_int_equal(rig.sample.probe, 1);
    assert_int_equal(rig.sample.distance_mm, 0);
    assert_int_equal(rig.sample.magnitude, 0);
    assert_int_equal(rig.sample.precision, 0);
    assert_int_equal(rig.sample.ambient, 0);
    assert_memory_equal(&rig.sample.interference, &no, sizeof no);
    assert_int_equal(rig_poll(), FATHOM_PENDING);
    rig_run(60000 * MS, 20000);
    rig_expect(1, FATHOM_FAR);
    assert_int_equal(rig.stales, 0);
}

TEST(each_new_level_is_one_sample_in_any_loop_and_across_the_wrap)
{
    for (unsigned s = 0; s != COUNT(steps_us); s++) {
        for (unsigned at = 0; at != COUNT(starts_us); at++) {
            const uint32_t step_us = steps_us[s];
            start_at(starts_us[at], true);
            rig_run(100 * MS, step_us);
            rig_expect(1, FATHOM_NEAR);
            for (unsigned n = 2; n != 12; n++) {
                const uint32_t turned_us = rig.fake.now_us + 1;
                rig_turn(1);
                rig_run(SETTLE_US + 2 * step_us, step_us);
                rig_expect(n, n % 2 == 0 ? FATHOM_FAR : FATHOM_NEAR);
                assert_int_equal(rig.sample.raw, n % 2);
                /* seen by the next look after it */
                assert_true(fathom_elapsed_us(rig.sample.time_us, turned_us) < step_us);
            }
            rig_run(200 * MS, step_us);
            assert_int_equal(rig.samples, 11);
            assert_int_equal(rig.stales, 0);
        }
    }
}

TEST(a_contact_that_bounces_is_one_change)
{
    for (unsigned s = 0; s != COUNT(steps_us); s++) {
        start();
        rig_run(100 * MS, steps_us[s]);
        const uint32_t from_us = rig.fake.now_us;
        /* 13 edges within 9.1 ms */
        for (uint32_t i = 0; i != 13; i++) rig_turn(i * 700 + i % 3 * 100 + 1);
        rig_run(200 * MS, steps_us[s]);
        rig_expect(2, FATHOM_NEAR);
        assert_true(fathom_elapsed_us(rig.sample.time_us, from_us) < 9100 + steps_us[s]);
    }
}

/* ---- the meaning changes ---- */

/* fathom_contact_set_near_is_high(): "The level has to settle anew". */
TEST(a_level_settles_anew_when_it_means_something_else)
{
    assert_int_equal(poll_after(20000), FATHOM_OK);
    rig_expect(1, FATHOM_FAR);
    fathom_contact_set_near_is_high(&contact, false);
    assert_int_equal(poll_after(19999), FATHOM_PENDING);
    assert_int_equal(poll_after(1), FATHOM_OK);
    rig_expect(2, FATHOM_NEAR);
    assert_int_equal(rig.sample.time_us, START_US + 20000);
}

/* ---- repeated ---- */

TEST(with_a_period_the_level_is_repeated)
{
    for (unsigned at = 0; at != COUNT(starts_us); at++) {
        timing.period_us = 50000;
        start_at(starts_us[at], true);
        run(20);
        rig_expect(1, FATHOM_NEAR);
        expect_next(50, FATHOM_NEAR);
        assert_int_equal(rig.sample.time_us, rig.fake.now_us); /* it is so now */
        run(500);
        rig_expect(12, FATHOM_NEAR);
        rig_turn(10 * MS);
        run(30);
        rig_expect(13, FATHOM_FAR); /* a change does not wait for the period, and begins it anew */
        expect_next(50, FATHOM_FAR);
    }
}

/* ---- stale ---- */

TEST(a_level_that_never_stands_still_is_stale_every_2_s)
{
    run(50);
    rig_expect(1, FATHOM_FAR);
    for (unsigned i = 0; i != 5900; i++) {
        rig.level = !rig.level;
        run(1);
        assert_int_equal(rig.stales, i / 2000);
    }
    rig_expect(1, FATHOM_FAR);
    run(100);
    rig.level = !rig.level;
    run(2000);
    assert_int_equal(rig.stales, 2);
}

/* ---- when to look ---- */

TEST(the_next_look_is_due_in_10_ms_or_when_the_level_has_settled)
{
    expect_due(10000);
    rig_run(14 * MS, 7000);
    expect_due(6000);
    rig.fake.now_us += 2000;
    expect_due(4000);
    rig.fake.now_us += 5000;
    expect_due(0);
    assert_int_equal(rig_poll(), FATHOM_OK);
    expect_due(10000);
    rig.fake.now_us += 20000;
    expect_due(0);
}

TEST(if_an_interrupt_wakes_the_program_only_the_period_is_due_while_the_level_stands)
{
    timing.interval_us = FATHOM_NO_DEADLINE;
    start();
    expect_due(20000);
    rig_run(20 * MS, 20000);
    assert_int_equal(rig.samples, 1);
    expect_due(FATHOM_MAX_DURATION_US);
    rig_turn(0);
    rig_poll();
    expect_due(20000);
    rig_run(20 * MS, 20000);
    assert_int_equal(rig.samples, 2);
    timing.period_us = 500000;
    start();
    rig_run(20 * MS, 20000);
    expect_due(500000);
}

/* ---- init ---- */

static void expect_refused(const fathom_pin_t *pin, const fathom_clock_t *clock,
                           const fathom_contact_guard_t *with)
{
    const fathom_contact_t zeroed = {0};
    memset(&contact, 0x5A, sizeof contact);
    contact.pin = pin;
    contact.clock = clock;
    contact.guard = with;
    expect_init(FATHOM_ERR_ARGUMENT);
    assert_memory_equal(&contact, &zeroed, sizeof zeroed);
}

TEST(init_refuses_what_it_cannot_read_and_leaves_the_contact_zeroed)
{
    const fathom_pin_t output = {NULL, NULL, NULL};
    const fathom_clock_t still = {NULL, NULL};
    const fathom_contact_guard_t guards[] = {
        {NULL, guard_is_clear, guard_due_us, NULL},
        {guard_poll, NULL, guard_due_us, NULL},
        {guard_poll, guard_is_clear, NULL, NULL},
    };
    expect_refused(NULL, &rig.fake.clock, NULL);
    expect_refused(&output, &rig.fake.clock, NULL);
    expect_refused(&rig.pin, NULL, NULL);
    expect_refused(&rig.pin, &still, NULL);
    for (unsigned i = 0; i != COUNT(guards); i++) expect_refused(&rig.pin, &rig.fake.clock, &guards[i]);
}

/* ---- everything, against a slow reference ---- */

enum { LOOKS = 14 };

/* The kind that is said at look `n`, or 0: from all levels seen so far, anew each time. */
static uint8_t refer(unsigned levels, unsigned n, uint32_t step_us)
{
    uint8_t last = 0;
    for (unsigned at = 0; at <= n; at++) {
        unsigned from = at;
        while (from != 0 && (levels >> (from - 1) & 1) == (levels >> at & 1)) from--;
        const uint8_t kind = (levels >> at & 1) != 0 ? FATHOM_NEAR : FATHOM_FAR;
        const bool says = (at - from) * step_us >= SETTLE_US && kind != last;
        if (says) last = kind;
        if (at == n) return says ? kind : 0;
    }
    return 0;
}

TEST(every_sequence_of_levels_at_14_looks_is_right)
{
    for (unsigned s = 0; s != COUNT(steps_us); s++) {
        const uint32_t step_us = steps_us[s];
        for (unsigned levels = 0; levels != 1u << LOOKS; levels++) {
            start_at(UINT32_MAX - 3 * step_us, (levels & 1) != 0); /* init is the first look */
            for (unsigned n = 1; n != LOOKS; n++) {
                rig.level = (levels >> n & 1) != 0;
                rig.fake.now_us += step_us;
                const uint8_t kind = refer(levels, n, step_us);
                if (rig_poll() != (kind != 0 ? FATHOM_OK : FATHOM_PENDING)) fail();
                if (kind != 0 && rig.sample.kind != kind) fail();
            }
        }
    }
}

/* sensor.h: as fathom_poll() and fathom_due_us() with the contact's sensor. The level settles in 20 ms. */
TEST(a_contact_is_polled_without_a_sensor_too)
{
    fathom_sample_t sample;
    start_at(START_US, true);
    assert_int_equal(fathom_contact_poll(&contact, &sample), FATHOM_PENDING);
    assert_int_equal(fathom_contact_due_us(&contact), fathom_due_us(&rig.sensor, 1));
    for (unsigned ms = 0; ms != 25 && fathom_contact_poll(&contact, &sample) == FATHOM_PENDING; ms++)
        rig.fake.now_us += 1000;
    assert_int_equal(sample.address, 7);
}

/* ---- the limits, to the microsecond ---- */

/* "stale_us ... 0: 2 s": "no level has counted for so long ... or it is held". */
TEST_IN(by_default, without_a_level_that_counts_it_is_stale_after_2_s)
{
    fathom_contact_set_hold(&contact, true);
    assert_int_equal(poll_after(1999999), FATHOM_PENDING);
    assert_int_equal(poll_after(1), FATHOM_ERR_STALE);
}

/* "FATHOM_OK: a sample: the first level that counts", whatever the memory held: of a sample that was FATHOM_NEAR,
 * too. */
TEST_IN(by_default, the_first_level_is_told_whatever_stood_in_the_memory)
{
    static const uint8_t fills[] = {FATHOM_NEAR, FATHOM_FAR, 0xFF, true}; /* held, too */
    for (unsigned level = 0; level != 2; level++)
        for (unsigned i = 0; i != sizeof fills; i++) {
            rig_start(START_US);
            rig.level = level != 0;
            init_on(fills[i], NULL);
            poll_after(10000);
            assert_int_equal(poll_after(10000), FATHOM_OK);
            rig_expect(1, level != 0 ? FATHOM_NEAR : FATHOM_FAR);
        }
}

/* "The longest that due_us advises between looks". */
TEST_IN(by_default, the_next_look_is_due_look_us_after_the_last_one)
{
    timing.interval_us = 100000;
    init_on(0, NULL);
    assert_int_equal(poll_after(20000), FATHOM_OK);
    expect_due(100000);
    rig.fake.now_us += 70000;
    expect_due(30000);
    rig.fake.now_us += 30001;
    expect_due(0);
}

/* "the level is not looked at ... until 5 ms after the last byte". The first look at which it is looked at is at 5000
 * us, and with a settle_us of 1 the next look 1 us later is enough. */
TEST_IN(by_default, a_level_counts_again_5_ms_after_the_last_byte_on_its_line)
{
    static const uint8_t byte[] = {0x00};
    const fathom_contact_guard_t of_line = fathom_contact_line_guard(&rig.line);
    rig.line_parts.echo = FATHOM_LINE_ECHO_OFF;
    assert_int_equal(fathom_line_init(&rig.line, &rig.line_parts), FATHOM_OK);
    timing.settle_us = 1;
    init_on(0, &of_line);
    fake_receive(&rig.fake, 100, byte, 1);
    assert_int_equal(poll_after(100), FATHOM_PENDING);
    assert_int_equal(poll_after(4999), FATHOM_PENDING);
    assert_int_equal(poll_after(1), FATHOM_PENDING);
    assert_int_equal(poll_after(1), FATHOM_OK);
    assert_int_equal(rig.sample.time_us, START_US + 100 + 5000);
}

/*
 * contact.h: a program that polls gets a sample or an error within the bound of the header, whatever the pin, the guard
 * and the clock do, and no sample is of a level that was read earlier.
 */

/* ---- a contact that never changes ---- */

TEST_IN(by_default, by_default_a_level_that_does_not_change_is_a_sample_each_second)
{
    rig_run(20 * MS, 1 * MS);
    rig_expect(1, FATHOM_FAR);
    for (unsigned n = 2; n != 12; n++) {
        rig_run(999 * MS, 1 * MS);
        rig_expect(n - 1, FATHOM_FAR);
        rig_run(1 * MS, 1 * MS);
        rig_expect(n, FATHOM_FAR);
        assert_int_equal(rig.sample.time_us, rig.fake.now_us);
    }
    assert_int_equal(rig.stales, 0);
}

/* ---- a level that does not count ---- */

TEST_IN(by_default, the_error_of_a_guard_is_returned_if_there_is_nothing_else)
{
    guard_status = FATHOM_ERR_PORT;
    init_on(0x5A, &guard);
    for (unsigned n = 0; n != 3; n++) assert_int_equal(poll_after(1 * MS), FATHOM_ERR_PORT);
    /* The first look found the guard clear, and 2 ms have passed since. */
    assert_int_equal(poll_after(18 * MS - 1), FATHOM_ERR_PORT);
    assert_int_equal(poll_after(1), FATHOM_OK);
}

TEST_IN(by_default, a_hold_that_does_not_end_is_stale_every_2_s)
{
    rig_run(20 * MS, 1 * MS);
    fathom_contact_set_hold(&contact, true);
    rig_run(10 * SECOND, 1 * MS);
    assert_int_equal(rig.stales, 4); /* the level counted until the look before the hold */
    assert_int_equal(rig.samples, 1);
}

/* ---- age ---- */

/* 300 s lie between the first look that saw the level and the look at which it counts. */
TEST_IN(by_default, a_level_that_counts_after_a_sleep_is_of_now)
{
    rig_run(20 * MS, 1 * MS);
    rig_expect(1, FATHOM_FAR);
    rig.level = true;
    rig_run(1 * MS, 1 * MS);
    assert_int_equal(poll_after(300 * SECOND), FATHOM_OK);
    rig_expect(2, FATHOM_NEAR);
    assert_int_equal(rig.sample.time_us, rig.fake.now_us);
}

/* "if ... that look was at most stale_us ago" */
TEST_IN(by_default, the_first_look_is_the_time_of_a_sample_for_up_to_2_s)
{
    for (uint32_t late_us = 0; late_us != 2; late_us++) {
        start();
        assert_int_equal(poll_after(2 * SECOND + late_us), FATHOM_OK);
        assert_int_equal(rig.sample.time_us, late_us == 0 ? START_US : rig.fake.now_us);
    }
}

/* ---- any of it ---- */

/* "period_us + stale_us + 2 * P", by the clock and without its jumps. */
static void run_world(uint32_t world)
{
    static const uint32_t any_steps_us[] = {100, 3000, 30000, 300000, 3000000, 600000000};
    memset(&timing, 0, sizeof timing);
    if (rig_random_below(2) == 0) timing.settle_us = 1 + rig_random_below(100000);
    if (rig_random_below(2) == 0) timing.stale_us = 100001 + rig_random_below(5000000);
    if (rig_random_below(2) == 0) timing.period_us = 1 + rig_random_below(5000000);
    const fathom_contact_guard_t *const with = rig_random_below(2) == 0 ? &guard : NULL;
    rig_start(rig_random_below(UINT32_MAX));
    init_on(0x5A, with);
    const uint32_t bound_us = contact.timing.period_us + contact.timing.stale_us;
    uint32_t longest_us = 0;
    uint32_t since_us = 0;
    bool is_held = false;
    for (unsigned polls = 0; polls != 500; polls++) {
        const uint32_t step_us = 1 + rig_random_below(any_steps_us[world % COUNT(any_steps_us)]);
        if (step_us > longest_us) longest_us = step_us;
        rig.fake.now_us += step_us;
        since_us += step_us;
        if (rig_random_below(20) == 0) {
            const uint32_t back_us = rig_random_below(100001);
            rig.fake.now_us -= back_us;
            since_us = since_us > back_us ? since_us - back_us : 0;
        }
        if (rig_random_below(world % 7 + 1) == 0) rig.level = !rig.level;
        if (rig_random_below(20) == 0) is_guard_clear = !is_guard_clear;
        if (rig_random_below(50) == 0) fathom_contact_set_hold(&contact, is_held = !is_held);
        if (rig_poll() != FATHOM_PENDING) since_us = 0;
        if (rig.samples != 0 && since_us == 0) assert_true(rig.sample.raw <= 1);
        if (since_us > bound_us + 2 * longest_us)
            fail_msg("world %lu: nothing in %lu us", (unsigned long)world, (unsigned long)since_us);
    }
}

TEST_IN(by_default, any_levels_any_guard_any_polls_and_any_clock_have_an_outcome_within_the_bound)
{
    const uint32_t worlds = suite_is_long ? 100000 : 1000;
    for (uint32_t world = 0; world != worlds; world++) run_world(world);
}

/* ---- fathom_wait ---- */

static fathom_status_t wait_for(void (*idle)(void *ctx, uint32_t max_us))
{
    fathom_sample_t sample;
    return fathom_wait(&rig.sensor, &sample, idle, NULL);
}

static void stand_still(void *ctx, uint32_t max_us) { (void)ctx, rig.fake.now_us += max_us; }

TEST_IN(by_default, wait_returns_for_a_contact_that_never_changes)
{
    timing.interval_us = FATHOM_NO_DEADLINE;
    timing.period_us = FATHOM_MAX_DURATION_US;
    start();
    for (unsigned n = 0; n != 5; n++) assert_int_equal(wait_for(stand_still), FATHOM_OK);
    /* 20 ms and 4 times 35 minutes */
    assert_true(rig.fake.now_us == (uint32_t)(START_US + 20 * MS + 4ull * FATHOM_MAX_DURATION_US));
}

/* ---- zeroed memory ---- */

TEST_IN(by_default, a_contact_without_init_has_an_error_in_each_poll_and_no_function_is_called)
{
    fathom_sample_t sample;
    memset(&contact, 0, sizeof contact);
    assert_int_equal(rig_poll(), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 0);
    contact.pin = &rig.pin; /* and without the clock that it would read */
    assert_int_equal(rig_poll(), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 0);
    fathom_contact_set_hold(&contact, true);
    fathom_contact_set_near_is_high(&contact, true);
    static fathom_a05_relay_t relay;
    static fathom_a16_switch_t switch_of_a16;
    const fathom_sensor_t sensors[] = {
        fathom_a05_relay_sensor(&relay), fathom_a16_switch_sensor(&switch_of_a16), {NULL, NULL, NULL}};
    for (unsigned i = 0; i != COUNT(sensors); i++) {
        assert_int_equal(fathom_poll(&sensors[i], &sample), FATHOM_ERR_ARGUMENT);
        assert_int_equal(fathom_due_us(&sensors[i], 1), 0);
    }
}
