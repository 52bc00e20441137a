/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/stream.h"

static const uint8_t mm_1953[] = {0xFF, 0x07, 0xA1, 0xA7};                                  /* A16 2(4) */
static const uint8_t four[] = {0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x60}; /* A05 1(3) */
static const uint8_t mm_511[] = {0xFF, 0x01, 0xFF, 0xFF}; /* FF + 01 + FF = 1FF; as FF FF 01 FF 65281 mm */
static const uint8_t permutable[] = {0xFF, 0x03, 0xE8, 0x07, 0xD0,
                                     0x07, 0xFF, 0x05, 0x3B, 0x07}; /* 407 hex */

static fathom_stream_t stream;
static fathom_stream_config_t config;
static uint8_t storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_MAX_LENGTH)];
static const uint8_t *frame;

static void begin(uint8_t length, uint32_t now_us)
{
    config = (fathom_stream_config_t){.storage = storage, .length = length};
    memset(&stream, 0xA5, sizeof stream);
    memset(storage, 0xFF, sizeof storage);
    frame = NULL;
    assert_int_equal(fathom_stream_init(&stream, &config, now_us), FATHOM_READY);
}

static fathom_status_t poll(uint32_t now_us) { return fathom_stream_poll(&stream, now_us, &frame); }

static void feed(const uint8_t *bytes, uint8_t count, bool after_gap, uint32_t time_us)
{
    fathom_stream_feed(&stream, bytes, count, after_gap, time_us);
}

TEST(a_config_without_storage_or_with_another_length_is_refused)
{
    config = (fathom_stream_config_t){.storage = NULL, .length = 4};
    assert_int_equal(fathom_stream_init(&stream, &config, 0), FATHOM_ERR_ARGUMENT);
    config = (fathom_stream_config_t){.storage = storage, .length = 5};
    assert_int_equal(fathom_stream_init(&stream, &config, 0), FATHOM_ERR_ARGUMENT);
    config.length = 10;
    assert_int_equal(fathom_stream_init(&stream, &config, 0), FATHOM_READY);
    assert_int_equal(stream.listener.gap_us, 5000);
    config.gap_us = 25000;
    assert_int_equal(fathom_stream_init(&stream, &config, 0), FATHOM_READY);
    assert_int_equal(stream.listener.gap_us, 25000);
}

TEST(the_first_frame_after_a_gap_is_believed_when_a_gap_follows_it)
{
    begin(4, 1000);
    feed(mm_1953, 4, true, 1500);
    assert_int_equal(poll(6499), FATHOM_PENDING);
    assert_int_equal(poll(6500), FATHOM_READY);
    assert_memory_equal(frame, mm_1953, 4);
    assert_int_equal(stream.time_us, 1500);
    assert_int_equal(poll(6600), FATHOM_PENDING); /* each frame once */

    begin(10, 1000);
    feed(four, 10, true, 1500);
    assert_int_equal(poll(6500), FATHOM_READY);
    assert_memory_equal(frame, four, 10);
}

TEST(a_frame_may_come_in_any_two_pieces)
{
    for (uint8_t cut = 1; cut != 10; cut++) {
        begin(10, 0);
        feed(four, cut, true, 10);
        assert_int_equal(poll(15), FATHOM_PENDING);
        feed(four + cut, (uint8_t)(10 - cut), false, 20);
        assert_int_equal(poll(5020), FATHOM_READY);
        assert_memory_equal(frame, four, 10);
        assert_int_equal(stream.time_us, 20);
    }
}

TEST(without_a_gap_the_second_of_two_frames_in_step_is_believed_when_a_third_begins)
{
    begin(4, 0);
    feed(mm_1953, 4, false, 10);
    assert_int_equal(poll(10), FATHOM_PENDING);
    assert_int_equal(stream.counters[FATHOM_STREAM_UNSURE], 1);
    feed(mm_1953, 4, false, 20);
    assert_int_equal(poll(20), FATHOM_PENDING);
    feed(mm_1953, 1, false, 30);
    assert_int_equal(poll(30), FATHOM_READY);
    assert_memory_equal(frame, mm_1953, 4);
    assert_int_equal(stream.time_us, 20); /* when it came, not when it was believed */
    assert_int_equal(stream.counters[FATHOM_STREAM_FRAMES], 1);
}

