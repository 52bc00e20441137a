/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/engine/stream.h"
#include "hex.h"

static const uint8_t mm_1953[] = {0xFF, 0x07, 0xA1, 0xA7};                                  /* A16 2(4) */
static const uint8_t four[] = {0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x60}; /* A05 1(3) */
static const uint8_t mm_511[] = {0xFF, 0x01, 0xFF, 0xFF}; /* FF + 01 + FF = 1FF; as FF FF 01 FF 65281 mm */
static const uint8_t permutable[] = {0xFF, 0x03, 0xE8, 0x07, 0xD0,
                                     0x07, 0xFF, 0x05, 0x3B, 0x07}; /* 407 hex */

static fathom_stream_t stream;
static fathom_stream_config_t config;
static uint8_t storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_MAX_LENGTH)];

/* A stream that begins at this time, with this gap_us; 0: 5 ms. */
static void begin_with(uint8_t length, uint32_t now_us, uint16_t gap_us)
{
    config =
        (fathom_stream_config_t){.storage = storage, .length = length, .gap_us = gap_us, .stale_us = 2000000};
    memset(&stream, 0xA5, sizeof stream);
    memset(storage, 0xFF, sizeof storage);
    assert_int_equal(fathom_stream_init(&stream, &config, now_us), FATHOM_OK);
}

static void begin(uint8_t length) { begin_with(length, 0, 0); }

static void feed(const uint8_t *bytes, uint8_t count, bool after_gap, uint32_t time_us)
{
    fathom_stream_feed(&stream, bytes, count, after_gap, time_us);
}

static void feed_hex(const char *hex, bool after_gap, uint32_t time_us)
{
    uint8_t bytes[16];
    feed(bytes, hex_parse(hex, bytes), after_gap, time_us);
}

/* mm_1953, in step with what came before it or after a gap; its beginning; and bytes that were lost. */
static void feed_frame(uint32_t time_us) { feed(mm_1953, 4, false, time_us); }
static void feed_first(uint32_t time_us) { feed(mm_1953, 4, true, time_us); }
static void feed_start(uint32_t time_us) { feed(mm_1953, 1, false, time_us); }
static void feed_loss(uint32_t time_us) { feed(NULL, 0, false, time_us); }

static fathom_status_t poll_at(uint32_t now_us) { return fathom_stream_poll(&stream, now_us); }

#define expect(now_us, status)     assert_int_equal(poll_at(now_us), status)
#define expect_due(now_us, us)     assert_int_equal(fathom_stream_due_us(&stream, now_us), us)
#define expect_counted(counter, n) assert_int_equal(stream.counters[counter], n)

/* A poll gives this frame, whose last byte came then. */
static void expect_frame(uint32_t now_us, const uint8_t *bytes, uint32_t came_us)
{
    expect(now_us, FATHOM_OK);
    assert_memory_equal(fathom_stream_frame(&stream), bytes, config.length);
    assert_int_equal(stream.time_us, came_us);
}

