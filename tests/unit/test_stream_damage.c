/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "stream_rig.h"

/*
 * One byte of a run of frames is lost, changed, or one too many: every byte, every value, so doubled ones too. With
 * gaps seen a frame that is a byte short or has one other byte is refused. Of one byte too many the sensor's last byte
 * is left over, its sum, and a frame is believed only if FF or a silence follows it: so only where the sum is FF can it
 * pass. Then the sum of what stands before it is compared with the last byte of the data, d. FF + all the data but d +
 * the new byte X = d has one solution X, wherever X stands between the start and d: a frame of L bytes has L - 2 such
 * places, and in each of them one in 256 passes, of one frame in 256. X in front of the start can be taken for it if X
 * is FF, and X in front of the sum for the sum if it is the same; then the frame is right.
 */
enum { GAP_US = 5000, PERIOD_US = 100000, RUN = 4, LONGEST = RUN * FATHOM_DYP_A05_LENGTH + 1 };

/* What comes on the wire. */
static struct {
    uint8_t bytes[LONGEST];
    uint8_t frame_of[LONGEST]; /* whose byte it is, or with whose bytes it comes */
    bool first[LONGEST];       /* of those of its frame */
    unsigned end[RUN];         /* the number of the byte behind the frame's own */
    unsigned count;
    unsigned hit; /* the byte that was changed or added; of one that was lost the next */
} wire;

static void put(uint8_t byte, unsigned frame)
{
    wire.bytes[wire.count] = byte;
    wire.frame_of[wire.count] = (uint8_t)frame;
    wire.first[wire.count] = wire.count == 0 || wire.frame_of[wire.count - 1] != frame;
    wire.count++;
}

typedef enum { LOST, CHANGED, ADDED } damage_t;

/* A run, and whether there are gaps, which are seen. */
typedef struct {
    const uint8_t *sent;
    uint8_t length;
    bool gaps;
} run_t;

/* The run with byte `place` of frame `hit` lost or changed to 0, or with a 0 added before it; place may be
 * `length` then, behind the last. */
static void send(const run_t *run, damage_t damage, unsigned hit, unsigned place)
{
    const uint8_t *sent = run->sent;
    wire.count = 0;
    for (unsigned frame = 0; frame != RUN; frame++) {
        for (unsigned at = 0; at <= run->length; at++) {
            const bool is_hit = frame == hit && at == place;
            if (at == run->length) wire.end[frame] = wire.count;
            if (is_hit) wire.hit = wire.count;
            if (is_hit && damage != LOST) put(0, frame);
            if (at != run->length && (!is_hit || damage == ADDED)) put(sent[at], frame);
        }
        sent += run->length;
    }
}

typedef struct {
    unsigned runs, right, wrong;
    unsigned due; /* by the formula above, how many should be wrong */
} counts_t;

static fathom_stream_config_t config;
static struct receiver {
    fathom_stream_t stream;
    uint8_t storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_MAX_LENGTH)];
    unsigned next; /* the frame that may be read next */
    unsigned right, wrong;
} receiver;

static void start(const run_t *run)
{
    config = (fathom_stream_config_t){.storage = receiver.storage, .length = run->length};
    receiver.next = receiver.right = receiver.wrong = 0;
    assert_int_equal(fathom_stream_init(&receiver.stream, &config, 0), FATHOM_OK);
}

static bool is_frame(const run_t *run, const uint8_t *frame, unsigned which)
{
    return memcmp(frame, run->sent + which * run->length, run->length) == 0;
}

/* A poll after byte i. A reading is right, with gaps, if it is the frame whose byte that is; without, if it is one
 * whose bytes had all come before it. Right ones come in order, each once. */
static void poll(const run_t *run, unsigned i, uint32_t now_us)
{
    const uint8_t *const frame = fathom_stream_frame(&receiver.stream);
    if (fathom_stream_poll(&receiver.stream, now_us) != FATHOM_OK) return;
    unsigned at = run->gaps ? wire.frame_of[i] : RUN - 1;
    while (!run->gaps && at > receiver.next && (wire.end[at] > i || !is_frame(run, frame, at))) at--;
    if (at >= receiver.next && (run->gaps || wire.end[at] <= i) && is_frame(run, frame, at)) {
        receiver.right++;
        receiver.next = at + 1;
    } else {
        receiver.wrong++;
    }
}

/* Byte by byte, so that a reading has one place. With gaps there is a silence of GAP_US behind the last byte of each
 * frame, and it is polled at its end. */
static void receive(const run_t *run, unsigned from, unsigned end)
{
    for (unsigned i = from; i != end; i++) {
        const uint32_t now_us = run->gaps ? wire.frame_of[i] * (uint32_t)PERIOD_US : 0;
        fathom_stream_feed(&receiver.stream, wire.bytes + i, 1, run->gaps && wire.first[i], now_us);
        poll(run, i, now_us);
        if (run->gaps && (i + 1 == wire.count || wire.first[i + 1])) poll(run, i, now_us + GAP_US);
    }
}

