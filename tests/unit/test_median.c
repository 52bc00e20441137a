/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/processing/median.h"

enum { MAX = FATHOM_MEDIAN_MAX_COUNT, UNTOUCHED = 0xA5 };

static uint16_t window[MAX];
static fathom_median_config_t config;
static fathom_median_t median;
static fathom_sample_t out;
static uint32_t now_us;

static void start(void)
{
    memset(&median, 0x5A, sizeof median);
    memset(window, 0x5A, sizeof window);
    assert_int_equal(fathom_median_init(&median, &config), FATHOM_OK);
    assert_int_equal(median.dropped, 0);
}

static int set_up(void **state)
{
    memset(&config, 0, sizeof config);
    config.window = window;
    config.count = 3;
    now_us = UINT32_MAX - 250000; /* every test goes through the wrap */
    start();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static void start_with(uint8_t count, uint16_t gate_mm)
{
    config.count = count;
    config.gate_mm = gate_mm;
    start();
}

/* The next sample, 100 ms after the one before. Is there a median with it? *out is untouched if not. */
static bool next(uint8_t kind, uint16_t mm)
{
    static const fathom_sample_t none;
    const fathom_sample_t sample = {.time_us = now_us += 100000, .kind = kind, .distance_mm = mm};
    out = none;
    const bool is_there = fathom_median_add_sample(&median, &sample, &out);
    if (!is_there) assert_memory_equal(&out, &none, sizeof out);
    return is_there;
}

static void expect_none(uint8_t kind, uint16_t mm) { assert_false(next(kind, mm)); }

static void expect_mm(uint16_t mm, uint16_t middle_mm)
{
    assert_true(next(FATHOM_TARGET, mm));
    assert_int_equal(out.kind, FATHOM_TARGET);
    assert_int_equal(out.distance_mm, middle_mm);
}

static void expect_kind(uint8_t kind, uint8_t middle_kind)
{
    assert_true(next(kind, 0));
    assert_int_equal(out.kind, middle_kind);
    assert_int_equal(out.distance_mm, 0);
}

/* Distances of which there is no median yet. */
static void fill(uint16_t mm, unsigned count)
{
    while (count-- != 0) expect_none(FATHOM_TARGET, mm);
}

/* ---- the window ---- */

TEST(the_median_of_three_is_there_with_the_third)
{
    expect_none(FATHOM_TARGET, 1000);
    expect_none(FATHOM_TARGET, 3000);
    expect_mm(2000, 2000);
    expect_mm(4000, 3000); /* 3000 2000 4000 */
    expect_mm(1, 2000);    /* 2000 4000 1 */
    expect_mm(2, 2);       /* 4000 1 2 */
    expect_mm(3, 2);       /* 1 2 3: the oldest goes */
    expect_mm(3, 3);
    expect_mm(2, 3); /* 3 3 2: equal ones */
}

/* ---- what counts as what ---- */

static const struct {
    uint8_t kind;
    uint16_t mm;
    enum { NEARER, DISTANCE, FARTHER, NOTHING } counts_as;
} meanings[] = {
    {FATHOM_TARGET, 0, NEARER},
    {FATHOM_NEAR, 0, NEARER},
    {FATHOM_TARGET, 1, DISTANCE},
    {FATHOM_TARGET, 500, DISTANCE},
    {FATHOM_TARGET, 65534, DISTANCE},
    {FATHOM_TARGET, 65535, FARTHER},
    {FATHOM_NO_TARGET, 0, FARTHER},
    {FATHOM_FAR, 0, FARTHER},
    {FATHOM_UNKNOWN, 0, NOTHING},
    {FATHOM_FAULT, 0, NOTHING},
    {0, 0, NOTHING},
    {7, 0, NOTHING},
};

TEST(samples_of_every_kind_count_as_the_header_says)
{
    for (unsigned i = 0; i != sizeof meanings / sizeof *meanings; i++) {
        const uint8_t kind = meanings[i].kind;
        start();
        if (meanings[i].counts_as == NOTHING) {
            for (int n = 0; n != 9; n++) expect_none(kind, meanings[i].mm);
            continue;
        }
        expect_none(kind, meanings[i].mm);
        expect_none(kind, meanings[i].mm);
        assert_true(next(kind, meanings[i].mm));
        assert_int_equal(out.kind, meanings[i].counts_as == NEARER    ? FATHOM_NEAR
                                   : meanings[i].counts_as == FARTHER ? FATHOM_NO_TARGET
                                                                      : FATHOM_TARGET);
        assert_int_equal(out.distance_mm, meanings[i].counts_as == DISTANCE ? meanings[i].mm : 0);
    }
}

TEST(no_target_is_farther_than_every_distance_and_near_is_nearer)
{
    expect_none(FATHOM_NO_TARGET, 0);
    expect_none(FATHOM_NEAR, 0);
    expect_mm(1, 1);
    expect_kind(FATHOM_NEAR, FATHOM_NEAR); /* near, 1, near */
    expect_mm(65534, 1);
    assert_true(next(FATHOM_FAR, 0)); /* near 65534 far */
    assert_int_equal(out.distance_mm, 65534);
    expect_kind(FATHOM_NO_TARGET, FATHOM_NO_TARGET); /* 65534 far no target */
}

TEST(the_median_is_no_target_when_more_than_half_are)
{
    start_with(4, 0);
    fill(700, 2);
    expect_none(FATHOM_NO_TARGET, 0);
    assert_true(next(FATHOM_NO_TARGET, 0)); /* 2 of 4 */
    assert_int_equal(out.kind, FATHOM_TARGET);
    assert_int_equal(out.distance_mm, 700);
    expect_kind(FATHOM_NO_TARGET, FATHOM_NO_TARGET);
}

/* ---- what comes out ---- */

TEST(the_rest_of_the_sample_stays_and_out_may_be_the_sample_itself)
{
    const fathom_sample_t third = {.time_us = 42,
                                   .magnitude = 0x12345678,
                                   .raw = 0x9ABCDEF0,
                                   .sequence = 0x1357,
                                   .distance_mm = 900,
                                   .precision = 0x2468,
                                   .kind = FATHOM_TARGET,
                                   .model = FATHOM_HPS167S,
                                   .address = 247,
                                   .probe = 4,
                                   .ambient = 255,
                                   .interference = true};
    fathom_sample_t expected = third;
    expected.distance_mm = 800;
    for (int same = 0; same != 2; same++) {
        fathom_sample_t sample = third;
        start();
        now_us = 0;
        fill(800, 1);
        fill(700, 1);
        memset(&out, UNTOUCHED, sizeof out);
        fathom_sample_t *const to = same != 0 ? &sample : &out;
        assert_true(fathom_median_add_sample(&median, &sample, to));
        assert_memory_equal(to, &expected, sizeof expected);
    }
}

static void expect_mark(uint8_t kind, uint8_t middle_kind, bool is_marked)
{
    const fathom_sample_t sample = {.time_us = now_us, .kind = kind, .interference = true};
    assert_true(fathom_median_add_sample(&median, &sample, &out));
    assert_int_equal(out.kind, middle_kind);
    assert_int_equal(out.interference, is_marked);
}

TEST(the_mark_of_interference_stays_only_with_its_kind)
{
    fill(800, 2);
    expect_mark(FATHOM_NO_TARGET, FATHOM_TARGET, false);
    expect_mark(FATHOM_NO_TARGET, FATHOM_NO_TARGET, true);
    expect_mark(FATHOM_FAR, FATHOM_NO_TARGET, false);
    expect_mark(FATHOM_NEAR, FATHOM_NO_TARGET, false);
    expect_mark(FATHOM_NEAR, FATHOM_NEAR, true);
}

/* ---- the gate ---- */

typedef struct {
    uint8_t kind, other_kind;
    uint16_t mm, other_mm, gate_mm;
    bool is_spike;
} gate_row_t;

/* A sample, one of the other kind behind a window of the first, and the gate. */
static const gate_row_t gates[] = {
    {FATHOM_TARGET, FATHOM_TARGET, 1000, 1300, 300, false},
    {FATHOM_TARGET, FATHOM_TARGET, 1000, 1301, 300, true},
    {FATHOM_TARGET, FATHOM_TARGET, 1000, 700, 300, false},
    {FATHOM_TARGET, FATHOM_TARGET, 1000, 699, 300, true},
    {FATHOM_TARGET, FATHOM_TARGET, 1000, 1001, 1, false},
    {FATHOM_TARGET, FATHOM_TARGET, 1000, 1002, 1, true},
    {FATHOM_TARGET, FATHOM_TARGET, 1000, 65534, 0, false}, /* no gate */
    {FATHOM_TARGET, FATHOM_NO_TARGET, 1000, 0, 0, false},
    {FATHOM_TARGET, FATHOM_TARGET, 65000, 65534, 600, false}, /* 65000 + 600 is over 65535 */
    {FATHOM_TARGET, FATHOM_TARGET, 65534, 65000, 600, false},
    {FATHOM_TARGET, FATHOM_TARGET, 1, 65534, 65533, false},
    {FATHOM_TARGET, FATHOM_TARGET, 1, 65534, 65532, true},
    {FATHOM_TARGET, FATHOM_NEAR, 300, 0, 300, false}, /* 0 mm */
    {FATHOM_TARGET, FATHOM_NEAR, 301, 0, 300, true},
    {FATHOM_NEAR, FATHOM_TARGET, 0, 300, 300, false},
    {FATHOM_NEAR, FATHOM_TARGET, 0, 301, 300, true},
    {FATHOM_TARGET, FATHOM_NO_TARGET, 65534, 0, 65535, true},
    {FATHOM_TARGET, FATHOM_FAR, 65534, 0, 2, true},
    {FATHOM_NO_TARGET, FATHOM_TARGET, 0, 65534, 2, true},
    {FATHOM_NO_TARGET, FATHOM_NEAR, 0, 0, 65535, true},
    {FATHOM_NEAR, FATHOM_FAR, 0, 0, 65535, true},
    {FATHOM_NO_TARGET, FATHOM_FAR, 0, 0, 1, false},
};

TEST(what_is_farther_from_the_median_than_the_gate_is_a_spike)
{
    for (unsigned i = 0; i != sizeof gates / sizeof *gates; i++) {
        const gate_row_t *const row = &gates[i];
        start_with(3, row->gate_mm);
        for (int n = 0; n != 3; n++) assert_int_equal(next(row->kind, row->mm), n == 2);
        assert_int_equal(next(row->other_kind, row->other_mm), !row->is_spike);
        assert_int_equal(median.dropped, row->is_spike);
        assert_true(next(row->kind, row->mm));
    }
}

TEST(the_gate_is_about_the_median_and_not_the_last_sample)
{
    start_with(3, 100);
    fill(1000, 1);
    fill(1090, 1);
    expect_mm(1100, 1090);
    expect_mm(1190, 1100); /* 1090 1100 1190 */
    expect_none(FATHOM_TARGET, 1201);
    expect_mm(1000, 1100); /* 1100 1190 1000: the spike is not among them */
}

TEST(after_gate_row_spikes_the_next_is_the_first_of_a_new_window)
{
    for (unsigned gate_row = 0; gate_row <= 255; gate_row = 2 * gate_row + 1) {
        const unsigned dropped = gate_row != 0 ? gate_row : 2;
        config.gate_row = (uint8_t)gate_row;
        start_with(3, 100);
        fill(1000, 2);
        expect_mm(1000, 1000);
        fill(2000, dropped);
        assert_int_equal(median.dropped, dropped);
        expect_mm(1010, 1000); /* ends the row */
        fill(2000, dropped);
        assert_int_equal(median.dropped, 2 * dropped);
        expect_none(FATHOM_TARGET, 2500); /* the first of three */
        expect_none(FATHOM_TARGET, 4000); /* no spike: there is no median */
        assert_int_equal(median.dropped, 2 * dropped);
        expect_mm(3000, 3000);
        fill(4000, dropped); /* a whole row again */
        expect_mm(3000, 3000);
        assert_int_equal(median.dropped, 3 * dropped);
    }
}

TEST(spikes_of_a_row_may_be_on_both_sides_and_what_counts_for_nothing_does_not_end_it)
{
    start_with(3, 100);
    fill(1000, 2);
    expect_mm(1000, 1000);
    expect_none(FATHOM_TARGET, 2000);
    expect_none(FATHOM_FAULT, 0);
    expect_none(FATHOM_UNKNOWN, 0);
    expect_none(FATHOM_TARGET, 10);
    assert_int_equal(median.dropped, 2);
    expect_none(FATHOM_NO_TARGET, 0); /* the first of three */
    assert_int_equal(median.dropped, 2);
    fill(1000, 1);
    expect_mm(1100, 1100); /* 1000 1100, no target */
}

/* ---- not for ever ---- */

/* So long after the last sample. */
static void expect_time(uint32_t after_us, bool empties)
{
    assert_int_equal(fathom_median_advance(&median, now_us + after_us), empties);
}

TEST(without_a_sample_for_5_s_or_as_the_config_says_the_window_is_emptied)
{
    for (uint32_t s = 5; s <= 1000; s += 995) {
        config.unknown_us = s != 5 ? s * 1000000 : 0;
        start();
        expect_time(s * 1000000 + 1, false); /* it is empty */
        fill(1000, 2);
        expect_mm(1000, 1000);
        expect_time((uint32_t)-1000, false); /* read before the sample came */
        expect_time(s * 1000000, false);
        expect_mm(1000, 1000);
        expect_time(s * 1000000 + 1, true);
        expect_time(s * 1000000 + 2, false); /* said once */
        fill(2000, 2);
        expect_mm(2000, 2000);
    }
}

/* "A time a little before that of the last sample does no harm": half a turn of the clock, 2^31 us, is before. */
TEST(a_time_up_to_half_a_turn_of_the_clock_empties_a_window_that_is_not_kept_for_ever)
{
    static const uint32_t unknown_us[] = {0, UINT32_MAX};
    for (unsigned i = 0; i != 2; i++) {
        config.unknown_us = unknown_us[i];
        start();
        fill(1000, 2);
        expect_mm(1000, 1000);
        expect_time(2147483648, false);
        if (i == 1) expect_time(UINT32_MAX, false);
        expect_time(2147483647, i == 0);
    }
}

TEST(the_median_may_be_the_last_of_the_window)
{
    for (uint16_t mm = 100; mm < 65000; mm = (uint16_t)(mm + 97)) {
        start();
        expect_none(FATHOM_TARGET, (uint16_t)(mm + 2));
        expect_none(FATHOM_TARGET, mm);
        expect_mm((uint16_t)(mm + 1), (uint16_t)(mm + 1));
    }
}

TEST(a_sample_after_5_s_without_one_is_the_first_of_a_new_window)
{
    fill(1000, 2);
    expect_mm(1000, 1000);
    now_us += 5000000;
    fill(2000, 2);
    expect_mm(2000, 2000);
}
