/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "hex.h"
#include "stream_rig.h"

/* stream.h, rules 5, 7 and 8: what the stream drops, how it counts this, and which damage cannot be seen. */

enum { GAP_US = 5000, PERIOD_US = 100000, STALE_US = 2000000 };

static fathom_stream_t stream;
static uint8_t storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_MAX_LENGTH)];

static void begin(uint8_t length)
{
    const fathom_stream_config_t config = {.storage = storage, .length = length};
    memset(&stream, 0xA5, sizeof stream);
    memset(storage, 0xFF, sizeof storage);
    assert_int_equal(fathom_stream_init(&stream, &config, 0), FATHOM_OK);
}

static void feed_hex(const char *hex, bool after_gap, uint32_t time_us)
{
    uint8_t bytes[64];
    fathom_stream_feed(&stream, bytes, hex_parse(hex, bytes), after_gap, time_us);
}

static fathom_status_t poll(uint32_t now_us) { return fathom_stream_poll(&stream, now_us); }

static unsigned counted(unsigned which) { return stream.counters[which]; }

/* ---- counters ---- */

/* 1953 mm is FF 07 A1 A7 (A16 2(4)). In a conversation a bar is a measured silence and an x a loss; the line is silent
 * at the end. 511 mm, FF 01 FF FF, is valid one byte early too: FF FF 01 FF, as FF + FF + 01 = 1FF. */
static const struct {
    const char *wire;
    unsigned frames, damaged, unsure, ambiguous, dropped;
} conversations[] = {
    {"| FF 07 A1 A7 |", 1, 0, 0, 0, 0},
    {"| FF 07 A1 A7 FF 07 A1 A7 |", 2, 0, 0, 0, 0},
    {"| FF 06 A1 A7 |", 0, 1, 0, 0, 4},                    /* one wrong bit in the data */
    {"| FF 07 A1 A6 |", 0, 1, 0, 0, 4},                    /* in the sum */
    {"| FE 07 A1 A7 |", 0, 1, 0, 0, 4},                    /* in the first byte */
    {"| FF 07 A1 |", 0, 1, 0, 0, 3},                       /* a byte too few */
    {"| FF 07 A1 A7 55 |", 0, 0, 1, 0, 5},                 /* a byte too many */
    {"| FF 07 A1 A7 | 55 | FF 07 A1 A7 |", 2, 1, 0, 0, 1}, /* a byte alone is less than a frame */
    {"| FF 07 A1 A7 FF 06 A1 A7 |", 1, 1, 0, 0, 4},
    {"| FF 07 A1 A7 x FF 07 A1 A7 |", 0, 0, 2, 0, 8}, /* neither what follows nor what precedes is known */
    {"FF 07 A1 A7 FF 07 A1 A7 x FF", 0, 0, 2, 0,
     9},                                      /* the second is believed if FF follows, which is not known */
    {"| FF 07 x A1 A7 |", 0, 1, 0, 0, 4},     /* of the second half the place is not known */
    {"A1 A7 | FF 07 A1 A7 |", 1, 0, 0, 0, 2}, /* nor that of the first bytes of all */
    {"FF 07 A1 A7 FF 07 A1 A7 |", 1, 0, 1, 0, 4},
    {"FF 01 FF FF FF 01 FF FF |", 0, 0, 1, 2, 8},
    /* 4321 mm is FF 10 E1 F0. Without its third byte the next frame's FF is a right sum, FF + 10 + F0 = 1FF, and
     * the next frame itself overlaps a valid one */
    {"| FF 10 F0 FF 10 E1 F0 |", 0, 0, 1, 1, 7},
    /* with 9B too many before the A1, the A1 is a right sum: FF + 07 + 9B = 1A1 */
    {"| FF 07 9B A1 A7 |", 0, 0, 1, 0, 5},
    {"| FF 06 A1 A7 FF 06 A1 A7 FF 06 A1 A7 |", 0, 1, 0, 0, 12}, /* only the first place is known */
};

static void play(const char *wire)
{
    uint32_t now_us = 1000;
    bool is_after_gap = false;
    for (const char *at = wire; *at != '\0'; at++) {
        char byte[3] = "";
        if (*at == ' ') continue;
        now_us += 1042;
        if (*at == '|') {
            is_after_gap = true;
        } else if (*at == 'x') {
            fathom_stream_feed(&stream, NULL, 0, false, now_us);
        } else {
            memcpy(byte, at, 2);
            at++;
            feed_hex(byte, is_after_gap, now_us);
            is_after_gap = false;
        }
    }
    fathom_stream_feed(&stream, NULL, 0, true, now_us + GAP_US); /* the silence at the end */
}

