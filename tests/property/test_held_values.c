/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "stream_rig.h"

/*
 * A sensor that looks at something that does not move sends the same frame again and again, and nothing in the
 * bytes says where it begins. Every value there is, held still, from every byte of the frame on, in every way.
 */
enum { LENGTH = 4, VALUES = 65536, FRAMES = 6 };

/* The frame of a value by the datasheet's formula (A16 2(4)). */
static void make_frame(uint8_t *frame, unsigned value)
{
    frame[0] = 0xFF;
    frame[1] = (uint8_t)(value / 256);
    frame[2] = (uint8_t)(value % 256);
    frame[3] = (uint8_t)(0xFF + frame[1] + frame[2]);
}

static void hold(uint8_t *sent, unsigned value)
{
    for (unsigned i = 0; i != FRAMES; i++) make_frame(sent + i * LENGTH, value);
}

TEST(with_gaps_seen_every_value_is_shown_rightly_from_every_start)
{
    unsigned runs = 0;
    for (unsigned value = 0; value != VALUES; value++) {
        uint8_t sent[FRAMES * LENGTH];
        hold(sent, value);
        for (uint8_t start = 0; start != LENGTH; start++) {
            for (int way = 0; way != RIG_WAYS; way++, runs++) {
                const rig_outcome_t outcome = rig_run(sent, FRAMES, LENGTH, start, true, way);
                assert_int_equal(outcome.wrong, 0);
                assert_int_equal(outcome.right, start == 0 ? FRAMES : FRAMES - 1);
                assert_int_equal(outcome.first, start == 0 ? 0 : 1);
            }
        }
    }
    assert_int_equal(runs, 65536 * 4 * 3);
}

/*
 * The values whose frame can be read in a second alignment. By hand: begun at H, FF + L + S = FF with
 * S = FF + FF + L gives 2 L = 2, so H L is FF 01 or FF 81; begun at S, FF + FF + H = L with FF + H + L = FF
 * gives 2 H = 2, so 01 FF or 81 7F; begun at L there is no solution. They are two pairs, each the other's
 * second reading.
 */
static const unsigned two_readings[] = {0x01FF, 0x817F, 0xFF01, 0xFF81};
enum { TWO_READINGS = sizeof two_readings / sizeof two_readings[0] };

/* Without gaps those four are never shown, the others always, but for the first one or two frames and the last,
 * which no other follows; and no value is ever shown wrongly. What is not shown is counted as ambiguous. */
TEST(without_gaps_no_value_is_shown_wrongly_and_four_are_not_shown)
{
    unsigned hidden = 0;
    unsigned runs = 0;
    for (unsigned value = 0; value != VALUES; value++) {
        uint8_t sent[FRAMES * LENGTH];
        hold(sent, value);
        const bool is_ambiguous = rig_has_two_alignments(sent, LENGTH);
        if (is_ambiguous) assert_int_equal(value, two_readings[hidden++]);
        for (uint8_t start = 0; start != LENGTH; start++) {
            for (int way = 0; way != RIG_WAYS; way++, runs++) {
                const rig_outcome_t outcome = rig_run(sent, FRAMES, LENGTH, start, false, way);
                const uint16_t *const counters = outcome.counters;
                const unsigned shown = outcome.right + counters[FATHOM_STREAM_MISSED];
                assert_int_equal(outcome.wrong, 0);
                assert_int_equal(counters[FATHOM_STREAM_UNSURE], 1); /* the first */
                assert_int_equal(shown, counters[FATHOM_STREAM_FRAMES]);
                if (is_ambiguous)
                    assert_int_equal(counters[FATHOM_STREAM_AMBIGUOUS], outcome.windows - 1);
                else
                    assert_int_equal(counters[FATHOM_STREAM_AMBIGUOUS], 0);
                assert_int_equal(shown, is_ambiguous ? 0 : start == 0 ? FRAMES - 2 : FRAMES - 3);
            }
        }
    }
    assert_int_equal(runs, 65536 * 4 * 3);
    assert_int_equal(hidden, TWO_READINGS);
}

/* The four probes of an A05, held still at values that are often in question. */
TEST(frames_of_four_probes_are_never_shown_out_of_step)
{
    static const uint16_t values[] = {0x0000, 0x00FF, 0x01FF, 0x03E8, 0x07D0, 0x07FF, 0x053B,
                                      0x0DEA, 0xFF00, 0xFFFD, 0xFFFE, 0xFFFF, 0x1770, 0x00FA};
    enum { COUNT = sizeof values / sizeof values[0], LONG = FATHOM_DYP_A05_LENGTH };
    unsigned ambiguous = 0;
    unsigned runs = 0;
    for (unsigned n = 0; n != COUNT * COUNT * COUNT * COUNT; n++) {
        const uint16_t probes[] = {values[n % COUNT], values[n / COUNT % COUNT],
                                   values[n / COUNT / COUNT % COUNT], values[n / COUNT / COUNT / COUNT]};
        uint8_t sent[4 * LONG];
        for (int i = 0; i != 4; i++) rig_make_frame(sent + i * LONG, LONG, probes);
        const bool is_ambiguous = rig_has_two_alignments(sent, LONG);
        if (is_ambiguous) ambiguous++;
        for (uint8_t start = 0; start != LONG; start++, runs += 2) {
            rig_outcome_t outcome = rig_run(sent, 4, LONG, start, true, RIG_BY_BYTE);
            assert_int_equal(outcome.wrong, 0);
            assert_int_equal(outcome.right, start == 0 ? 4 : 3);
            outcome = rig_run(sent, 4, LONG, start, false, RIG_BY_BYTE);
            assert_int_equal(outcome.wrong, 0);
            assert_int_equal(outcome.right, is_ambiguous ? 0 : start == 0 ? 2 : 1);
        }
    }
    assert_int_equal(runs, 14 * 14 * 14 * 14 * 10 * 2);
    assert_true(ambiguous > 100); /* the set-up does hold such frames */
}
