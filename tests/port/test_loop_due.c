/* SPDX-License-Identifier: MIT */
#include "internal/posix_loop.h"
#include "suite.h"

/* The sources by the time when they are due, against a plain list of times. */

enum { SOURCES = 300, CHANGES = 200000 };

static fathom_loop_t loop;
static fathom_loop_source_t sources[SOURCES];
static uint64_t due_us[SOURCES];
static bool is_due[SOURCES];
static uint32_t seed;

static int set_up(void **state)
{
    memset(&loop, 0, sizeof loop);
    memset(sources, 0, sizeof sources);
    memset(is_due, 0, sizeof is_due);
    for (unsigned i = 0; i != SOURCES; i++) sources[i].loop = &loop;
    seed = 1;
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* Numerical Recipes' generator; the high bits. */
static uint32_t draw(uint32_t below)
{
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) % below;
}

static void expect_first(void)
{
    uint64_t least_us = UINT64_MAX;
    unsigned count = 0;
    for (unsigned i = 0; i != SOURCES; i++) {
        assert_int_equal(sources[i].is_due, is_due[i]);
        if (is_due[i] && due_us[i] < least_us) least_us = due_us[i];
        count += is_due[i];
    }
    assert_int_equal(loop.due == NULL, count == 0);
    if (count == 0) return;
    assert_int_equal(loop.due->due_us, least_us);
    assert_null(loop.due->parent);
}

static void change(uint32_t range)
{
    const unsigned i = draw(SOURCES);
    if (draw(3) == 0) {
        fathom_loop_due_never(&sources[i]);
        is_due[i] = false;
    } else {
        due_us[i] = draw(range);
        fathom_loop_due_at(&sources[i], due_us[i]);
        is_due[i] = true;
    }
}

/* Takes all out by the time, and each is there once. */
static void drain(void)
{
    uint64_t last_us = 0;
    while (loop.due != NULL) {
        fathom_loop_source_t *const source = loop.due;
        const long i = source - sources;
        assert_true(is_due[i] && source->due_us == due_us[i] && source->due_us >= last_us);
        last_us = source->due_us;
        is_due[i] = false;
        fathom_loop_due_never(source);
    }
    expect_first();
}

TEST(whatever_is_added_moved_and_taken_out_the_one_that_is_due_first_is_first)
{
    for (unsigned n = 0; n != CHANGES; n++) {
        change(n % 2 == 0 ? 1000000 : 10); /* also with many equal ones */
        if (n % 64 == 0) expect_first();
        if (n % 9973 == 0) drain();
    }
    drain();
}

TEST(times_of_which_the_low_halves_are_the_wrong_way_round_are_in_order)
{
    fathom_loop_due_at(&sources[0], (uint64_t)1 << 32);
    fathom_loop_due_at(&sources[1], UINT32_MAX);
    assert_ptr_equal(loop.due, &sources[1]);
}

TEST(in_order_and_against_it_the_first_one_is_first)
{
    for (unsigned i = 0; i != SOURCES; i++) fathom_loop_due_at(&sources[i], i);
    assert_ptr_equal(loop.due, &sources[0]);
    for (unsigned i = 0; i != SOURCES; i++) fathom_loop_due_at(&sources[i], SOURCES - i);
    assert_ptr_equal(loop.due, &sources[SOURCES - 1]);
}