TEST(a_silence_ends_a_frame_as_well_as_the_next_one_does)
{
    begin(4, 0);
    feed(mm_1953, 4, false, 10);
    feed(mm_1953, 4, false, 20);
    feed(mm_1953, 2, true, 30);
    assert_int_equal(poll(30), FATHOM_READY);
    assert_int_equal(stream.time_us, 20);
}

/* A byte of FF 80 xx 80 is lost, and what is left makes a right sum with the FF of the next frame: FF + 80 + 80 =
 * 1FF. What follows it, 07, begins nothing. */
TEST(a_right_sum_that_no_frame_follows_is_not_believed)
{
    static const uint8_t lost_a_byte[] = {0xFF, 0x80, 0x80};
    begin(4, 0);
    feed(mm_1953, 4, true, 10);
    feed(lost_a_byte, 3, false, 20);
    assert_int_equal(poll(20), FATHOM_READY);
    feed(mm_1953, 4, false, 30);
    assert_int_equal(poll(30), FATHOM_PENDING);
    assert_true(stream.counters[FATHOM_STREAM_UNSURE] + stream.counters[FATHOM_STREAM_AMBIGUOUS] >= 1);
    assert_int_equal(stream.counters[FATHOM_STREAM_FRAMES], 1);
}

TEST(frames_that_follow_without_a_pause_are_believed_while_they_stay_in_step)
{
    begin(4, 0);
    feed(mm_1953, 4, true, 10);
    assert_int_equal(poll(10), FATHOM_PENDING);
    feed(mm_1953, 4, false, 20);
    assert_int_equal(poll(20), FATHOM_READY);
    assert_int_equal(stream.time_us, 10);
    feed(mm_1953, 1, false, 25); /* the rest of this frame is lost */
    assert_int_equal(poll(25), FATHOM_READY);
    feed(mm_1953, 4, false, 30);
    assert_int_equal(poll(30), FATHOM_PENDING); /* in step with nothing */
    feed(mm_1953, 4, false, 40);
    feed(mm_1953, 1, false, 50);
    assert_int_equal(poll(50), FATHOM_READY);
    assert_int_equal(stream.time_us, 40);
}

TEST(a_value_that_is_valid_in_two_alignments_is_never_shown_without_a_gap)
{
    begin(4, 0);
    for (int i = 0; i != 100; i++) feed(mm_511, 4, false, 10);
    assert_int_equal(poll(20), FATHOM_PENDING);
    assert_int_equal(stream.counters[FATHOM_STREAM_FRAMES], 0);
    /* 100 right windows and 99 across two frames; only the very first has no other before it. */
    assert_int_equal(stream.counters[FATHOM_STREAM_AMBIGUOUS], 198);

    begin(10, 0);
    for (int i = 0; i != 100; i++) feed(permutable, 10, false, 10);
    assert_int_equal(poll(20), FATHOM_PENDING);
    assert_int_equal(stream.counters[FATHOM_STREAM_FRAMES], 0);
}

TEST(the_same_value_is_shown_rightly_where_gaps_are_seen)
{
    begin(4, 0);
    feed(mm_511 + 2, 2, false, 5); /* the end of a frame that had begun before */
    for (int i = 0; i != 100; i++) {
        feed(mm_511, 4, true, 10);
        assert_int_equal(poll(5010), FATHOM_READY);
        assert_memory_equal(frame, mm_511, 4);
    }
    begin(10, 0);
    for (int i = 0; i != 100; i++) {
        feed(permutable, 10, true, 10);
        assert_int_equal(poll(5010), FATHOM_READY);
        assert_memory_equal(frame, permutable, 10);
    }
}

TEST(a_frame_that_broke_off_before_a_gap_leaves_no_trace)
{
    for (uint8_t length = 1; length != 4; length++) {
        begin(4, 0);
        feed(mm_511, length, true, 10);
        feed(mm_1953, 4, true, 20);
        assert_int_equal(poll(5020), FATHOM_READY);
        assert_memory_equal(frame, mm_1953, 4);
        assert_int_equal(stream.counters[FATHOM_STREAM_FRAMES], 1);
    }
}

