/* SPDX-License-Identifier: MIT */
#include "contact_rig.h"
#include "fathom/engine/contact.h"

#define MS ((int32_t)1000) /* an int may have 16 bits */
enum { START_US = 1000, SETTLE_US = 20000 };

#define COUNT_OF(array) (sizeof(array) / sizeof *(array))

/* A fine loop, one of 20 ms, and what lies between and beyond. */
static const uint32_t steps_us[] = {50, 1000, 7000, 20000, 33000};

/* Nothing special, and the wrap in what follows. */
static const uint32_t starts_us[] = {START_US, UINT32_MAX - 10000, UINT32_MAX - 60000, UINT32_MAX - 200000};

static fathom_contact_timing_t timing;
static bool near_is_high;
static fathom_contact_t contact;

#define expect_init(status) assert_int_equal(fathom_contact_init(&contact, &timing), status)

static void start_at(uint32_t now_us, bool level)
{
    pins_start(now_us);
    pins.level = level;
    memset(&contact, 0x5A, sizeof contact);
    contact.pin = &pins.pin;
    contact.clock = &pins.fake.clock;
    contact.guard = NULL;
    contact.near_is_high = near_is_high;
    contact.model = FATHOM_A05;
    contact.address = 7;
    expect_init(FATHOM_OK);
    pins.sensor = fathom_contact_sensor(&contact);
}

static void start(void) { start_at(START_US, false); }

