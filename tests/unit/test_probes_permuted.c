/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "stream_rig.h"

/*
 * The four probes of an A05, read out of step with every value plausible. If the low byte of probe k is FF, a frame
 * can begin there. Held still, its sum is then the high byte h of probe k, and right if h is the true sum S too: the
 * whole ring of ten bytes adds up to 2 S and to 2 h. FF + h + FF + the six other bytes = h if those six make 2 (mod
 * 256). The reading is then the probes behind k, S FF, which is the value of probe k, and the probes before it: the
 * four right distances, each at another probe.
 */
enum { LENGTH = FATHOM_DYP_A05_LENGTH, PROBES = 4, HELD = 6 };

/* Distances of 256 to 4351 mm, probe k = 1 to 4 as above. */
static void make_hazard(uint8_t *frame, unsigned k)
{
    uint16_t values[PROBES];
    const unsigned fitted = k % PROBES; /* the low byte of the probe after k makes the 2 */
    unsigned six = 0;
    for (unsigned i = 0; i != PROBES; i++) {
        values[i] = (uint16_t)(256 + rig_random_below(4096));
        if (i == k - 1) values[i] |= 0x00FF;
        if (i == fitted) values[i] &= 0xFF00;
        if (i != k - 1) six += values[i] / 256u + values[i] % 256u;
    }
    values[fitted] |= (uint16_t)((2 - six) & 0xFF);
    rig_make_frame(frame, LENGTH, values);
    assert_true(rig_has_two_alignments(frame, LENGTH));
    assert_int_equal(frame[2 * k], 0xFF);
    assert_int_equal(frame[2 * k - 1], frame[LENGTH - 1]);
}

/* 1000 2000 2047 1339 mm: FF + 03 + E8 + 07 + D0 + 07 + FF + 05 + 3B = 407. Six bytes on it reads
 * 1339 2047 1000 2000. */
static const uint8_t known[LENGTH] = {0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xFF, 0x05, 0x3B, 0x07};

static void hold(uint8_t *sent, const uint8_t *frame)
{
    for (unsigned i = 0; i != HELD; i++) memcpy(sent + i * LENGTH, frame, LENGTH);
}

static unsigned sum_of(const uint16_t *counters)
{
    return (unsigned)counters[FATHOM_STREAM_FRAMES] + counters[FATHOM_STREAM_AMBIGUOUS] +
           counters[FATHOM_STREAM_UNSURE];
}

/* Every start and way; returns how many runs it made. */
static unsigned show_held(const uint8_t *frame, bool gaps)
{
    uint8_t sent[HELD * LENGTH];
    unsigned runs = 0;
    hold(sent, frame);
    for (uint8_t start = 0; start != LENGTH; start++) {
        for (int way = 0; way != RIG_WAYS; way++, runs++) {
            const rig_outcome_t outcome = rig_feed(sent, HELD, LENGTH, start, gaps, way);
            const unsigned whole = start == 0 ? HELD : HELD - 1;
            assert_int_equal(outcome.wrong, 0);
            assert_int_equal(sum_of(outcome.counters), outcome.windows);
            if (gaps) {
                assert_int_equal(outcome.right, whole);
                assert_int_equal(outcome.first, HELD - whole);
                assert_int_equal(outcome.counters[FATHOM_STREAM_FRAMES], whole);
            } else {
                /* Nothing, and why: but for the first place with a right sum each has another just before. */
                assert_int_equal(outcome.right, 0);
                assert_int_equal(outcome.counters[FATHOM_STREAM_FRAMES], 0);
                assert_int_equal(outcome.counters[FATHOM_STREAM_UNSURE], 1);
                assert_in_range(outcome.windows, 2 * whole - 1, LENGTH * HELD);
            }
        }
    }
    return runs;
}

TEST(the_set_up_is_the_hazard)
{
    static const uint8_t permuted[] = {0xFF, 0x05, 0x3B, 0x07, 0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07};
    for (uint8_t i = 0; i != LENGTH; i++) assert_int_equal(permuted[i], known[(6 + i) % LENGTH]);
    assert_true(rig_is_valid(known, LENGTH));
    assert_true(rig_is_valid(permuted, LENGTH));
}

/* Of each probe so many hazards, and the known one; with FATHOM_LONG four times as many. */
static void show_all_held(bool gaps)
{
    const unsigned hazards = PROBES * (suite_is_long ? 1000 : 250);
    uint32_t runs = show_held(known, gaps);
    rig_seed(1);
    for (unsigned i = 0; i != hazards; i++) {
        uint8_t frame[LENGTH];
        make_hazard(frame, 1 + i % PROBES);
        runs += show_held(frame, gaps);
    }
    assert_int_equal(runs, (hazards + 1) * (uint32_t)LENGTH * RIG_WAYS);
}

