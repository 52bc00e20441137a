/* SPDX-License-Identifier: MIT */
/* The sketches that receive by SoftwareSerial and print. */
#include <stddef.h>

#include "suite.h"

#include "board.h"

/* A sensor that sends to the SoftwareSerial of the sketches, bit by bit, 8N1: to pin 10 (PB2) at 9600 baud. */
enum { SOFT_BIT_CYCLES = BOARD_HZ / 9600, SOFT_CHARACTER_BITS = 10 };

static struct {
    uint8_t bytes[16];
    size_t length;
    unsigned bit; /* of all of them */
} soft_sent;

static avr_cycle_count_t soft_next_bit(avr_t *avr, avr_cycle_count_t when, void *param)
{
    if (soft_sent.bit == soft_sent.length * SOFT_CHARACTER_BITS) return 0;
    const unsigned at = soft_sent.bit % SOFT_CHARACTER_BITS;
    const uint8_t byte = soft_sent.bytes[soft_sent.bit++ / SOFT_CHARACTER_BITS];
    board_drive('B', 2, at == 9 || (at != 0 && (byte >> (at - 1) & 1) != 0));
    return when + SOFT_BIT_CYCLES;
}

/* Sends bytes without a gap, `in_us` from now. */
static void soft_send(const uint8_t *bytes, size_t length, uint32_t in_us)
{
    assert_true(length <= sizeof soft_sent.bytes);
    memcpy(soft_sent.bytes, bytes, length);
    soft_sent.length = length;
    soft_sent.bit = 0;
    avr_cycle_timer_register(board.avr, in_us * BOARD_CYCLES_PER_US + SOFT_BIT_CYCLES, soft_next_bit, NULL);
}

/* A05 1(3): 1000, 2000, 1953, 3562 mm. */
static const uint8_t frame[] = {0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x60};

/* A16 2(4), 3(4): 1953 mm. */
static const uint8_t mm_1953[] = {0xFF, 0x07, 0xA1, 0xA7};

static const suite_t suite = {.tear_down = board_stop};

/* One frame, with one byte changed; then the pause until the next one. */
static void send(size_t changed, uint8_t by)
{
    uint8_t bytes[sizeof frame];
    memcpy(bytes, frame, sizeof frame);
    bytes[changed] ^= by;
    soft_send(bytes, sizeof bytes, 0);
}

static void begin(const char *image)
{
    board_start(image);
    board_drive('B', 2, true);
    assert_true(board_run_us(50000));
}

static void expect_line(const char *expected) { assert_string_equal(board_line(150000), expected); }

static void expect_frames(const char *image)
{
    begin(image);
    for (int n = board_has_time() ? 20 : 8; n != 0; n--) {
        send(0, 0);
        expect_line("1: 1000");
        expect_line("2: 2000");
        expect_line("3: 1953");
        expect_line("4: 3562");
        board_run_us(70001); /* another phase of Timer0 each time */
    }
}

TEST(four_distances_are_printed_a_frame) { expect_frames("a05_auto"); }

TEST(four_distances_are_printed_a_frame_in_a_loop_of_20_ms) { expect_frames("a05_slow"); }

TEST(a_damaged_frame_is_not_printed)
{
    begin("a05_auto");
    for (size_t i = 0; i < sizeof frame; i++) {
        send(i, 0x10);
        assert_string_equal(board_line(100000), "");
    }
    send(0, 0);
    expect_line("1: 1000");
}

TEST(silence_is_stale_after_two_seconds)
{
    begin("a05_auto");
    send(0, 0);
    for (int n = 0; n < 4; n++) assert_string_not_equal(board_line(100000), "");
    assert_string_equal(board_line(1900000), "");
    assert_string_equal(board_line(200000), "0: STALE");
}

TEST(an_a16_is_printed_until_it_is_silent)
{
    begin("a16_auto");
    for (int n = 0; n != 5; n++) {
        soft_send(mm_1953, sizeof mm_1953, 0);
        expect_line("1953");
        board_run_us(70001);
    }
    soft_send((const uint8_t[]){0xFF, 0x07, 0xA1, 0xA6}, 4, 0); /* wrong sum */
    assert_string_equal(board_line(1500000), "");
    assert_string_equal(board_line(600000), "CHECKSUM");
    assert_string_equal(board_line(2100000), "STALE");
}

/* The manual of the A02YYUW has this frame. */
TEST(a_relative_is_printed_in_its_own_range)
{
    begin("a02yyuw");
    soft_send((const uint8_t[]){0xFF, 0x07, 0xA1, 0xA7}, 4, 0);
    expect_line("1953");
    soft_send((const uint8_t[]){0xFF, 0x00, 0x1D, 0x1C}, 4, 100000); /* 29 mm, one below its range */
    expect_line("MALFORMED");
}

static void on_trigger(void *ctx, bool high)
{
    unsigned *const triggers = ctx;
    if (high) return;
    ++*triggers;
    soft_send(mm_1953, sizeof mm_1953, 100000); /* A16 3(2): 90 to 110 ms after the edge */
}

TEST(an_a16_is_triggered_for_each_distance)
{
    unsigned triggers = 0;
    board_start("a16_controlled");
    board_drive('B', 2, true);
    board_watch('D', 7, true, on_trigger, &triggers);
    for (int n = 0; n != 8; n++) assert_string_equal(board_line(300000), "1953");
    assert_in_range(triggers, 8, 9);
}

/* ---- a trigger that is the byte 01 on TX, pin 11 (PB3): low, high, and low for seven bits ---- */

static struct {
    avr_cycle_count_t fell, begin;
    unsigned triggers;
} on_tx;

static void on_bit(void *ctx, bool high)
{
    const avr_cycle_count_t now = board.avr->cycle;
    if (!high) {
        on_tx.fell = now;
        if (now - on_tx.begin > 12 * SOFT_BIT_CYCLES) on_tx.begin = now;
    } else if (now - on_tx.begin > 8 * SOFT_BIT_CYCLES) {
        assert_in_range(now - on_tx.fell, 7 * SOFT_BIT_CYCLES - SOFT_BIT_CYCLES / 4,
                        7 * SOFT_BIT_CYCLES + SOFT_BIT_CYCLES / 4);
        on_tx.triggers++;
        soft_send(mm_1953, sizeof mm_1953, 50000);
    }
}

TEST(a_module_that_starts_by_a_byte_gets_it)
{
    memset(&on_tx, 0, sizeof on_tx);
    board_start("aj_byte");
    board_drive('B', 2, true);
    board_watch('B', 3, true, on_bit, NULL);
    for (int n = 0; n != 4; n++) assert_string_equal(board_line(300000), "1953");
    assert_in_range(on_tx.triggers, 4, 5);
}
