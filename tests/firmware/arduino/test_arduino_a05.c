/* SPDX-License-Identifier: MIT */
/* The sketch a05_auto, which hears an A05 by SoftwareSerial, bit by bit on pin 10 (PB2), and prints. */
#include "suite.h"

#include "board.h"

enum { BIT_CYCLES = BOARD_HZ / 9600, CHARACTER_BITS = 10 };

/* A05 1(3): 1000, 2000, 1953, 3562 mm. */
static const uint8_t frame[] = {0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x60};

static struct {
    uint8_t bytes[sizeof frame];
    unsigned bit; /* of all of them */
} sent;

static const suite_t suite = {.tear_down = board_stop};

static avr_cycle_count_t next_bit(avr_t *avr, avr_cycle_count_t when, void *param)
{
    if (sent.bit == sizeof frame * CHARACTER_BITS) return 0;
    const unsigned at = sent.bit % CHARACTER_BITS;
    const uint8_t byte = sent.bytes[sent.bit++ / CHARACTER_BITS];
    board_drive('B', 2, at == 9 || (at != 0 && (byte >> (at - 1) & 1) != 0));
    return when + BIT_CYCLES;
}

/* One frame, its bytes without a gap, with one byte changed; then the pause until the next one. */
static void send(size_t changed, uint8_t by)
{
    memcpy(sent.bytes, frame, sizeof frame);
    sent.bytes[changed] ^= by;
    sent.bit = 0;
    avr_cycle_timer_register(board.avr, BIT_CYCLES, next_bit, NULL);
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
    assert_string_equal(board_line(200000), "error -7"); /* FATHOM_ERR_STALE */
}
