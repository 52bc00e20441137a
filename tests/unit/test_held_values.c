/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "stream_rig.h"

/*
 * A sensor that looks at something that does not move sends the same frame again and again, and nothing in the
 * bytes says where it begins. Every value there is, held still, from every byte of the frame on: byte by byte, and
 * in portions from one of the four bytes, another one for the next value; with FATHOM_LONG in portions from each.
 */
enum { LENGTH = 4, VALUES = 65536, FRAMES = 5 };

static void hold(uint8_t *sent, unsigned value)
{
    const uint16_t mm = (uint16_t)value;
    for (unsigned i = 0; i != FRAMES; i++) rig_make_frame(sent + i * LENGTH, LENGTH, &mm);
}

/* Calls this for each of them with what came of it, and returns how many there were. */
static uint32_t for_each_value(bool gaps,
                               void (*look)(unsigned value, uint8_t start, const rig_outcome_t *outcome))
{
    uint32_t runs = 0;
    for (uint32_t value = 0; value != VALUES; value++) {
        uint8_t sent[FRAMES * LENGTH];
        hold(sent, (unsigned)value);
        for (uint8_t start = 0; start != LENGTH; start++) {
            for (int way = 0; way != RIG_WAYS; way++) {
                if (way != RIG_BY_BYTE && !suite_is_long && value % LENGTH != start) continue;
                const rig_outcome_t outcome = rig_feed(sent, FRAMES, LENGTH, start, gaps, way);
                look((unsigned)value, start, &outcome);
                runs++;
            }
        }
    }
    return runs;
}

static uint32_t runs_of_all(void) { return (uint32_t)VALUES * (suite_is_long ? 4 * 3 : 4 + 2); }

static void look_with_gaps(unsigned value, uint8_t start, const rig_outcome_t *outcome)
{
    (void)value;
    assert_int_equal(outcome->wrong, 0);
    assert_int_equal(outcome->right, start == 0 ? FRAMES : FRAMES - 1);
    assert_int_equal(outcome->first, start == 0 ? 0 : 1);
}

TEST(with_gaps_seen_every_value_is_shown_rightly_from_every_start)
{
    assert_int_equal(for_each_value(true, look_with_gaps), runs_of_all());
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
static unsigned hidden;

static void look_without_gaps(unsigned value, uint8_t start, const rig_outcome_t *outcome)
{
    const uint16_t *const counters = outcome->counters;
    const unsigned shown = outcome->right + counters[FATHOM_STREAM_MISSED];
    if (hidden != TWO_READINGS && value == two_readings[hidden]) hidden++;
    const bool is_ambiguous = hidden != 0 && value == two_readings[hidden - 1];
    assert_int_equal(outcome->wrong, 0);
    assert_int_equal(counters[FATHOM_STREAM_UNSURE], 1); /* the first */
    assert_int_equal(shown, counters[FATHOM_STREAM_FRAMES]);
    assert_int_equal(counters[FATHOM_STREAM_AMBIGUOUS], is_ambiguous ? outcome->windows - 1 : 0);
    assert_int_equal(shown, is_ambiguous ? 0 : start == 0 ? FRAMES - 2 : FRAMES - 3);
}

TEST(without_gaps_no_value_is_shown_wrongly_and_four_are_not_shown)
{
    uint8_t frame[LENGTH];
    hidden = 0;
    for (uint32_t value = 0; value != VALUES; value++) {
        const uint16_t mm = (uint16_t)value;
        rig_make_frame(frame, LENGTH, &mm);
        if (rig_has_two_alignments(frame, LENGTH)) assert_int_equal(value, two_readings[hidden++]);
    }
    assert_int_equal(hidden, TWO_READINGS);
    hidden = 0;
    assert_int_equal(for_each_value(false, look_without_gaps), runs_of_all());
    assert_int_equal(hidden, TWO_READINGS);
}

/* The four probes of an A05, held still at values that hide where a frame begins; with gaps seen from one of the ten
 * bytes, another one for the next values, and with FATHOM_LONG from each. */
TEST(frames_of_four_probes_are_never_shown_out_of_step)
{
    static const uint16_t values[] = {0x0000, 0x00FF, 0x01FF, 0x03E8, 0x07D0, 0x07FF, 0x053B,
                                      0x0DEA, 0xFF00, 0xFFFD, 0xFFFE, 0xFFFF, 0x1770, 0x00FA};
    enum { COUNT = sizeof values / sizeof values[0], LONG = FATHOM_DYP_A05_LENGTH };
    unsigned ambiguous = 0;
    uint32_t runs = 0;
    for (unsigned n = 0; n != COUNT * COUNT * COUNT * COUNT; n++) {
        const uint16_t probes[] = {values[n % COUNT], values[n / COUNT % COUNT],
                                   values[n / COUNT / COUNT % COUNT], values[n / COUNT / COUNT / COUNT]};
        uint8_t sent[4 * LONG];
        for (int i = 0; i != 4; i++) rig_make_frame(sent + i * LONG, LONG, probes);
        const bool is_ambiguous = rig_has_two_alignments(sent, LONG);
        if (is_ambiguous) ambiguous++;
        for (uint8_t start = 0; start != LONG; start++, runs++) {
            const rig_outcome_t outcome = rig_feed(sent, 4, LONG, start, false, RIG_BY_BYTE);
            assert_int_equal(outcome.wrong, 0);
            assert_int_equal(outcome.right, is_ambiguous ? 0 : start == 0 ? 2 : 1);
            if (!suite_is_long && n % LONG != start) continue;
            const rig_outcome_t with_gaps = rig_feed(sent, 4, LONG, start, true, RIG_BY_BYTE);
            assert_int_equal(with_gaps.wrong, 0);
            assert_int_equal(with_gaps.right, start == 0 ? 4 : 3);
        }
    }
    assert_int_equal(runs, COUNT * COUNT * COUNT * (uint32_t)COUNT * LONG);
    assert_true(ambiguous > 100); /* the set-up does hold such frames */
}