TEST(a_wrong_sum_is_dropped)
{
    uint8_t damaged[4];
    memcpy(damaged, mm_1953, 4);
    damaged[2] ^= 1;
    begin(4, 0);
    feed(damaged, 4, true, 10);
    assert_int_equal(poll(5010), FATHOM_PENDING);
    assert_int_equal(stream.counters[FATHOM_STREAM_BYTES], 4);
    assert_int_equal(stream.counters[FATHOM_STREAM_FRAMES], 0);
}

TEST(the_newest_frame_wins_and_the_older_is_counted)
{
    static const uint8_t mm_1000[] = {0xFF, 0x03, 0xE8, 0xEA}; /* FF + 03 + E8 = 1EA */
    begin(4, 0);
    feed(mm_1953, 4, true, 10);
    feed(mm_1000, 4, true, 20);
    assert_int_equal(poll(5020), FATHOM_READY);
    assert_memory_equal(frame, mm_1000, 4);
    assert_int_equal(stream.time_us, 20);
    assert_int_equal(stream.counters[FATHOM_STREAM_MISSED], 1);
    assert_int_equal(poll(5040), FATHOM_PENDING);
}

TEST(a_silent_stream_is_stale_once_every_deadline)
{
    begin(4, 1000);
    config.stale_us = 500000;
    fathom_stream_init(&stream, &config, 1000);
    assert_int_equal(poll(500999), FATHOM_PENDING);
    assert_int_equal(poll(501000), FATHOM_ERR_STALE);
    assert_int_equal(poll(501001), FATHOM_PENDING);
    assert_int_equal(poll(1000999), FATHOM_PENDING);
    assert_int_equal(poll(1001000), FATHOM_ERR_STALE);
    assert_int_equal(stream.counters[FATHOM_STREAM_STALES], 2);
}

TEST(the_deadline_is_two_seconds_unless_told_otherwise)
{
    begin(4, 0);
    assert_int_equal(poll(1999999), FATHOM_PENDING);
    assert_int_equal(poll(2000000), FATHOM_ERR_STALE);
}

TEST(only_a_good_frame_moves_the_deadline)
{
    begin(4, 0);
    for (uint32_t now_us = 0; now_us != 1900000; now_us += 100000) {
        feed(mm_1953, 3, true, now_us);
        assert_int_equal(poll(now_us), FATHOM_PENDING);
    }
    assert_int_equal(poll(2000000), FATHOM_ERR_STALE);
    feed(mm_1953, 4, true, 2995000);
    assert_int_equal(poll(3000000), FATHOM_READY);
    assert_int_equal(poll(4999999), FATHOM_PENDING);
    assert_int_equal(poll(5000000), FATHOM_ERR_STALE);
}

TEST(a_frame_in_hand_comes_before_the_deadline)
{
    begin(4, 0);
    feed(mm_1953, 4, true, 10);
    assert_int_equal(poll(60000000), FATHOM_READY);
}

TEST(the_deadline_holds_across_the_wrap_of_the_clock)
{
    const uint32_t start_us = UINT32_MAX - 1000000;
    begin(4, start_us);
    assert_int_equal(poll(start_us + 1999999), FATHOM_PENDING);
    assert_int_equal(poll(start_us + 2000000), FATHOM_ERR_STALE);
}

TEST(due_is_the_deadline_or_when_a_silence_ends_the_frame_or_at_once)
{
    begin(4, 1000);
    assert_int_equal(fathom_stream_due_us(&stream, 1000), 2000000);
    assert_int_equal(fathom_stream_due_us(&stream, 501000), 1500000);
    assert_int_equal(fathom_stream_due_us(&stream, 3001000), 0);
    feed(mm_1953, 4, true, 1000);
    assert_int_equal(fathom_stream_due_us(&stream, 1000), 5000);
    assert_int_equal(fathom_stream_due_us(&stream, 5999), 1);
    assert_int_equal(fathom_stream_due_us(&stream, 6000), 0);
    assert_int_equal(fathom_stream_due_us(&stream, 9000), 0);
    feed(mm_1953, 1, false, 2000);
    assert_int_equal(fathom_stream_due_us(&stream, 2000), 0);
    assert_int_equal(poll(2000), FATHOM_READY);
    assert_int_equal(fathom_stream_due_us(&stream, 2000), 2000000);
    feed(mm_1953 + 1, 3, false, 1999000); /* the deadline, at 2002000, is nearer than 2004000 */
    assert_int_equal(fathom_stream_due_us(&stream, 1999000), 3000);
}