static int set_up(void **state)
{
    memset(&timing, 0, sizeof timing);
    timing.period_us = FATHOM_MAX_DURATION_US; /* changes alone */
    near_is_high = true;
    start();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static void run(uint32_t ms) { pins_run(ms * MS, 1000); }

/* The next sample comes after so many ms and not before. */
static void expect_next(uint32_t ms, uint8_t kind)
{
    const unsigned samples = pins.samples;
    run(ms - 1);
    assert_int_equal(pins.samples, samples);
    run(1);
    pins_expect(samples + 1, kind);
}

#define expect_due(us) assert_int_equal(fathom_due_us(&pins.sensor, 1), us)

/* ---- readings ---- */

TEST(the_first_level_is_a_sample_when_it_has_stood_for_20_ms)
{
    assert_int_equal(pins_poll(), FATHOM_PENDING);
    pins.fake.now_us += SETTLE_US - 1;
    assert_int_equal(pins_poll(), FATHOM_PENDING);
    pins.fake.now_us += 1;
    assert_int_equal(pins_poll(), FATHOM_OK);
    assert_int_equal(pins.sample.kind, FATHOM_FAR);
    assert_int_equal(pins.sample.raw, 0);
    assert_int_equal(pins.sample.time_us, START_US);
    assert_int_equal(pins.sample.model, FATHOM_A05);
    assert_int_equal(pins.sample.address, 7);
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
    for (unsigned s = 0; s != COUNT_OF(steps_us); s++) {
        for (unsigned at = 0; at != COUNT_OF(starts_us); at++) {
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
    for (unsigned s = 0; s != COUNT_OF(steps_us); s++) {
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

/* ---- the meaning changes ---- */

TEST(a_level_that_stays_when_the_meaning_turns_is_a_change_after_it_has_settled)
{
    run(50);
    fathom_contact_set_near_is_high(&contact, false);
    expect_next(20, FATHOM_NEAR);
}

/* ---- repeated ---- */

TEST(with_a_period_the_level_is_repeated)
{
    for (unsigned at = 0; at != COUNT_OF(starts_us); at++) {
        timing.period_us = 50000;
        start_at(starts_us[at], true);
        run(20);
        pins_expect(1, FATHOM_NEAR);
        expect_next(50, FATHOM_NEAR);
        assert_int_equal(pins.sample.time_us, pins.fake.now_us); /* it is so now */
        run(500);
        pins_expect(12, FATHOM_NEAR);
        pins_turn(10 * MS);
        run(30);
        pins_expect(13, FATHOM_FAR); /* a change does not wait for the period, and begins it anew */
        expect_next(50, FATHOM_FAR);
    }
}

/* ---- stale ---- */

TEST(a_level_that_never_stands_still_is_stale_every_2_s)
{
    run(50);
    pins_expect(1, FATHOM_FAR);
    for (unsigned i = 0; i != 5900; i++) {
        pins.level = !pins.level;
        run(1);
        assert_int_equal(pins.stales, i / 2000);
    }
    pins_expect(1, FATHOM_FAR);
    run(100);
    pins.level = !pins.level;
    run(2000);
    assert_int_equal(pins.stales, 2);
}

/* ---- when to look ---- */

TEST(the_next_look_is_due_in_10_ms_or_when_the_level_has_settled)
{
    expect_due(10000);
    pins_run(14 * MS, 7000);
    expect_due(6000);
    pins.fake.now_us += 2000;
    expect_due(4000);
    pins.fake.now_us += 5000;
    expect_due(0);
    assert_int_equal(pins_poll(), FATHOM_OK);
    expect_due(10000);
    pins.fake.now_us += 20000;
    expect_due(0);
}

TEST(if_an_interrupt_wakes_the_program_only_the_period_is_due_while_the_level_stands)
{
    timing.interval_us = FATHOM_NO_DEADLINE;
    start();
    expect_due(20000);
    pins_run(20 * MS, 20000);
    assert_int_equal(pins.samples, 1);
    expect_due(FATHOM_MAX_DURATION_US);
    pins_turn(0);
    pins_poll();
    expect_due(20000);
    pins_run(20 * MS, 20000);
    assert_int_equal(pins.samples, 2);
    timing.period_us = 500000;
    start();
    pins_run(20 * MS, 20000);
    expect_due(500000);
}

/* ---- init ---- */

static void expect_refused(const fathom_pin_t *pin, const fathom_clock_t *clock,
                           const fathom_contact_guard_t *guard)
{
    const fathom_contact_t zeroed = {0};
    memset(&contact, 0x5A, sizeof contact);
    contact.pin = pin;
    contact.clock = clock;
    contact.guard = guard;
    expect_init(FATHOM_ERR_ARGUMENT);
    assert_memory_equal(&contact, &zeroed, sizeof zeroed);
}

static fathom_status_t guard_poll(void *ctx) { return (void)ctx, FATHOM_PENDING; }
static bool guard_is_clear(void *ctx, uint32_t now_us) { return (void)ctx, (void)now_us, true; }
static uint32_t guard_due_us(void *ctx) { return (void)ctx, FATHOM_NO_DEADLINE; }

TEST(init_refuses_what_it_cannot_read_and_leaves_the_contact_zeroed)
{
    const fathom_pin_t output = {NULL, NULL, NULL};
    const fathom_clock_t still = {NULL, NULL};
    const fathom_contact_guard_t guards[] = {
        {NULL, guard_is_clear, guard_due_us, NULL},
        {guard_poll, NULL, guard_due_us, NULL},
        {guard_poll, guard_is_clear, NULL, NULL},
    };
    expect_refused(NULL, &pins.fake.clock, NULL);
    expect_refused(&output, &pins.fake.clock, NULL);
    expect_refused(&pins.pin, NULL, NULL);
    expect_refused(&pins.pin, &still, NULL);
    for (unsigned i = 0; i != COUNT_OF(guards); i++) expect_refused(&pins.pin, &pins.fake.clock, &guards[i]);
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
    for (unsigned s = 0; s != COUNT_OF(steps_us); s++) {
        const uint32_t step_us = steps_us[s];
        for (unsigned levels = 0; levels != 1u << LOOKS; levels++) {
            start_at(UINT32_MAX - 3 * step_us, (levels & 1) != 0); /* init is the first look */
            for (unsigned n = 1; n != LOOKS; n++) {
                pins.level = (levels >> n & 1) != 0;
                pins.fake.now_us += step_us;
                const uint8_t kind = refer(levels, n, step_us);
                if (pins_poll() != (kind != 0 ? FATHOM_OK : FATHOM_PENDING)) fail();
                if (kind != 0 && pins.sample.kind != kind) fail();
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
    assert_int_equal(fathom_contact_due_us(&contact), fathom_due_us(&pins.sensor, 1));
    for (unsigned ms = 0; ms != 25 && fathom_contact_poll(&contact, &sample) == FATHOM_PENDING; ms++)
        pins.fake.now_us += 1000;
    assert_int_equal(sample.address, 7);
}