TEST(each_kind_of_damage_has_its_counter)
{
    for (size_t i = 0; i != sizeof conversations / sizeof conversations[0]; i++) {
        begin(4);
        play(conversations[i].wire);
        if (counted(FATHOM_STREAM_FRAMES) != conversations[i].frames ||
            counted(FATHOM_STREAM_DAMAGED) != conversations[i].damaged ||
            counted(FATHOM_STREAM_UNSURE) != conversations[i].unsure ||
            counted(FATHOM_STREAM_AMBIGUOUS) != conversations[i].ambiguous ||
            counted(FATHOM_STREAM_DROPPED_BYTES) != conversations[i].dropped)
            fail_msg("%s: frames %u, damaged %u, unsure %u, ambiguous %u, dropped %u", conversations[i].wire,
                     counted(FATHOM_STREAM_FRAMES), counted(FATHOM_STREAM_DAMAGED),
                     counted(FATHOM_STREAM_UNSURE), counted(FATHOM_STREAM_AMBIGUOUS),
                     counted(FATHOM_STREAM_DROPPED_BYTES));
    }
}

/* Bytes among which frames are likely, with silences and losses at random places. */
TEST(each_byte_is_in_a_frame_or_dropped_or_undecided)
{
    static const uint8_t likely[] = {0xFF, 0xFF, 0x01, 0x07, 0xA1, 0xA7, 0xFE, 0x00};
    for (uint8_t length = 4; length <= 10; length += 6) {
        for (uint32_t seed = 1; seed != 50; seed++) {
            unsigned bytes = 0;
            rig_seed(seed);
            begin(length);
            for (uint32_t now_us = 0; now_us != 1000; now_us++) {
                uint8_t sent[12];
                const uint16_t values[4] = {1953, 1953, 511, (uint16_t)rig_random_below(6000)};
                uint8_t count = (uint8_t)rig_random_below(4);
                for (unsigned i = 0; i != count; i++) sent[i] = likely[rig_random_below(sizeof likely)];
                if (rig_random_below(3) == 0) rig_make_frame(sent, count = length, values);
                fathom_stream_feed(&stream, sent, count, rig_random_below(4) == 0, now_us);
                bytes += count;
                if (rig_random_below(4) == 0) (void)poll(now_us);
                assert_in_range(stream.undecided_count, 0, length);
                assert_int_equal(counted(FATHOM_STREAM_BYTES), bytes);
                assert_int_equal(bytes, counted(FATHOM_STREAM_FRAMES) * length +
                                            counted(FATHOM_STREAM_DROPPED_BYTES) + stream.undecided_count);
            }
            assert_true(counted(FATHOM_STREAM_FRAMES) > 20);
        }
    }
}

/* An A16 of which every fifth, fourth, third or second frame has one wrong bit, each bit in its turn. */
TEST(every_frame_with_a_wrong_bit_is_counted_and_no_other_is_lost)
{
    for (unsigned each = 2; each <= 5; each++) {
        unsigned damaged = 0;
        unsigned read = 0;
        begin(4);
        for (unsigned n = 0; n != 32 * each; n++) {
            uint8_t frame[] = {0xFF, 0x07, 0xA1, 0xA7};
            if (n % each == each - 1) {
                frame[damaged / 8] ^= (uint8_t)(1u << damaged % 8);
                damaged++;
            }
            fathom_stream_feed(&stream, frame, 4, true, n * PERIOD_US);
            read += poll(n * PERIOD_US + GAP_US) == FATHOM_OK;
        }
        assert_int_equal(damaged, 32);
        assert_int_equal(read, 32 * (each - 1));
        assert_int_equal(counted(FATHOM_STREAM_DAMAGED), 32);
        fathom_stream_feed(&stream, NULL, 0, true, 32 * each * PERIOD_US);
        assert_int_equal(counted(FATHOM_STREAM_DROPPED_BYTES), 4 * 32);
    }
}

TEST(counters_of_damage_stop_at_65535)
{
    begin(4);
    stream.counters[FATHOM_STREAM_DAMAGED] = UINT16_MAX;
    stream.counters[FATHOM_STREAM_DROPPED_BYTES] = UINT16_MAX - 1;
    feed_hex("FF 06 A1 A7", true, 10);
    feed_hex("FF 06 A1", true, 10000);
    feed_hex("FF", true, 20000);
    assert_int_equal(counted(FATHOM_STREAM_DAMAGED), UINT16_MAX);
    assert_int_equal(counted(FATHOM_STREAM_DROPPED_BYTES), UINT16_MAX);
}

/* ---- the error ---- */