static void add_to(counts_t *counts)
{
    counts->runs++;
    counts->right += receiver.right;
    counts->wrong += receiver.wrong;
}

/* Is what then begins the frame's bytes a right frame with FF behind it, and not the one that was sent? */
static bool is_due(const uint8_t *frame, uint8_t length, unsigned place, uint8_t byte)
{
    uint8_t bytes[FATHOM_DYP_MAX_LENGTH + 1];
    memcpy(bytes, frame, place);
    bytes[place] = byte;
    memcpy(bytes + place + 1, frame + place, length - place);
    return rig_is_valid(bytes, length) && bytes[length] == 0xFF && memcmp(bytes, frame, length) != 0;
}

static void lose(counts_t *counts, const run_t *run, unsigned hit, unsigned place)
{
    send(run, LOST, hit, place);
    start(run);
    receive(run, 0, wire.count);
    add_to(counts);
}

/* With every other byte in this place. What stands before it is received once for all. */
static void damage_with_each(counts_t *counts, const run_t *run, damage_t damage, unsigned hit,
                             unsigned place)
{
    const uint8_t *const frame = run->sent + hit * run->length;
    send(run, damage, hit, place);
    start(run);
    receive(run, 0, wire.hit);
    const struct receiver before = receiver;
    for (unsigned byte = 0; byte != 256; byte++) {
        if (damage == CHANGED && byte == frame[place]) continue;
        wire.bytes[wire.hit] = (uint8_t)byte;
        receiver = before;
        receive(run, wire.hit, wire.count);
        add_to(counts);
        if (damage == ADDED) counts->due += is_due(frame, run->length, place, (uint8_t)byte);
    }
}

static void lose_each(counts_t *counts, const run_t *run)
{
    for (unsigned i = 0; i != RUN * run->length; i++) lose(counts, run, i / run->length, i % run->length);
}

static void change_each(counts_t *counts, const run_t *run)
{
    for (unsigned i = 0; i != RUN * run->length; i++)
        damage_with_each(counts, run, CHANGED, i / run->length, i % run->length);
}

static void add_each(counts_t *counts, const run_t *run)
{
    for (unsigned hit = 0; hit != RUN; hit++)
        for (unsigned place = 0; place <= run->length; place++)
            damage_with_each(counts, run, ADDED, hit, place);
}

/* ---- the runs ---- */

/* Two that are held still, and so many that move; of those there are more with FATHOM_LONG. */
static unsigned run_count(void) { return 2 + (suite_is_long ? 40 : 10); }

typedef void damage_each_t(counts_t *, const run_t *);

/* The first two of a length are an example of a datasheet and the frame that can be read out of step, held still
 * (A16 2(4), 511 mm; A05 1(3), 1000 2000 2047 1339 mm); in the others every frame is another, 250 to 4500 mm. */
static void make_run(uint8_t *sent, uint8_t length, unsigned number)
{
    static const uint16_t still[2][2][4] = {{{1953}, {511}},
                                            {{1000, 2000, 1953, 3562}, {1000, 2000, 2047, 1339}}};
    for (unsigned frame = 0; frame != RUN; frame++) {
        uint16_t values[4];
        for (unsigned i = 0; i != 4; i++) values[i] = (uint16_t)(250 + rig_random_below(4251));
        rig_make_frame(sent + frame * length, length, number < 2 ? still[length != 4][number] : values);
    }
}

enum { OF_FOUR = 0, OF_TEN = 1, LENGTHS = 2 };

static const uint8_t lengths[LENGTHS] = {FATHOM_DYP_A16_LENGTH, FATHOM_DYP_A05_LENGTH};

/* All runs of one length. */
static counts_t damage_all(damage_each_t *each, unsigned which, bool gaps)
{
    counts_t counts = {0, 0, 0, 0};
    rig_seed(7);
    for (unsigned number = 0; number != run_count(); number++) {
        uint8_t sent[RUN * FATHOM_DYP_A05_LENGTH];
        make_run(sent, lengths[which], number);
        each(&counts, &(run_t){sent, lengths[which], gaps});
    }
    print_message("  %2u bytes, gaps %s: %u runs, %u right readings, %u wrong, %u by the formula\n",
                  lengths[which], gaps ? "seen" : "not seen", counts.runs, counts.right, counts.wrong,
                  counts.due);
    return counts;
}

/* How many bytes the runs of one length have. */
static unsigned bytes_of(unsigned which) { return run_count() * RUN * lengths[which]; }

