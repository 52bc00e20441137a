/* SPDX-License-Identifier: MIT */
/* The sketch a05_auto, which hears an A05 by SoftwareSerial, bit by bit on pin 10 (PB2), and prints. */
#include <stdio.h>
#include <string.h>

#include "suite.h"

#include "printed.h"

enum { BIT_CYCLES = BOARD_HZ / 9600, CHARACTER_BITS = 10 };

/* A05 1(3): 1000, 2000, 1953, 3562 mm. */
static const uint8_t frame[] = {0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x60};

typedef struct {
    board_t board;
    printed_t printed;
    uint8_t bytes[sizeof frame];
    unsigned bit; /* of all of them */
} bench_t;

static avr_cycle_count_t next_bit(avr_t *avr, avr_cycle_count_t when, void *param)
{
    (void)avr;
    bench_t *const bench = (bench_t *)param;
    if (bench->bit == sizeof frame * CHARACTER_BITS) return 0;
    const unsigned at = bench->bit % CHARACTER_BITS;
    const uint8_t byte = bench->bytes[bench->bit / CHARACTER_BITS];
    bench->bit++;
    board_drive(&bench->board, 'B', 2, at == 9 || (at != 0 && (byte >> (at - 1) & 1) != 0));
    return when + BIT_CYCLES;
}

/* One frame, its bytes without a gap, with one byte changed; then the pause until the next one. */
static void send(bench_t *bench, size_t changed, uint8_t by)
{
    memcpy(bench->bytes, frame, sizeof frame);
    bench->bytes[changed] ^= by;
    bench->bit = 0;
    avr_cycle_timer_register(bench->board.avr, BIT_CYCLES, next_bit, bench);
}

static void begin(bench_t *bench, const char *image)
{
    memset(bench, 0, sizeof *bench);
    assert_true(board_start(&bench->board, image));
    board_drive(&bench->board, 'B', 2, true);
    printed_begin(&bench->printed, &bench->board);
    assert_true(board_run_us(&bench->board, 50000));
}

static void expect_line(bench_t *bench, const char *expected)
{
    const char *const text = printed_line(&bench->printed, 150000);
    if (text == NULL) fail_msg("nothing was printed for %s", expected);
    assert_string_equal(text, expected);
}

static void expect_frames(const char *image)
{
    bench_t bench;
    begin(&bench, image);
    for (int n = 0; n < 20; n++) {
        send(&bench, 0, 0);
        expect_line(&bench, "1: 1000");
        expect_line(&bench, "2: 2000");
        expect_line(&bench, "3: 1953");
        expect_line(&bench, "4: 3562");
        board_run_us(&bench.board, 70001); /* another phase of Timer0 each time */
    }
    board_end(&bench.board);
}

TEST(four_distances_are_printed_a_frame) { expect_frames("a05_auto"); }

TEST(four_distances_are_printed_a_frame_in_a_loop_of_20_ms) { expect_frames("a05_slow"); }

TEST(a_damaged_frame_is_not_printed)
{
    bench_t bench;
    begin(&bench, "a05_auto");
    for (size_t i = 0; i < sizeof frame; i++) {
        send(&bench, i, 0x10);
        assert_null(printed_line(&bench.printed, 100000));
    }
    send(&bench, 0, 0);
    expect_line(&bench, "1: 1000");
    board_end(&bench.board);
}

TEST(silence_is_stale_after_two_seconds)
{
    bench_t bench;
    begin(&bench, "a05_auto");
    send(&bench, 0, 0);
    for (int n = 0; n < 4; n++) assert_non_null(printed_line(&bench.printed, 100000));
    assert_null(printed_line(&bench.printed, 1900000));
    const char *const text = printed_line(&bench.printed, 200000);
    assert_non_null(text);
    assert_string_equal(text, "error -7"); /* FATHOM_ERR_STALE */
    board_end(&bench.board);
}
