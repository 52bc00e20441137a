/* SPDX-License-Identifier: MIT */
#include "contact_rig.h"
#include "fathom/engine/contact.h"
#include "fathom/engine/wait.h"
#include "fathom/sensor/a05_relay.h"
#include "fathom/sensor/a16_switch.h"

/*
 * contact.h: a program that polls gets a sample or an error within the bound of the header, whatever the pin, the guard
 * and the clock do, and no sample is of a level that was read earlier.
 */
enum { START_US = 1000 };
#define SECOND          ((uint32_t)1000000)
#define MS              ((uint32_t)1000)
#define COUNT_OF(array) (sizeof(array) / sizeof *(array))

static fathom_contact_timing_t timing;
static fathom_contact_t contact;
static uint32_t seed;
static bool is_guard_clear;
static fathom_status_t guard_status;

static fathom_status_t guard_poll(void *ctx) { return (void)ctx, guard_status; }
static bool guard_is_clear(void *ctx, uint32_t now_us) { return (void)ctx, (void)now_us, is_guard_clear; }
static uint32_t guard_due_us(void *ctx) { return (void)ctx, FATHOM_NO_DEADLINE; }
static const fathom_contact_guard_t guard = {guard_poll, guard_is_clear, guard_due_us, NULL};

static void start_with(const fathom_contact_guard_t *with, uint32_t now_us)
{
    pins_start(now_us);
    memset(&contact, 0x5A, sizeof contact);
    contact.pin = &pins.pin;
    contact.clock = &pins.fake.clock;
    contact.guard = with;
    contact.near_is_high = true;
    assert_int_equal(fathom_contact_init(&contact, &timing), FATHOM_OK);
    pins.sensor = fathom_contact_sensor(&contact);
}