/* Each byte that is lost or changed, of both lengths. */
static void expect_none_wrong(bool gaps)
{
    for (unsigned i = 0; i != 2 * LENGTHS; i++) {
        const unsigned which = i / 2, bytes = bytes_of(which);
        const counts_t counts = damage_all(i % 2 == 0 ? lose_each : change_each, which, gaps);
        assert_int_equal(counts.wrong, 0);
        assert_int_equal(counts.runs, i % 2 == 0 ? bytes : 255 * bytes);
        if (gaps)
            assert_int_equal(counts.right, counts.runs * (RUN - 1));
        else
            assert_true(counts.right > counts.runs / 2);
    }
}

TEST(with_gaps_seen_a_lost_or_changed_byte_costs_its_frame_and_shows_nothing_else)
{
    expect_none_wrong(true);
}

TEST(without_gaps_no_lost_or_changed_byte_shows_a_wrong_reading) { expect_none_wrong(false); }

/* None but of the frames that end in FF: L - 2 of the 256 (L + 1) ways of such a frame, and FF in front of the start.
 * There are four of them at least, of 511 mm, FF 01 FF FF: in front of the start and behind it FF makes it FF FF 01 FF,
 * and behind 01 it stays as it is, so 2 ways each. */
TEST(with_gaps_seen_an_added_byte_passes_only_where_the_sum_is_FF)
{
    for (unsigned which = 0; which != LENGTHS; which++) {
        const unsigned frames = run_count() * RUN;
        unsigned ends_in_FF = 0;
        rig_seed(7);
        for (unsigned number = 0; number != run_count(); number++) {
            uint8_t sent[RUN * FATHOM_DYP_A05_LENGTH];
            make_run(sent, lengths[which], number);
            for (unsigned i = 1; i <= RUN; i++) ends_in_FF += sent[i * lengths[which] - 1] == 0xFF;
        }
        const counts_t counts = damage_all(add_each, which, true);
        assert_int_equal(counts.wrong, counts.due);
        assert_in_range(counts.wrong, which == OF_FOUR ? 2 * RUN : 0, ends_in_FF * (lengths[which] - 1u));
        assert_int_equal(counts.runs, 256 * frames * (lengths[which] + 1u));
        assert_in_range(counts.right, counts.runs * (RUN - 1), counts.runs * RUN);
    }
}

/*
 * All frames FF H L FF of an A16, where H + L = 100 or both are 0: one for each H. By hand, of the 5 x 256 ways to add
 * a byte X to one:
 *   X FF H L (FF): X is FF, and FF + FF + H = L for 2 H = 2, so H is 01 or 81                            2
 *   FF X H L (FF): FF + X + H = L for one X, and it is never the frame that was sent                    256
 *   FF H X L (FF): the same X; with H = 01 it is FF, and the frame stays FF 01 FF FF                    255
 *   FF H L X (FF) is right for X = FF alone, and FF H L FF (X) as well
 * Of all others none passes, which makes 513 of 65536 x 5 x 256, one in 163520.
 */
TEST(with_gaps_seen_513_of_all_bytes_added_to_all_frames_of_an_A16_pass)
{
    enum { PASS = 2 + 256 + 255 };
    static const uint16_t example = 1953;
    uint8_t sent[RUN * FATHOM_DYP_A16_LENGTH];
    counts_t counts = {0, 0, 0, 0};
    for (unsigned frame = 0; frame != RUN; frame++) rig_make_frame(sent + frame * 4, 4, &example);
    for (unsigned high = 0; high != 256; high++) {
        const uint16_t value = (uint16_t)(high * 256 + (256 - high) % 256);
        rig_make_frame(sent + 4, 4, &value);
        assert_int_equal(sent[7], 0xFF);
        for (unsigned place = 0; place <= 4; place++)
            damage_with_each(&counts, &(run_t){sent, 4, true}, ADDED, 1, place);
    }
    assert_int_equal(counts.runs, 256 * 5 * 256);
    assert_int_equal(counts.wrong, PASS);
}

/* 1000 2000 1953 3465 mm: FF + 03 + E8 + 07 + D0 + 07 + A1 + 0D + 89 = 3FF. All but 89 and the sum make 376, so X =
 * 89 - 76 = 13 passes, in 8 places; FF in front would want 75 for the 89. */
TEST(of_the_bytes_added_to_four_probes_with_a_sum_of_FF_8_pass)
{
    static const uint16_t values[4] = {1000, 2000, 1953, 3465};
    uint8_t sent[RUN * FATHOM_DYP_A05_LENGTH];
    counts_t counts = {0, 0, 0, 0};
    for (unsigned frame = 0; frame != RUN; frame++) rig_make_frame(sent + frame * 10, 10, values);
    assert_int_equal(sent[9], 0xFF);
    add_each(&counts, &(run_t){sent, 10, true});
    assert_int_equal(counts.runs, RUN * 11 * 256);
    assert_int_equal(counts.wrong, RUN * 8);
}

