/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/engine/stream.h"

/* stream.h: what ends a frame, and how one that is not believed is counted. */

static const uint8_t mm_1953[] = {0xFF, 0x07, 0xA1, 0xA7}; /* A16 2(4) */

static uint8_t storage[FATHOM_STREAM_STORAGE(4)];
static const fathom_stream_config_t config = {.storage = storage, .length = 4};
static fathom_stream_t stream;

static int set_up(void **state)
{
    memset(&stream, 0xA5, sizeof stream);
    assert_int_equal(fathom_stream_init(&stream, &config, 0), FATHOM_OK);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static void feed(const uint8_t *bytes, uint8_t count, bool after_gap, uint32_t time_us)
{
    fathom_stream_feed(&stream, bytes, count, after_gap, time_us);
}

static void assert_1953(uint32_t now_us, uint32_t time_us)
{
    assert_int_equal(fathom_stream_poll(&stream, now_us), FATHOM_OK);
    assert_memory_equal(fathom_stream_frame(&stream), mm_1953, 4);
    assert_int_equal(stream.time_us, time_us);
}

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
    static const uint8_t bytes[] = {0xFF, 0x01, 0xFF, 0xFF, 0xFF, 0x01, 0xFF, 0xFF,
                                    0xFF, 0x07, 0xA1, 0xA7, 0xFF, 0x07, 0xA1, 0xA7};
    feed(bytes, 8, false, 1000);
    assert_int_equal(stream.counters[FATHOM_STREAM_UNSURE], 1);
    assert_int_equal(stream.counters[FATHOM_STREAM_AMBIGUOUS], 2);
    feed(bytes + 8, 4, false, 1100);
    assert_int_equal(stream.counters[FATHOM_STREAM_UNSURE], 2);
    assert_int_equal(stream.counters[FATHOM_STREAM_AMBIGUOUS], 2);
    assert_int_equal(fathom_stream_poll(&stream, 10000), FATHOM_PENDING);
    feed(bytes + 12, 4, false, 10100);
    assert_1953(20000, 10100);
    assert_int_equal(stream.counters[FATHOM_STREAM_FRAMES], 1);
}

/* MISSED: "good ones that a newer one replaced before it was polled". */
TEST(a_frame_is_missed_only_where_the_one_before_was_not_polled)
{
    feed(mm_1953, 4, true, 1500);
    assert_1953(9000, 1500);
    feed(mm_1953, 4, true, 11500);
    assert_1953(19000, 11500);
    assert_int_equal(stream.counters[FATHOM_STREAM_MISSED], 0);
    feed(mm_1953, 4, true, 21500);
    feed(mm_1953, 4, true, 31500);
    assert_1953(39000, 31500);
    assert_int_equal(stream.counters[FATHOM_STREAM_MISSED], 1);
}