TEST(counters_stop_at_their_end)
{
    begin(4, 0);
    stream.counters[FATHOM_STREAM_BYTES] = 65533;
    stream.counters[FATHOM_STREAM_FRAMES] = 65535;
    feed(mm_1953, 4, true, 10);
    assert_int_equal(stream.counters[FATHOM_STREAM_BYTES], 65535);
    assert_int_equal(poll(5010), FATHOM_READY);
    assert_int_equal(stream.counters[FATHOM_STREAM_FRAMES], 65535);
}

/* 300 bytes without an FF: the counters of bytes stop at 255 and do not come round to a wrong 4. */
TEST(a_long_run_of_noise_does_not_come_round_to_a_frame)
{
    static const uint8_t noise[250];
    begin(4, 0);
    feed(noise, 250, true, 10);
    for (int i = 0; i != 10; i++) feed(noise, 1, false, 10);
    for (uint8_t more = 0; more != 12; more++) {
        feed(noise, 1, false, 10);
        feed(mm_1953, 4, false, 20);
        assert_int_equal(poll(5020), FATHOM_PENDING);
    }
}

/* ---- bytes that were lost ---- */

TEST(no_frame_is_built_across_a_lost_byte)
{
    for (uint8_t cut = 1; cut != 4; cut++) {
        begin(4, 0);
        feed(mm_1953, cut, true, 10);
        feed(NULL, 0, false, 20);
        feed(mm_1953 + cut, (uint8_t)(4 - cut), false, 20);
        assert_int_equal(poll(5020), FATHOM_PENDING); /* nor does a silence behind it help */
        feed(mm_1953, 1, true, 5030);
        assert_int_equal(poll(5030), FATHOM_PENDING);
        assert_int_equal(stream.counters[FATHOM_STREAM_FRAMES], 0);
    }
}

TEST(a_frame_that_waits_for_its_successor_is_dropped_when_bytes_are_lost)
{
    begin(4, 0);
    feed(mm_1953, 4, false, 10);
    feed(mm_1953, 4, false, 20); /* believed if FF follows, but what follows is not known */
    feed(NULL, 0, false, 30);
    assert_int_equal(poll(5030), FATHOM_PENDING);
    feed(mm_1953, 1, false, 5030);
    assert_int_equal(poll(5030), FATHOM_PENDING);
    assert_int_equal(stream.counters[FATHOM_STREAM_FRAMES], 0);
    begin(4, 0);
    feed(mm_1953, 4, true, 10); /* the same behind a silence */
    feed(NULL, 0, false, 20);
    assert_int_equal(poll(5020), FATHOM_PENDING);
}

/* The first after the loss is in step with nothing, the second with the first. */
TEST(after_a_loss_two_frames_in_step_or_a_silence_are_needed_again)
{
    begin(4, 0);
    feed(mm_1953, 4, true, 10);
    assert_int_equal(poll(5010), FATHOM_READY);
    feed(NULL, 0, false, 6020);
    feed(mm_1953, 4, false, 6020);
    feed(mm_1953, 1, false, 6025);
    assert_int_equal(poll(6025), FATHOM_PENDING);
    feed(mm_1953 + 1, 3, false, 6030);
    feed(mm_1953, 1, false, 6035);
    assert_int_equal(poll(6035), FATHOM_READY);
    feed(NULL, 0, false, 6040);
    feed(mm_1953, 4, true, 6050);
    assert_int_equal(poll(11050), FATHOM_READY);
}

/* 511 mm held still, FF 01 FF FF: without the two bytes FF 01 it reads FF FF FF 01, FF FF 01 FF. */
TEST(a_loss_in_a_value_that_is_valid_twice_shows_no_wrong_value)
{
    for (uint8_t lost = 0; lost != 4; lost++) {
        begin(4, 0);
        feed(mm_511, 4, true, 0);
        assert_int_equal(poll(5000), FATHOM_READY);
        feed(NULL, 0, false, 10);
        feed(mm_511 + lost, (uint8_t)(4 - lost), false, 10);
        for (uint32_t i = 0; i != 20; i++) {
            feed(mm_511, 4, false, 20 + i);
            if (poll(20 + i) == FATHOM_READY) assert_memory_equal(frame, mm_511, 4);
        }
    }
}
