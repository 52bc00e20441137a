/* SPDX-License-Identifier: MIT */
/* What port/avr receives: each byte once, in order, with what the USART says of it. */
#include "suite.h"

#include "fathom/hal.h"
#include "profile.h"
#include "remote.h"

enum { RING = 63 }; /* FATHOM_AVR_RX_RING, less one */

static const fathom_line_settings_t at_115200 = {115200, FATHOM_PARITY_NONE, 1};
static const fathom_line_settings_t at_19200 = {19200, FATHOM_PARITY_EVEN, 1};
/* What a far end at the nominal rate takes: 1388 cycles. */
enum { CHARACTER_115200 = 10 * 16000000 / 115200 };

static uint8_t pattern[1024];

static int start(void **state)
{
    for (size_t i = 0; i < sizeof pattern; i++) pattern[i] = (uint8_t)(i * 7 + i / 256);
    remote_start();
    assert_true(remote_begin(&at_115200, false, 8));
    return 0;
}

static const suite_t suite = {.set_up = start, .tear_down = board_stop};

typedef struct {
    uint16_t parity, framing, overruns;
} counters_t;

static void assert_counters(uint16_t parity, uint16_t framing, uint16_t overruns)
{
    counters_t now;
    memcpy(&now, board_data("fathom_avr_usart0_counters"), sizeof now); /* as avr-gcc lays it out */
    assert_int_equal(now.parity, parity);
    assert_int_equal(now.framing, framing);
    assert_int_equal(now.overruns, overruns);
}

/* Everything that waits, read `capacity` at a time; no errors. */
static uint16_t read_all(uint8_t *bytes, uint8_t capacity)
{
    uint16_t count = 0;
    for (;;) {
        uint8_t flags;
        const int more = remote_read(bytes + count, capacity, &flags);
        assert_true(more >= 0);
        assert_int_equal(flags, 0);
        if (more == 0) return count;
        count = (uint16_t)(count + more);
    }
}

/* One read of so many bytes at most: it gives those of the pattern, with these flags. */
static void assert_read(uint8_t capacity, uint8_t flags, const uint8_t *expected, int count)
{
    uint8_t got[64], got_flags;
    assert_int_equal(remote_read(got, capacity, &got_flags), count);
    assert_int_equal(got_flags, flags);
    assert_memory_equal(got, expected, (size_t)count);
}

TEST(a_frame_of_32_bytes_at_115200_comes_whole_with_no_gap_between_bytes)
{
    uint8_t bytes[64];
    board_feed(pattern, NULL, 32, board.avr->cycle, CHARACTER_115200);
    board_run_us(3000);
    assert_int_equal(read_all(bytes, 64), 32);
    assert_memory_equal(bytes, pattern, 32);
    assert_counters(0, 0, 0);
}

TEST(a_thousand_bytes_come_whole_while_they_are_read_in_pieces_of_any_size)
{
    static uint8_t bytes[1024 + 64];
    for (uint8_t capacity = 1; capacity <= 64; capacity = (uint8_t)(capacity * 2 + 1)) {
        uint16_t count = 0;
        board_feed(pattern, NULL, sizeof pattern, board.avr->cycle, CHARACTER_115200);
        while (count < sizeof pattern) {
            const uint64_t cycle = board.avr->cycle;
            uint8_t flags;
            const int more = remote_read(bytes + count, capacity, &flags);
            assert_true(more >= 0);
            assert_int_equal(flags, 0);
            count = (uint16_t)(count + more);
            assert_true(board.avr->cycle - cycle < 20000);
        }
        assert_int_equal(count, sizeof pattern);
        assert_memory_equal(bytes, pattern, sizeof pattern);
    }
    assert_counters(0, 0, 0);
}

TEST(errors_are_told_of_their_byte_and_counted)
{
    static const uint8_t bytes[] = {1, 2, 3, 4, 5, 6, 7};
    static const uint8_t marks[] = {
        0, 0, FATHOM_RX_PARITY, 0, FATHOM_RX_FRAMING | FATHOM_RX_PARITY, FATHOM_RX_OVERRUN, 0};
    static const struct {
        uint8_t count, first, flags;
    } reads[] = {
        {2, 1, 0},
        {1, 3, FATHOM_RX_PARITY},
        {1, 4, 0},
        {1, 5, FATHOM_RX_PARITY | FATHOM_RX_FRAMING},
        {1, 6, FATHOM_RX_OVERRUN},
        {1, 7, 0},
        {0, 0, 0},
    };
    assert_true(remote_begin(&at_19200, false, 8));
    board_feed(bytes, marks, sizeof bytes, board.avr->cycle, 0);
    board_run_us(10000);
    for (size_t i = 0; i < sizeof reads / sizeof reads[0]; i++) {
        const uint8_t *const expected = reads[i].count != 0 ? bytes + reads[i].first - 1 : bytes;
        assert_read(64, reads[i].flags, expected, reads[i].count);
    }
    assert_counters(2, 1, 1);
}