TEST(a_deadline_with_bytes_is_damage_and_without_is_stale)
{
    static const uint8_t zeros[100];
    uint32_t now_us = 0;
    begin(4);
    for (unsigned second = 1; second <= 8; second++) {
        for (unsigned i = 0; i != 9; i++) fathom_stream_feed(&stream, zeros, 100, false, now_us + i * 100000);
        now_us += 1000000;
        assert_int_equal(poll(now_us), second % 2 != 0 ? FATHOM_PENDING : FATHOM_ERR_CHECKSUM);
    }
    assert_int_equal(counted(FATHOM_STREAM_STALES), 4);
    assert_int_equal(counted(FATHOM_STREAM_DROPPED_BYTES), 8 * 900 - 4);
    assert_int_equal(poll(now_us + STALE_US), FATHOM_ERR_STALE);
    assert_int_equal(poll(now_us + 2 * STALE_US), FATHOM_ERR_STALE);
    feed_hex("FF 07 A1 A7", true, now_us + 2 * STALE_US);
    assert_int_equal(poll(now_us + 2 * STALE_US + GAP_US), FATHOM_OK);
    assert_int_equal(poll(now_us + 3 * STALE_US + GAP_US), FATHOM_ERR_STALE); /* the frame was no damage */
}

/* The port reports bytes with parity errors as lost: the wire was not silent. */
TEST(lost_bytes_are_damage_too)
{
    begin(4);
    fathom_stream_feed(&stream, NULL, 0, false, 1000);
    assert_int_equal(poll(STALE_US), FATHOM_ERR_CHECKSUM);
    assert_int_equal(poll(2 * STALE_US), FATHOM_ERR_STALE);
}

/* The FF of a second frame ends the first; the sensor is then unplugged. */
TEST(a_frame_that_broke_off_behind_a_good_one_is_damage)
{
    begin(4);
    feed_hex("FF 07 A1 A7 FF", true, 1000);
    assert_int_equal(poll(1000), FATHOM_OK);
    assert_int_equal(poll(1000 + STALE_US), FATHOM_ERR_CHECKSUM);
}

/* ---- damage that cannot be seen (rule 8) ---- */

static bool is_valid_with(const uint8_t *frame, uint8_t length, unsigned one, unsigned other)
{
    uint8_t bytes[FATHOM_DYP_MAX_LENGTH];
    memcpy(bytes, frame, length);
    bytes[one / 8] ^= (uint8_t)(1u << one % 8);
    if (other != one) bytes[other / 8] ^= (uint8_t)(1u << other % 8);
    return fathom_dyp_stream_is_valid(bytes, length);
}

/* How many of the pairs of wrong bits leave the frame valid. */
static unsigned passing_pairs(const uint8_t *frame, uint8_t length)
{
    unsigned passing = 0;
    for (unsigned one = 0; one != 8u * length; one++)
        for (unsigned other = one + 1; other != 8u * length; other++)
            passing += is_valid_with(frame, length, one, other);
    return passing;
}

/*
 * Two wrong bits cancel only at the same place of two bytes: two data bytes whose bits differ (+ 2^k - 2^k), or a data
 * byte and the sum whose bits are equal; bit 7 in any case (2 * 80 = 100). Of FF H L SUM these are the pairs HL, HS and
 * LS. If the bits of H and L differ, one of HS and LS is equal: 2 pairs. If they are equal, both or none: 2 or 0 pairs.
 * Over all values that is 2 in three of four cases, 1.5 on average. So of 32 * 31 / 2 = 496 pairs of bits,
 * 7 * 1.5 + 3 = 13.5 pass on average and 7 * 2 + 3 = 17 at most.
 */
TEST(of_496_pairs_of_wrong_bits_in_4_bytes_13_and_a_half_pass_and_no_single_one)
{
    uint32_t passing = 0;
    unsigned most = 0;
    uint8_t frame[4];
    const unsigned step = suite_is_long ? 1 : 7; /* coprime to 65536 */
    unsigned tried = 0;
    for (uint32_t mm = 0; mm < 65536; mm += step) {
        const uint16_t value = (uint16_t)mm;
        rig_make_frame(frame, 4, &value);
        for (unsigned bit = 0; bit != 32; bit++) assert_false(is_valid_with(frame, 4, bit, bit));
        const unsigned pairs = passing_pairs(frame, 4);
        passing += pairs;
        if (pairs > most) most = pairs;
        tried++;
    }
    assert_int_equal(most, 17);
    if (suite_is_long)
        assert_int_equal(passing, 65536 / 2 * 27);
    else
        assert_in_range(passing * 100 / tried, 1340, 1360);
}

