/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/stream.h"

/* What comes behind a frame decides whether it was one: FF or a silence of gap_us, here 5 ms. */

enum { GAP_US = 5000 };

static const uint8_t mm_1953[] = {0xFF, 0x07, 0xA1, 0xA7}; /* A16 2(4) */

static fathom_stream_t stream;
static fathom_stream_config_t config;
static uint8_t storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_MAX_LENGTH)];
static const uint8_t *frame;

static void begin(uint8_t length, uint32_t now_us)
{
    config = (fathom_stream_config_t){.storage = storage, .length = length};
    memset(&stream, 0xA5, sizeof stream);
    memset(storage, 0xFF, sizeof storage);
    assert_int_equal(fathom_stream_init(&stream, &config, now_us), FATHOM_READY);
}

static fathom_status_t poll(uint32_t now_us) { return fathom_stream_poll(&stream, now_us, &frame); }

static void feed(const uint8_t *bytes, uint8_t count, bool after_gap, uint32_t time_us)
{
    fathom_stream_feed(&stream, bytes, count, after_gap, time_us);
}

/* 4321 mm is FF 10 E1 F0 (FF + 10 + E1 = 1F0). Behind a silence its third byte is lost, and the next frame follows
 * without a pause: FF 10 F0 | FF ... FF + 10 + F0 = 1FF, so that the next one's FF is a right sum, of 4336 mm (10F0),
 * which the sensor has not said. */
TEST(a_byte_lost_behind_a_silence_is_not_made_up_for_by_the_next_frame)
{
    static const uint8_t bytes[] = {0xFF, 0x10, 0xF0, 0xFF, 0x10, 0xE1, 0xF0};
    begin(4, 0);
    feed(bytes, sizeof bytes, true, 1000);
    assert_int_equal(poll(1000), FATHOM_PENDING);
    assert_int_equal(poll(1000 + GAP_US), FATHOM_PENDING);
    assert_int_equal(stream.counters[FATHOM_STREAM_FRAMES], 0);
    assert_int_equal(stream.counters[FATHOM_STREAM_UNSURE], 1);
}

/* FF + 07 + 9B = 1A1: with 9B too many before the A1, the A1 is a right sum, and the A7 behind it begins nothing. */
TEST(a_byte_too_many_does_not_make_the_last_value_a_sum)
{
    static const uint8_t bytes[] = {0xFF, 0x07, 0x9B, 0xA1, 0xA7};
    begin(4, 0);
    feed(bytes, sizeof bytes, true, 10);
    assert_int_equal(poll(10 + GAP_US), FATHOM_PENDING);
    assert_int_equal(stream.counters[FATHOM_STREAM_UNSURE], 1);
}

/* Every byte behind a frame that is first after a silence: FF alone begins another one. */
TEST(of_all_bytes_behind_a_frame_only_FF_lets_it_pass)
{
    for (unsigned next = 0; next != 256; next++) {
        const uint8_t byte = (uint8_t)next;
        begin(4, 0);
        feed(mm_1953, 4, true, 10);
        feed(&byte, 1, false, 20);
        assert_int_equal(poll(20), next == 0xFF ? FATHOM_READY : FATHOM_PENDING);
        assert_int_equal(poll(20 + GAP_US), FATHOM_PENDING);
        assert_int_equal(stream.counters[FATHOM_STREAM_UNSURE], next != 0xFF);
        if (next == 0xFF) assert_int_equal(stream.time_us, 10);
    }
}

TEST(a_silence_lets_it_pass_when_it_has_lasted_from_its_last_byte_on)
{
    begin(4, 0);
    config.gap_us = 25000;
    assert_int_equal(fathom_stream_init(&stream, &config, 0), FATHOM_READY);
    feed(mm_1953, 3, true, 10);
    feed(mm_1953 + 3, 1, false, 1000);
    assert_int_equal(poll(25999), FATHOM_PENDING);
    assert_int_equal(poll(26000), FATHOM_READY);
    assert_int_equal(stream.time_us, 1000);
}

/* Pauses of 20 ms with gap_us 25 ms: after the first, no gap is seen and no poll comes late enough. */
TEST(where_gap_us_is_longer_than_the_pauses_the_next_frame_decides)
{
    unsigned readings = 0;
    begin(4, 0);
    config.gap_us = 25000;
    assert_int_equal(fathom_stream_init(&stream, &config, 0), FATHOM_READY);
    for (uint32_t now_us = 0; now_us != 200000; now_us += 20000) {
        feed(mm_1953, 4, now_us == 0, now_us);
        const bool is_ready = poll(now_us) == FATHOM_READY;
        readings += is_ready;
        if (is_ready) assert_int_equal(stream.time_us, now_us - 20000);
        assert_int_equal(poll(now_us + 19999), FATHOM_PENDING);
    }
    assert_int_equal(readings, 9); /* of ten, all but the last */
    assert_int_equal(poll(180000 + 25000), FATHOM_READY);
}

TEST(the_silence_is_measured_across_the_wrap_of_the_clock)
{
    const uint32_t came_us = UINT32_MAX - 1999; /* 2000 us before the wrap */
    begin(4, came_us - 100);
    feed(mm_1953, 4, true, came_us);
    assert_int_equal(fathom_stream_due_us(&stream, came_us), GAP_US);
    assert_int_equal(poll(2999), FATHOM_PENDING);
    assert_int_equal(fathom_stream_due_us(&stream, 2999), 1);
    assert_int_equal(poll(3000), FATHOM_READY);
    assert_int_equal(stream.time_us, came_us);
}

/* Due at the end of the silence, and what is due then is the frame. */
TEST(who_sleeps_as_long_as_it_may_has_the_frame_when_it_wakes)
{
    begin(4, 0);
    feed(mm_1953, 4, true, 1000);
    assert_int_equal(poll(2500), FATHOM_PENDING);
    const uint32_t wake_us = 2500 + fathom_stream_due_us(&stream, 2500);
    assert_int_equal(wake_us, 1000 + GAP_US);
    assert_int_equal(poll(wake_us), FATHOM_READY);
    assert_int_equal(fathom_stream_due_us(&stream, wake_us), 2000000);
}

/* A deadline that passes while the silence lasts says STALE, and the frame is no older for that. */
TEST(a_frame_that_waits_when_the_deadline_passes_is_still_shown)
{
    begin(4, 0);
    feed(mm_1953, 4, true, 1998000);
    assert_int_equal(fathom_stream_due_us(&stream, 1998000), 2000);
    assert_int_equal(poll(2000000), FATHOM_ERR_STALE);
    assert_int_equal(poll(2002999), FATHOM_PENDING);
    assert_int_equal(poll(2003000), FATHOM_READY);
    assert_int_equal(stream.time_us, 1998000);
}

/* The frame ended long ago, and nobody has polled since: it is shown before the deadline is told. */
TEST(a_frame_whose_silence_has_passed_comes_before_the_deadline)
{
    begin(4, 0);
    feed(mm_1953, 4, false, 10);
    feed(mm_1953, 4, false, 20);
    assert_int_equal(poll(60000000), FATHOM_READY);
    assert_int_equal(stream.time_us, 20);
    feed(mm_1953, 2, true, 600000000);
    assert_int_equal(poll(600000000), FATHOM_ERR_STALE); /* each frame once */
}