TEST(without_parity_no_byte_has_a_wrong_one)
{
    static const uint8_t byte = 9, mark = FATHOM_RX_PARITY;
    uint8_t bytes[4];
    board_feed(&byte, &mark, 1, board.avr->cycle, 0);
    board_run_us(1000);
    assert_int_equal(read_all(bytes, 4), 1);
    assert_counters(0, 0, 0);
}

TEST(counters_stop_at_their_end)
{
    const counters_t nearly = {65534, 65534, 65534};
    static const uint8_t bytes[3] = {1, 2, 3};
    static const uint8_t marks[3] = {28, 28, 28};
    assert_int_equal(28, FATHOM_RX_PARITY | FATHOM_RX_FRAMING | FATHOM_RX_OVERRUN);
    assert_true(remote_begin(&at_19200, false, 8));
    memcpy(board_data("fathom_avr_usart0_counters"), &nearly, sizeof nearly);
    board_feed(bytes, marks, 3, board.avr->cycle, 0);
    board_run_us(5000);
    for (int i = 0; i < 3; i++) assert_read(1, 28, bytes + i, 1);
    assert_counters(65535, 65535, 65535);
}

TEST(a_full_ring_keeps_what_it_has_and_the_next_byte_tells_of_the_loss)
{
    for (int round = 0; round < 3; round++) { /* wherever the ring begins */
        uint8_t bytes[128];
        board_feed(pattern, NULL, 100, board.avr->cycle, CHARACTER_115200);
        board_run_us(20000); /* the main loop is away */
        assert_int_equal(read_all(bytes, 40), RING);
        assert_memory_equal(bytes, pattern, RING);
        board_feed(pattern + 200, NULL, 3, board.avr->cycle, CHARACTER_115200);
        board_run_us(1000);
        assert_read(64, FATHOM_RX_OVERRUN, pattern + 200, 1);
        assert_int_equal(read_all(bytes, 64), 2);
        assert_memory_equal(bytes, pattern + 201, 2);
        assert_counters(0, 0, (uint16_t)(round + 1));
    }
}

TEST(a_ring_that_is_just_full_has_lost_nothing)
{
    uint8_t bytes[64];
    for (int round = 0; round < 3; round++) {
        board_feed(pattern, NULL, RING, board.avr->cycle, CHARACTER_115200);
        board_run_us(20000);
        assert_int_equal(read_all(bytes, 64), RING);
        assert_memory_equal(bytes, pattern, RING);
    }
    assert_counters(0, 0, 0);
}

/* With interrupts off for 16 ms, the USART keeps three of ten bytes; those that come afterwards are behind a loss. */
TEST(bytes_that_the_interrupt_comes_too_late_for_are_told_of)
{
    const fathom_line_settings_t at_9600 = {9600, FATHOM_PARITY_NONE, 1};
    assert_true(remote_begin(&at_9600, false, 8));
    board.taken = board.recorded;
    remote_watch_clock(true, 255);
    board_await(REMOTE_CLOCK, 100000);
    board_run_us(100);
    board_feed(pattern, NULL, 10, board.avr->cycle, 0);
    board_run_us(12000); /* the bytes took 10.4 */
    remote_watch_clock(false, 0);
    board_run_us(20000);
    assert_int_equal(board.usart.overruns, 7);
    assert_read(64, 0, pattern, 2);
    assert_read(64, FATHOM_RX_OVERRUN, pattern + 9, 1);
    assert_counters(0, 0, 1);
}

/* The bound; 4 more of entry. Here with a full ring too, in which the interrupt has to remember the loss. */
TEST(the_receive_interrupt_takes_at_most_60_cycles)
{
    profile_begin();
    board_feed(pattern, NULL, 100, board.avr->cycle, CHARACTER_115200);
    board_run_us(20000);
    assert_int_equal(profile.interrupts[PROFILE_USART_RECEIVE].calls, 100);
    assert_true(profile.interrupts[PROFILE_USART_RECEIVE].longest_cycles <= 60);
    print_message("receive interrupt: %u to %u cycles\n",
                  (unsigned)profile.interrupts[PROFILE_USART_RECEIVE].shortest_cycles,
                  (unsigned)profile.interrupts[PROFILE_USART_RECEIVE].longest_cycles);
}