/*
 * Without gaps a byte that is added inside a frame never passes: what it leaves over, the sum, does not begin a
 * frame. What passes is 511 mm held still with an FF too many behind the very first frame that is heard,
 * FF 01 FF FF (FF) FF 01 FF FF: from the added FF on it reads FF FF 01 FF, 65281 mm, right upon a valid frame and
 * with an FF behind it. That is beyond all that an A16 measures. Later frames are known to be ambiguous. The FF can
 * be added at 5 places between the 01 of the first frame and that of the second.
 */
TEST(without_gaps_only_an_FF_after_the_first_511_mm_held_still_shows_another_value)
{
    enum { ADDED_FF = 5 };
    for (unsigned which = 0; which != LENGTHS; which++) {
        const counts_t counts = damage_all(add_each, which, false);
        assert_int_equal(counts.wrong, which == OF_FOUR ? ADDED_FF : 0);
        assert_int_equal(counts.runs, 256 * run_count() * RUN * (lengths[which] + 1));
        assert_true(counts.right > counts.runs / 2);
    }
}

/*
 * The frame that can be read out of step, twice, and then with one millimetre more at probe 1, twice:
 *   FF 03 E8 07 D0 07 FF 05 3B 07   FF 03 E9 07 D0 07 FF 05 3B 08
 * Out of step by six the first two are valid, and the second with the third would be if it were one less:
 * FF + 05 + 3B + 07 + FF + 03 + E9 + 07 + D0 = 408, and 07 ends it. So one wrong bit of the second, 05 -> 04, 3B ->
 * 3A or 07 -> 06, damages the right frame and makes a second one out of step, ten bytes behind the first. Without
 * gaps that one is not shown because the first overlapped a right frame.
 */
TEST(without_gaps_a_wrong_bit_does_not_permute_the_probes_of_a_frame_out_of_step)
{
    static const uint16_t values[2][4] = {{1000, 2000, 2047, 1339}, {1001, 2000, 2047, 1339}};
    uint8_t sent[RUN * FATHOM_DYP_A05_LENGTH];
    counts_t counts = {0, 0, 0, 0};
    for (unsigned i = 0; i != RUN; i++) rig_make_frame(sent + i * 10, 10, values[i / 2]);
    change_each(&counts, &(run_t){sent, 10, false});
    assert_int_equal(counts.runs, 255 * RUN * 10);
    assert_int_equal(counts.wrong, 0);
    counts = (counts_t){0, 0, 0, 0};
    change_each(&counts, &(run_t){sent, 10, true});
    assert_int_equal(counts.runs, 255 * RUN * 10);
    assert_int_equal(counts.wrong, 0);
}

/*
 * Without gaps a lost byte is made up for by the FF that begins the next frame, and a frame is taken to begin behind
 * that if the next frame's own first value begins with FF, which "nothing in range" does: FF FF FD FB. By hand, over
 * all FF H L S, S = H + L - 1:
 *   H lost, FF L S FF: FF + L + S = FF for 2 L + H = 1, one H to each L                              256 values
 *   L lost, FF H S FF: FF + H + S = FF for 2 H + L = 1, one L to each H; 01FF stays what it is        255
 *   FF lost, which is seen only if H is FF; that is H lost, and L is 01 or 81                            2
 *   S lost: it was FF, and the frame is right
 * So one in 511 of the lost bytes passes; 2035 mm, FF 07 F3 F9, without F3 reads 2041 mm.
 */
TEST(without_gaps_one_lost_byte_in_511_passes_before_a_frame_with_no_target)
{
    enum { PASS = 256 + 255 + 2 };
    static const uint16_t example = 1953;
    static const uint16_t no_target = 0xFFFD;
    uint8_t sent[RUN * FATHOM_DYP_A16_LENGTH];
    counts_t counts = {0, 0, 0, 0};
    counts_t with_gaps = {0, 0, 0, 0};
    rig_make_frame(sent, 4, &example);
    for (unsigned frame = 2; frame != RUN; frame++) rig_make_frame(sent + frame * 4, 4, &no_target);
    for (unsigned mm = 0; mm != 65536; mm++) {
        const uint16_t value = (uint16_t)mm;
        rig_make_frame(sent + 4, 4, &value);
        for (unsigned place = 0; place != 4; place++) {
            lose(&counts, &(run_t){sent, 4, false}, 1, place);
            lose(&with_gaps, &(run_t){sent, 4, true}, 1, place);
        }
    }
    assert_int_equal(counts.runs, 4 * 65536);
    assert_int_equal(counts.wrong, PASS);
    assert_int_equal(with_gaps.runs, 4 * 65536);
    assert_int_equal(with_gaps.wrong, 0);
}