/* 9 * 8 / 2 = 36 pairs of the 9 bytes behind the first: 36 * (7 / 2 + 1) = 162 of 80 * 79 / 2 = 3160 pairs of bits. */
TEST(of_3160_pairs_of_wrong_bits_in_10_bytes_162_pass)
{
    uint32_t passing = 0;
    rig_seed(1);
    for (unsigned n = 0; n != 400; n++) {
        uint8_t frame[10];
        uint16_t values[4];
        for (unsigned i = 0; i != 4; i++) values[i] = (uint16_t)rig_random_below(65536);
        rig_make_frame(frame, 10, values);
        for (unsigned bit = 0; bit != 80; bit++) assert_false(is_valid_with(frame, 10, bit, bit));
        passing += passing_pairs(frame, 10);
    }
    assert_in_range(passing / 400, 159, 165);
}

typedef struct {
    uint32_t sent, seen, wrong;
} damage_t;

enum { INDEPENDENT_BITS, BIT_3_OF_EACH_BYTE, BIT_7_OF_EACH_BYTE, RANDOM_BYTES };

/* A wrong byte, of which each bit, or the one bit, is wrong with chance q / 10000. */
static uint8_t hit(uint8_t byte, unsigned way, unsigned q)
{
    for (unsigned bit = 0; bit != 8; bit++) {
        if (way == BIT_3_OF_EACH_BYTE && bit != 3) continue;
        if (way == BIT_7_OF_EACH_BYTE && bit != 7) continue;
        if (rig_random_below(10000) < q) byte ^= (uint8_t)(1u << bit);
    }
    return byte;
}

/* Frames of random values with silences between them, read by a stream; its counters show the damage. */
static damage_t damage(unsigned way, unsigned q, uint8_t length)
{
    damage_t damage = {suite_is_long ? 1000000 : 100000, 0, 0};
    rig_seed(7);
    begin(length);
    for (uint32_t n = 0; n != damage.sent; n++) {
        uint8_t frame[10];
        uint8_t sent[10];
        uint16_t values[4];
        for (unsigned i = 0; i != 4; i++) values[i] = (uint16_t)rig_random_below(65536);
        rig_make_frame(frame, length, values);
        memcpy(sent, frame, sizeof sent);
        for (uint8_t i = 0; i != length; i++) {
            if (way != RANDOM_BYTES)
                sent[i] = hit(frame[i], way, q);
            else if (i != 0)
                sent[i] = (uint8_t)rig_random_below(256);
        }
        fathom_stream_feed(&stream, sent, length, true, n * PERIOD_US);
        if (poll(n * PERIOD_US + GAP_US) == FATHOM_OK)
            damage.wrong += memcmp(fathom_stream_frame(&stream), frame, length) != 0;
        damage.seen += stream.counters[FATHOM_STREAM_DAMAGED];
        stream.counters[FATHOM_STREAM_DAMAGED] = 0;
    }
    return damage;
}

/* wrong / sent = k * (seen / sent)^2, with k in thousandths. */
static unsigned coefficient(damage_t of)
{
    return (unsigned)((uint64_t)of.wrong * of.sent * 1000 / ((uint64_t)of.seen * of.seen));
}

/* The table of rule 8. Of independent bits k = 13.5 / 32^2 = 0.0132, and 162 / 80^2 = 0.0253; of one bit of each byte
 * 1.5 / 4^2 = 0.094 (bit 7: 3 / 16 = 0.19), and 18 / 10^2 = 0.18 (36 / 100 = 0.36). With 1 % of
 * wrong bits 27 % of the frames of 4 bytes are damaged, and 55 % of 10 bytes. With 5 % of wrong bits 3 or 7, 19 % of 4
 * bytes; with 2 %, 18 % of 10 bytes. The bounds are four deviations. */
TEST(the_share_of_wrong_values_follows_from_the_damage_that_is_counted)
{
    assert_in_range(coefficient(damage(INDEPENDENT_BITS, 100, 4)), 8, 18);
    assert_in_range(coefficient(damage(INDEPENDENT_BITS, 100, 10)), 20, 31);
    assert_in_range(coefficient(damage(BIT_3_OF_EACH_BYTE, 500, 4)), 70, 120);
    assert_in_range(coefficient(damage(BIT_3_OF_EACH_BYTE, 200, 10)), 150, 230);
    assert_in_range(coefficient(damage(BIT_7_OF_EACH_BYTE, 500, 4)), 150, 230);
    const damage_t random = damage(RANDOM_BYTES, 0, 4);
    assert_in_range(random.seen / random.wrong, 255 - 50, 255 + 60); /* d / 255 */
}