static int set_up(void **state)
{
    memset(&timing, 0, sizeof timing);
    seed = 1;
    is_guard_clear = true;
    guard_status = FATHOM_PENDING;
    start_with(NULL, START_US);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static uint32_t below(uint32_t limit)
{
    seed = seed * 1664525u + 1013904223u; /* Numerical Recipes */
    return (uint32_t)(((uint64_t)seed * limit) >> 32);
}

static fathom_status_t poll_after(uint32_t us)
{
    pins.fake.now_us += us;
    return pins_poll();
}

/* ---- a contact that never changes ---- */

TEST(by_default_a_level_that_does_not_change_is_a_sample_each_second)
{
    pins_run(20 * MS, 1 * MS);
    pins_expect(1, FATHOM_FAR);
    for (unsigned n = 2; n != 12; n++) {
        pins_run(999 * MS, 1 * MS);
        pins_expect(n - 1, FATHOM_FAR);
        pins_run(1 * MS, 1 * MS);
        pins_expect(n, FATHOM_FAR);
        assert_int_equal(pins.sample.time_us, pins.fake.now_us);
    }
    assert_int_equal(pins.stales, 0);
}

/* ---- a level that does not count ---- */

TEST(the_error_of_a_guard_is_returned_if_there_is_nothing_else)
{
    guard_status = FATHOM_ERR_PORT;
    start_with(&guard, START_US);
    for (unsigned n = 0; n != 3; n++) assert_int_equal(poll_after(1 * MS), FATHOM_ERR_PORT);
    /* The first look found the guard clear, and 2 ms have passed since. */
    assert_int_equal(poll_after(18 * MS - 1), FATHOM_ERR_PORT);
    assert_int_equal(poll_after(1), FATHOM_OK);
}

TEST(a_hold_that_does_not_end_is_stale_every_2_s)
{
    pins_run(20 * MS, 1 * MS);
    fathom_contact_set_hold(&contact, true);
    pins_run(10 * SECOND, 1 * MS);
    assert_int_equal(pins.stales, 4); /* the level counted until the look before the hold */
    assert_int_equal(pins.samples, 1);
}

/* ---- age ---- */

/* 300 s lie between the first look that saw the level and the look at which it counts. */
TEST(a_level_that_counts_after_a_sleep_is_of_now)
{
    pins_run(20 * MS, 1 * MS);
    pins_expect(1, FATHOM_FAR);
    pins.level = true;
    pins_run(1 * MS, 1 * MS);
    assert_int_equal(poll_after(300 * SECOND), FATHOM_OK);
    pins_expect(2, FATHOM_NEAR);
    assert_int_equal(pins.sample.time_us, pins.fake.now_us);
}

/* "if ... that look was at most stale_us ago" */
TEST(the_first_look_is_the_time_of_a_sample_for_up_to_2_s)
{
    for (uint32_t late_us = 0; late_us != 2; late_us++) {
        start_with(NULL, START_US);
        assert_int_equal(poll_after(2 * SECOND + late_us), FATHOM_OK);
        assert_int_equal(pins.sample.time_us, late_us == 0 ? START_US : pins.fake.now_us);
    }
}

/* ---- any of it ---- */

/* "period_us + stale_us + 2 * P", by the clock and without its jumps. */
static void run_world(uint32_t world)
{
    static const uint32_t steps_us[] = {100, 3000, 30000, 300000, 3000000, 600000000};
    memset(&timing, 0, sizeof timing);
    if (below(2) == 0) timing.settle_us = 1 + below(100000);
    if (below(2) == 0) timing.stale_us = 100001 + below(5000000);
    if (below(2) == 0) timing.period_us = 1 + below(5000000);
    start_with(below(2) == 0 ? &guard : NULL, below(UINT32_MAX));
    const uint32_t bound_us = contact.timing.period_us + contact.timing.stale_us;
    uint32_t longest_us = 0;
    uint32_t since_us = 0;
    bool is_held = false;
    for (unsigned polls = 0; polls != 500; polls++) {
        const uint32_t step_us = 1 + below(steps_us[world % COUNT_OF(steps_us)]);
        if (step_us > longest_us) longest_us = step_us;
        pins.fake.now_us += step_us;
        since_us += step_us;
        if (below(20) == 0) {
            const uint32_t back_us = below(100001);
            pins.fake.now_us -= back_us;
            since_us = since_us > back_us ? since_us - back_us : 0;
        }
        if (below(world % 7 + 1) == 0) pins.level = !pins.level;
        if (below(20) == 0) is_guard_clear = !is_guard_clear;
        if (below(50) == 0) fathom_contact_set_hold(&contact, is_held = !is_held);
        if (pins_poll() != FATHOM_PENDING) since_us = 0;
        if (pins.samples != 0 && since_us == 0) assert_true(pins.sample.raw <= 1);
        if (since_us > bound_us + 2 * longest_us)
            fail_msg("world %lu: nothing in %lu us", (unsigned long)world, (unsigned long)since_us);
    }
}

TEST(any_levels_any_guard_any_polls_and_any_clock_have_an_outcome_within_the_bound)
{
    const uint32_t worlds = suite_is_long ? 100000 : 1000;
    for (uint32_t world = 0; world != worlds; world++) run_world(world);
}

/* ---- fathom_wait ---- */

static fathom_status_t wait_for(void (*idle)(void *ctx, uint32_t max_us))
{
    fathom_sample_t sample;
    return fathom_wait(&pins.sensor, &sample, idle, NULL);
}

static void stand_still(void *ctx, uint32_t max_us) { (void)ctx, pins.fake.now_us += max_us; }

TEST(wait_returns_for_a_contact_that_never_changes)
{
    timing.interval_us = FATHOM_NO_DEADLINE;
    timing.period_us = FATHOM_MAX_DURATION_US;
    start_with(NULL, START_US);
    for (unsigned n = 0; n != 5; n++) assert_int_equal(wait_for(stand_still), FATHOM_OK);
    /* 20 ms and 4 times 35 minutes */
    assert_true(pins.fake.now_us == (uint32_t)(START_US + 20 * MS + 4ull * FATHOM_MAX_DURATION_US));
}

/* ---- zeroed memory ---- */

TEST(a_contact_without_init_has_an_error_in_each_poll_and_no_function_is_called)
{
    fathom_sample_t sample;
    memset(&contact, 0, sizeof contact);
    assert_int_equal(pins_poll(), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_due_us(&pins.sensor, 1), 0);
    contact.pin = &pins.pin; /* and without the clock that it would read */
    assert_int_equal(pins_poll(), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_due_us(&pins.sensor, 1), 0);
    fathom_contact_set_hold(&contact, true);
    fathom_contact_set_near_is_high(&contact, true);
    static fathom_a05_relay_t relay;
    static fathom_a16_switch_t switch_of_a16;
    const fathom_sensor_t sensors[] = {
        fathom_a05_relay_sensor(&relay), fathom_a16_switch_sensor(&switch_of_a16), {NULL, NULL, NULL}};
    for (unsigned i = 0; i != COUNT_OF(sensors); i++) {
        assert_int_equal(fathom_poll(&sensors[i], &sample), FATHOM_ERR_ARGUMENT);
        assert_int_equal(fathom_due_us(&sensors[i], 1), 0);
    }
}