/* Every test begins with a stream of frames of 4 bytes, at 0. */
static int set_up(void **state)
{
    begin(4);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static void expect_init(fathom_status_t status)
{
    assert_int_equal(fathom_stream_init(&stream, &config, 0), status);
}

TEST(a_config_without_storage_or_with_another_length_is_refused)
{
    config = (fathom_stream_config_t){.storage = NULL, .length = 4};
    expect_init(FATHOM_ERR_ARGUMENT);
    config = (fathom_stream_config_t){.storage = storage, .length = 5};
    expect_init(FATHOM_ERR_ARGUMENT);
    config.length = 10;
    expect_init(FATHOM_OK);
    assert_int_equal(stream.listener.gap_us, 5000);
    config.gap_us = 25000;
    expect_init(FATHOM_OK);
    assert_int_equal(stream.listener.gap_us, 25000);
}

TEST(the_first_frame_after_a_gap_is_believed_when_a_gap_follows_it)
{
    begin_with(4, 1000, 0);
    feed_first(1500);
    expect(6499, FATHOM_PENDING);
    expect_frame(6500, mm_1953, 1500);
    expect(6600, FATHOM_PENDING); /* each frame once */

    begin_with(10, 1000, 0);
    feed(four, 10, true, 1500);
    expect_frame(6500, four, 1500);
}

/* ---- First contact 3: is the place of a frame sure? ---- */

TEST(a_place_is_sure_between_two_silences)
{
    feed_first(1500);
    expect(6500, FATHOM_OK);
    assert_true(stream.is_sure);
    feed_first(100000);
    feed_first(200000); /* the silence was told with the bytes behind it */
    expect(200000, FATHOM_OK);
    assert_true(stream.is_sure);
    begin(4);
    feed_first(10);
    feed_start(10);
    expect(10, FATHOM_OK);
    assert_false(stream.is_sure);
}

TEST(a_place_is_sure_from_the_third_frame_in_step)
{
    for (unsigned with_gap = 0; with_gap != 2; with_gap++) {
        begin(4);
        feed(mm_1953, 4, with_gap != 0, 10);
        for (unsigned n = 2; n <= 300; n++) {
            feed_frame(10 * n);
            expect(10 * n, with_gap != 0 || n > 2 ? FATHOM_OK : FATHOM_PENDING);
            if (stream.counters[FATHOM_STREAM_FRAMES] != 0) assert_int_equal(stream.is_sure, n > 3);
        }
    }
}

/* A byte between two frames, bytes that were lost, and a sum that is right in two places each end the run. */
TEST(a_run_that_is_broken_begins_anew)
{
    static const uint8_t noise[] = {0x55};
    for (unsigned way = 0; way != 3; way++) {
        begin(4);
        for (unsigned n = 0; n != 5; n++) feed_frame(n);
        if (way == 0) feed(noise, 1, false, 5);
        if (way == 1) feed_loss(5);
        for (unsigned n = 0; way == 2 && n != 2; n++) feed(mm_511, 4, false, 5);
        (void)poll_at(5);
        for (unsigned n = 0; n <= 4; n++) {
            feed_frame(6 + n);
            assert_int_equal(poll_at(6 + n), n > 1 ? FATHOM_OK : FATHOM_PENDING);
            if (n > 1) assert_int_equal(stream.is_sure, n > 2);
        }
        feed_start(20);
        expect(20, FATHOM_OK);
        assert_true(stream.is_sure);
    }
}

/* Not polled in between: what begins after the silence is no frame, and the one before it has ended all the same. */
TEST(a_silence_that_no_poll_saw_ends_a_frame_whatever_comes_after_it)
{
    feed_first(10);
    feed(mm_1953 + 1, 3, true, 20000);
    expect_frame(20000, mm_1953, 10);
    expect_counted(FATHOM_STREAM_UNSURE, 0);
}

TEST(a_value_that_is_valid_in_two_alignments_is_never_shown_without_a_gap)
{
    for (int i = 0; i != 100; i++) feed(mm_511, 4, false, 10);
    expect(20, FATHOM_PENDING);
    expect_counted(FATHOM_STREAM_FRAMES, 0);
    /* 100 right windows and 99 across two frames; only the very first has no other before it. */
    expect_counted(FATHOM_STREAM_AMBIGUOUS, 198);

    begin(10);
    for (int i = 0; i != 100; i++) feed(permutable, 10, false, 10);
    expect(20, FATHOM_PENDING);
    expect_counted(FATHOM_STREAM_FRAMES, 0);
}

TEST(a_frame_that_broke_off_before_a_gap_leaves_no_trace)
{
    for (uint8_t length = 1; length != 4; length++) {
        begin(4);
        feed(mm_511, length, true, 10);
        feed_first(20);
        expect_frame(5020, mm_1953, 20);
        expect_counted(FATHOM_STREAM_FRAMES, 1);
    }
}

/* MISSED: "good ones that a newer one replaced before it was polled". */
TEST(the_newest_frame_wins_and_the_older_is_counted)
{
    static const uint8_t mm_1000[] = {0xFF, 0x03, 0xE8, 0xEA}; /* FF + 03 + E8 = 1EA */
    feed_first(10);
    expect_frame(9000, mm_1953, 10);
    feed_first(10010);
    expect_frame(19000, mm_1953, 10010);
    expect_counted(FATHOM_STREAM_MISSED, 0);
    feed_first(20010);
    feed(mm_1000, 4, true, 20020);
    expect_frame(25020, mm_1000, 20020);
    expect_counted(FATHOM_STREAM_MISSED, 1);
    expect(25040, FATHOM_PENDING);
}

TEST(a_silent_stream_is_stale_once_every_deadline)
{
    begin_with(4, 1000, 0);
    config.stale_us = 500000;
    fathom_stream_init(&stream, &config, 1000);
    expect(500999, FATHOM_PENDING);
    expect(501000, FATHOM_ERR_STALE);
    expect(501001, FATHOM_PENDING);
    expect(1000999, FATHOM_PENDING);
    expect(1001000, FATHOM_ERR_STALE);
    expect_counted(FATHOM_STREAM_STALES, 2);
}

TEST(the_deadline_is_two_seconds_by_default_and_holds_across_the_wrap_of_the_clock)
{
    static const uint32_t starts_us[] = {0, UINT32_MAX - 1000000};
    config.stale_us = 0;
    for (unsigned i = 0; i != 2; i++) {
        assert_int_equal(fathom_stream_init(&stream, &config, starts_us[i]), FATHOM_OK);
        expect(starts_us[i] + 1999999, FATHOM_PENDING);
        expect(starts_us[i] + 2000000, FATHOM_ERR_STALE);
    }
}

TEST(due_is_the_deadline_or_when_a_silence_ends_the_frame_or_at_once)
{
    begin_with(4, 1000, 0);
    expect_due(1000, 2000000);
    expect_due(501000, 1500000);
    expect_due(3001000, 0);
    feed_first(1000);
    expect_due(1000, 5000);
    expect_due(5999, 1);
    expect_due(6000, 0);
    expect_due(9000, 0);
    feed_start(2000);
    expect_due(2000, 0);
    expect(2000, FATHOM_OK);
    expect_due(2000, 2000000);
    feed(mm_1953 + 1, 3, false, 1999000); /* the deadline, at 2002000, is nearer than 2004000 */
    expect_due(1999000, 3000);
}

TEST(counters_stop_at_their_end)
{
    stream.counters[FATHOM_STREAM_BYTES] = 65533;
    stream.counters[FATHOM_STREAM_FRAMES] = 65535;
    feed_first(10);
    expect_counted(FATHOM_STREAM_BYTES, 65535);
    expect(5010, FATHOM_OK);
    expect_counted(FATHOM_STREAM_FRAMES, 65535);
}

/* 300 bytes without an FF: the counters of bytes stop at 255 and do not come round to a wrong 4. */
TEST(a_long_run_of_noise_does_not_come_round_to_a_frame)
{
    static const uint8_t noise[250];
    feed(noise, 250, true, 10);
    for (int i = 0; i != 10; i++) feed(noise, 1, false, 10);
    for (uint8_t more = 0; more != 12; more++) {
        feed(noise, 1, false, 10);
        feed_frame(20);
        expect(5020, FATHOM_PENDING);
    }
}

/* ---- bytes that were lost ---- */

TEST(no_frame_is_built_across_a_lost_byte)
{
    for (uint8_t cut = 1; cut != 4; cut++) {
        begin(4);
        feed(mm_1953, cut, true, 10);
        feed_loss(20);
        feed(mm_1953 + cut, (uint8_t)(4 - cut), false, 20);
        expect(5020, FATHOM_PENDING); /* nor does a silence behind it help */
        feed(mm_1953, 1, true, 5030);
        expect(5030, FATHOM_PENDING);
        expect_counted(FATHOM_STREAM_FRAMES, 0);
    }
}

/* The first after the loss is in step with nothing, the second with the first. */
TEST(after_a_loss_two_frames_in_step_or_a_silence_are_needed_again)
{
    feed_first(10);
    expect(5010, FATHOM_OK);
    feed_loss(6020);
    feed_frame(6020);
    feed_start(6025);
    expect(6025, FATHOM_PENDING);
    feed(mm_1953 + 1, 3, false, 6030);
    feed_start(6035);
    expect(6035, FATHOM_OK);
    feed_loss(6040);
    feed_first(6050);
    expect(11050, FATHOM_OK);
}

/* ---- what comes behind a frame decides whether it was one: FF, or a silence of gap_us ---- */

/*
 * "it follows right upon another valid frame and no other alignment of the bytes of both was valid"; AMBIGUOUS: "in a
 * place where another alignment was right too"; UNSURE: "with neither a silence nor an unambiguous frame before them".
 *
 *   FF 01 FF FF FF 01 FF FF FF 07 A1 A7 FF 07 A1 A7
 *   -----------                                      UNSURE: nothing is before it
 *            -----------                             AMBIGUOUS
 *               -----------                          AMBIGUOUS
 *                           -----------              UNSURE: it follows, but upon an ambiguous one
 *                                       -----------  a frame
 */
TEST(a_frame_right_upon_an_ambiguous_one_is_unsure)
{
    feed_hex("FF 01 FF FF FF 01 FF FF", false, 1000);
    expect_counted(FATHOM_STREAM_UNSURE, 1);
    expect_counted(FATHOM_STREAM_AMBIGUOUS, 2);
    feed_frame(1100);
    expect_counted(FATHOM_STREAM_UNSURE, 2);
    expect_counted(FATHOM_STREAM_AMBIGUOUS, 2);
    expect(10000, FATHOM_PENDING);
    feed_frame(10100);
    expect_frame(20000, mm_1953, 10100);
    expect_counted(FATHOM_STREAM_FRAMES, 1);
}

/* The frame ended before the deadline and was not polled since: it is returned before the error. */
TEST(a_frame_whose_silence_has_passed_comes_before_the_deadline)
{
    feed_frame(10);
    feed_frame(20);
    expect_frame(2400000, mm_1953, 20);
    feed(mm_1953, 2, true, 600000000);
    expect(600000000, FATHOM_ERR_CHECKSUM); /* each frame once */
}