TEST(with_gaps_seen_probes_held_still_are_never_permuted) { show_all_held(true); }

TEST(without_gaps_probes_held_still_are_never_permuted_but_said_to_be_ambiguous) { show_all_held(false); }

/* ---- probes that move ---- */

enum { MOVING = 30, SEQUENCES = 300 };

/* A third of the frames are hazards, a third have few values, most with an FF, the rest any of 250 to 4500 mm; in
 * every second sequence some stay for several frames. */
static void make_sequence(uint8_t *sent, unsigned number)
{
    static const uint16_t few[] = {0x01FF, 0x03FF, 0x05FF, 0x03E8, 0x07D0,
                                   0x07FF, 0x053B, 0x0DEA, 0x0101, 0x10FF};
    for (unsigned i = 0; i != MOVING; i++, sent += LENGTH) {
        uint16_t values[PROBES];
        const uint32_t kind = rig_random_below(3);
        if (i != 0 && number % 2 != 0 && rig_random_below(3) != 0) {
            memcpy(sent, sent - LENGTH, LENGTH);
            continue;
        }
        if (kind == 0) {
            make_hazard(sent, 1 + rig_random_below(PROBES));
            continue;
        }
        for (unsigned probe = 0; probe != PROBES; probe++)
            values[probe] = kind == 1 ? few[rig_random_below(sizeof few / sizeof few[0])]
                                      : (uint16_t)(250 + rig_random_below(4251));
        rig_make_frame(sent, LENGTH, values);
    }
    if (number == 0) memcpy(sent - MOVING * LENGTH, known, LENGTH);
}

/* Every sequence, start and way. */
static void for_each_sequence(bool gaps, void (*look)(uint8_t start, int way, const rig_outcome_t *outcome))
{
    for (unsigned n = 0; n != SEQUENCES; n++) {
        uint8_t sent[MOVING * LENGTH];
        make_sequence(sent, n);
        for (uint8_t start = 0; start != LENGTH; start++)
            for (int way = 0; way != RIG_WAYS; way++) {
                const rig_outcome_t outcome = rig_feed(sent, MOVING, LENGTH, start, gaps, way);
                look(start, way, &outcome);
            }
    }
}

static void look_with_gaps(uint8_t start, int way, const rig_outcome_t *outcome)
{
    (void)way;
    assert_int_equal(outcome->wrong, 0);
    assert_int_equal(outcome->right, start == 0 ? MOVING : MOVING - 1);
    assert_int_equal(outcome->first, start == 0 ? 0 : 1);
    assert_int_equal(outcome->counters[FATHOM_STREAM_FRAMES], outcome->right);
}

TEST(with_gaps_seen_every_frame_of_moving_probes_is_shown_in_order_from_the_first)
{
    rig_seed(2);
    for_each_sequence(true, look_with_gaps);
}

/*
 * Without gaps the first frame only says where the second begins, and the last waits for what follows it. All
 * others are shown, but for those that AMBIGUOUS counts. Every place with a right sum is in one of the counters;
 * the last frame may still wait.
 */
static unsigned ambiguous, missed, clear;

static void look_without_gaps(uint8_t start, int way, const rig_outcome_t *outcome)
{
    const uint16_t *const counters = outcome->counters;
    const unsigned whole = start == 0 ? MOVING : MOVING - 1;
    const unsigned shown = counters[FATHOM_STREAM_FRAMES];
    const unsigned lost = counters[FATHOM_STREAM_AMBIGUOUS];
    assert_int_equal(outcome->wrong, 0);
    assert_int_equal(outcome->right + counters[FATHOM_STREAM_MISSED], shown);
    assert_in_range(sum_of(counters), outcome->windows - 1, outcome->windows);
    assert_true(shown + lost + 2 >= whole);
    if (lost == 0) {
        assert_int_equal(shown, whole - 2);
        if (way == RIG_BY_BYTE) assert_int_equal(outcome->first, start == 0 ? 1 : 2);
        clear++;
    }
    ambiguous += lost;
    missed += counters[FATHOM_STREAM_MISSED];
}

TEST(without_gaps_no_frame_of_moving_probes_is_permuted_and_AMBIGUOUS_counts_what_is_lost)
{
    ambiguous = missed = clear = 0;
    rig_seed(3);
    for_each_sequence(false, look_without_gaps);
    assert_true(ambiguous > 1000 && missed > 1000 && clear > 1000); /* the set-up has all of them */
}
