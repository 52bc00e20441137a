/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/processing/debounce.h"

enum { HALF_S = 500000 };

static fathom_debounce_config_t config;
static fathom_debounce_t gate;
static uint32_t now_us;

static void start(void)
{
    memset(&gate, 0x5A, sizeof gate);
    assert_int_equal(fathom_debounce_init(&gate, &config), FATHOM_OK);
    assert_int_equal(gate.level, 0);
}

static int set_up(void **state)
{
    memset(&config, 0, sizeof config);
    now_us = UINT32_MAX - 2 * HALF_S; /* every test goes through the wrap */
    start();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static void start_with(fathom_debounce_config_t other)
{
    config = other;
    start();
}

/* Does a measurement so long after the start change the level? */
static void expect_at(uint32_t after_us, uint16_t mm, bool changes)
{
    assert_int_equal(fathom_debounce_add_distance(&gate, mm, now_us + after_us), changes);
}

/* A measurement every 500 ms, as the A16's (A16 4(2)). */
static bool distance(uint16_t mm)
{
    now_us += HALF_S;
    return fathom_debounce_add_distance(&gate, mm, now_us);
}

/* A character a measurement: n nearer than the threshold, f farther, e equal; a capital letter where the level changes
 * with it. */
static void expect_changes(const char *words)
{
    const unsigned threshold_mm = config.threshold_mm != 0 ? config.threshold_mm : 1000;
    for (; *words != 0; words++) {
        const char word = (char)(*words | 0x20);
        const unsigned mm = word == 'n' ? threshold_mm - 1 : word == 'f' ? threshold_mm + 1 : threshold_mm;
        assert_int_equal(distance((uint16_t)mm), *words != word);
    }
}

/* By default three nearer in a row make near, five farther make far, and equality holds the level. */
TEST(rows_of_measurements_change_the_level_and_equality_counts_as_the_config_says)
{
    static const struct {
        uint8_t equal;
        uint8_t level;
        const char *words;
    } rows[] = {{0, FATHOM_NEAR, "nnNnffffFfnnN"},
                {FATHOM_EQUAL_IS_NEAR, FATHOM_NEAR, "enEffffef"},
                {FATHOM_EQUAL_IS_FAR, FATHOM_FAR, "nneneefeE"}};
    for (unsigned i = 0; i != sizeof rows / sizeof *rows; i++) {
        config.equal = rows[i].equal;
        start();
        expect_changes(rows[i].words);
        assert_int_equal(gate.level, rows[i].level);
    }
}

TEST(a_config_without_sense_is_refused)
{
    config.equal = FATHOM_EQUAL_IS_FAR + 1;
    assert_int_equal(fathom_debounce_init(&gate, &config), FATHOM_ERR_ARGUMENT);
}

/* ---- options ---- */

TEST(rows_of_255_are_counted_and_longer_ones_do_not_wrap)
{
    start_with((fathom_debounce_config_t){.near_count = 255, .far_count = 255});
    for (int i = 1; i <= 1000; i++) assert_int_equal(distance(1), i == 255);
    for (int i = 1; i <= 1000; i++) assert_int_equal(distance(2000), i == 255);
}

/* ---- a level lasts a while ---- */

TEST(a_level_lasts_at_least_hold_us)
{
    start_with((fathom_debounce_config_t){.hold_us = 1000000, .near_count = 1, .far_count = 1});
    expect_at(0, 999, true);
    expect_at(999999, 1001, false);
    assert_int_equal(gate.level, FATHOM_NEAR);
    expect_at(1000000, 1001, true);
    expect_at(1999999, 999, false);
    expect_at(2000000, 999, true);
}

TEST(a_row_that_is_held_back_for_long_is_not_forgotten)
{
    start_with((fathom_debounce_config_t){.hold_us = 258 * HALF_S, .near_count = 1, .far_count = 5});
    assert_true(distance(999));
    for (int i = 1; i <= 258; i++) assert_int_equal(distance(1001), i == 258);
}

/* ---- samples ---- */

static void expect_sample(uint8_t kind, uint16_t mm, bool changes)
{
    const fathom_sample_t sample = {.time_us = now_us += HALF_S, .kind = kind, .distance_mm = mm};
    assert_int_equal(fathom_debounce_add_sample(&gate, &sample), changes);
}

TEST(samples_of_every_kind_count_as_the_header_says)
{
    start_with((fathom_debounce_config_t){.near_count = 2, .far_count = 2});
    expect_sample(FATHOM_TARGET, 999, false);
    expect_sample(FATHOM_TARGET, 999, true);
    expect_sample(FATHOM_NO_TARGET, 0, false);
    expect_sample(FATHOM_NO_TARGET, 0, true);
    expect_sample(FATHOM_NEAR, 0, false);
    expect_sample(FATHOM_NEAR, 0, true);
    expect_sample(FATHOM_FAR, 0, false);
    expect_sample(FATHOM_FAR, 0, true);
}

TEST(interference_counts_as_farther)
{
    const fathom_sample_t disturbed = {.kind = FATHOM_NO_TARGET, .interference = true};
    for (int i = 1; i <= 5; i++) assert_int_equal(fathom_debounce_add_sample(&gate, &disturbed), i == 5);
    assert_int_equal(gate.level, FATHOM_FAR);
}

/* ---- First contact 4: what counts for nothing holds a level for a while, and not for ever ---- */

static void expect_time(uint32_t after_us, bool changes)
{
    assert_int_equal(fathom_debounce_advance(&gate, now_us + after_us), changes);
}

/* The loop tells the time when nothing comes at all. */
TEST(a_level_without_measurements_becomes_unknown_after_5_s_or_as_the_config_says)
{
    for (uint32_t s = 5; s <= 1000; s += 995) {
        start_with((fathom_debounce_config_t){.unknown_us = s != 5 ? s * 1000000 : 0, .near_count = 1});
        expect_time(0, false);
        assert_int_equal(gate.level, 0);
        expect_at(0, 999, true);
        expect_time((uint32_t)-1000, false); /* read before the measurement came */
        expect_time(s * 1000000, false);
        assert_int_equal(gate.level, FATHOM_NEAR);
        expect_time(s * 1000000 + 1, true);
        assert_int_equal(gate.level, FATHOM_UNKNOWN);
        expect_time(s * 1000000 + 2, false); /* said once */
    }
}

TEST(behind_a_silence_a_row_begins_anew_and_does_not_wait_for_hold_us)
{
    start_with((fathom_debounce_config_t){.hold_us = 60000000, .near_count = 2, .far_count = 2});
    expect_at(0, 999, false);
    expect_at(5000001, 999, true); /* unknown; the first of a new row */
    assert_int_equal(gate.level, FATHOM_UNKNOWN);
    expect_at(5500000, 999, true);
    expect_at(11000000, 1001, true);
    assert_int_equal(gate.level, FATHOM_UNKNOWN);
    expect_at(11500000, 1001, true);
    assert_int_equal(gate.level, FATHOM_FAR);
}

/* "A time a little before that of the last measurement does no harm": half a turn of the clock, 2^31 us, is before. */
TEST(a_time_up_to_half_a_turn_of_the_clock_is_after_the_last_measurement)
{
    start_with((fathom_debounce_config_t){.near_count = 1});
    expect_at(0, 999, true);
    expect_time(2147483648, false);
    expect_time(2147483647, true);
}

/* ---- everything, against a slow reference ---- */

enum { LONGEST = 10, WORDS = 4 };

/* What can come: nearer, farther, equal, a fault. */
static const struct {
    uint8_t kind;
    uint16_t mm;
    char verdict;
} words[WORDS] = {
    {FATHOM_TARGET, 999, 'n'}, {FATHOM_TARGET, 1001, 'f'}, {FATHOM_TARGET, 1000, '='}, {FATHOM_FAULT, 0, 0}};

typedef struct {
    char verdicts[LONGEST + 1]; /* of all that was a measurement */
    unsigned count;
    char level;
    uint64_t since_us;
    uint64_t last_us;
} reference_t;

/* Looks at all that has come so far, each time anew; times of 64 bits. */
static bool refer(reference_t *reference, char verdict, uint64_t at_us)
{
    const char rows[2][LONGEST] = {"nnnnnnnnn", "fffffffff"};
    const char before = reference->level;
    if (reference->count != 0 && at_us - reference->last_us > config.unknown_us) {
        reference->count = 0;
        reference->level = 'u';
        reference->since_us = 0;
    }
    if (verdict == 0) return reference->level != before;
    reference->last_us = at_us;
    reference->verdicts[reference->count++] = verdict;
    reference->verdicts[reference->count] = 0;
    for (unsigned i = 0; i != 2; i++) {
        const size_t least = i == 0 ? config.near_count : config.far_count;
        if (reference->level == rows[i][0] || reference->count < least) continue;
        if (strncmp(reference->verdicts + reference->count - least, rows[i], least) != 0) continue;
        if (reference->level != 0 && at_us - reference->since_us < config.hold_us) continue;
        reference->level = rows[i][0];
        reference->since_us = at_us;
    }
    return reference->level != before;
}

static unsigned long compared;

static void go_on(const fathom_debounce_t *before, const reference_t *until, unsigned depth, uint64_t at_us,
                  uint32_t period_us)
{
    for (unsigned i = 0; depth != 0 && i != WORDS; i++) {
        reference_t reference = *until;
        fathom_debounce_t own = *before;
        const uint64_t next_us = at_us + period_us;
        const fathom_sample_t s = {
            .time_us = (uint32_t)next_us, .kind = words[i].kind, .distance_mm = words[i].mm};
        const bool changes = refer(&reference, words[i].verdict, next_us);
        if (fathom_debounce_add_sample(&own, &s) != changes) fail();
        const uint8_t known = reference.level == 'n' ? FATHOM_NEAR : FATHOM_FAR;
        const uint8_t level = reference.level == 'u' ? (uint8_t)FATHOM_UNKNOWN : known;
        if (own.level != (reference.level == 0 ? 0 : level)) fail();
        compared++;
        go_on(&own, &reference, depth - 1, next_us, period_us);
    }
}

TEST(every_sequence_of_up_to_ten_measurements_is_right)
{
    /* hold_us, unknown_us and counts; the A16, the A05's relay, and between */
    static const fathom_debounce_config_t configs[] = {{0, UINT32_MAX, 0, 3, 5, 0},
                                                       {1000000, 600000, 0, 1, 1, 0},
                                                       {1000000, 900000, 0, 2, 1, 0},
                                                       {2000000, UINT32_MAX, 0, 3, 2, 0}};
    const reference_t empty = {{0}, 0, 0, 0, 0};
    for (unsigned i = 0; i != sizeof configs / sizeof *configs; i++) {
        config = configs[i];
        start();
        compared = 0;
        /* the clock wraps after the fifth */
        go_on(&gate, &empty, LONGEST, UINT64_C(0x100000000) - 5 * 300000, 300000);
        assert_int_equal(compared, 1398100); /* 4 + 4^2 + .. + 4^10 = (4^11 - 4) / 3 */
    }
}
