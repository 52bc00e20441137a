/* SPDX-License-Identifier: MIT */
/* What port/avr sends: its bits, its driver-enable pin, `sent`, refusals, breaks. */
#include "suite.h"

#include "remote.h"

/* The driver-enable pin falls in an interrupt, which has to be over within a bit of 115200 baud, 138 cycles, whatever
 * else the processor does; the next talker waits for 28 of them. A receive interrupt before it has its 60, and its
 * entry. */
enum { MOST_AFTER_STOP_BIT = 80, MOST_OF_RECEIVE = 64 };

static const fathom_line_settings_t at_19200 = {19200, FATHOM_PARITY_EVEN, 1};
static const uint8_t request[] = {0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB}; /* HPS-167S #5 */

static int start(void **state)
{
    remote_start();
    board_join_driver('D', 3);
    assert_true(remote_begin(&at_19200, true, REMOTE_REQUEST));
    return 0;
}

static const suite_t suite = {.set_up = start, .tear_down = board_stop};

static bool all_out(void *ctx) { return !board.usart.shifting && !board.driver_on && board.bytes_seen != 0; }

static void wait_until_out(void) { assert_true(board_run(all_out, NULL, 1000000)); }

static void assert_sent(const uint8_t *bytes, uint8_t length, uint32_t character_cycles)
{
    assert_int_equal(board.bytes_seen, length);
    for (uint8_t i = 0; i < length; i++) {
        assert_true(board.bytes[i].from_here);
        assert_int_equal(board.bytes[i].byte, bytes[i]);
        assert_int_equal(board.bytes[i].end_cycle - board.bytes[i].begin_cycle, character_cycles);
        if (i != 0) assert_int_equal(board.bytes[i].begin_cycle, board.bytes[i - 1].end_cycle);
    }
}

static void assert_driver_around(uint8_t length)
{
    assert_int_equal(board.driver_edges_seen, 2);
    assert_int_equal(board.cut_bytes, 0);
    assert_true(board.driver_edges[0].high);
    assert_false(board.driver_edges[1].high);
    assert_true(board.driver_edges[0].cycle < board.bytes[0].begin_cycle);
    const uint64_t end_cycle = board.bytes[length - 1].end_cycle;
    assert_in_range(board.driver_edges[1].cycle, end_cycle, end_cycle + MOST_AFTER_STOP_BIT);
}

/* HPS-167S #5 leaves, whole: start, 8, parity, stop; UBRR 51. */
enum { CHARACTER = 11 * 52 * 16 };

static void assert_request_left(uint8_t length)
{
    wait_until_out();
    assert_sent(request, length, CHARACTER);
}

static void assert_request_leaves(void)
{
    assert_int_equal(remote_write(request, sizeof request), sizeof request);
    assert_request_left(sizeof request);
    assert_driver_around(sizeof request);
}

static void forget(void)
{
    board.bytes_seen = 0;
    board.driver_edges_seen = 0;
}

TEST(a_request_leaves_without_a_gap_and_the_driver_is_on_around_it)
{
    assert_false(board.driver_on);
    assert_request_leaves();
}

TEST(the_driver_falls_after_the_last_stop_bit_at_every_rate_and_length)
{
    static const struct {
        fathom_line_settings_t line;
        uint32_t character_cycles;
    } rates[] = {
        {{9600, FATHOM_PARITY_NONE, 1}, 10 * 104 * 16},
        {{19200, FATHOM_PARITY_EVEN, 1}, 11 * 52 * 16},
        {{57600, FATHOM_PARITY_ODD, 2}, 12 * 35 * 8},
        {{115200, FATHOM_PARITY_EVEN, 1}, 11 * 17 * 8},
    };
    uint8_t bytes[REMOTE_REQUEST];
    for (uint8_t i = 0; i < REMOTE_REQUEST; i++) bytes[i] = (uint8_t)(0xF1 * i);
    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        assert_int_equal(remote_set_line(&rates[i].line), 1);
        for (uint8_t length = 1; length <= REMOTE_REQUEST; length++) {
            forget();
            assert_int_equal(remote_write(bytes, length), length);
            wait_until_out();
            assert_sent(bytes, length, rates[i].character_cycles);
            assert_driver_around(length);
        }
    }
}

/* A byte that is received while the last one leaves has its interrupt first. */
TEST(a_receive_interrupt_delays_the_driver_by_no_more_than_itself)
{
    static const uint8_t noise = 0x55;
    for (int phase = -80; phase <= 20; phase++) {
        forget();
        remote_write(request, 1);
        assert_int_equal(board.bytes_seen, 1);
        const uint64_t end_cycle = board.bytes[0].end_cycle;
        board_feed(&noise, NULL, 1, (uint64_t)((int64_t)end_cycle + phase) - CHARACTER, CHARACTER);
        wait_until_out();
        assert_in_range(board.driver_edges[1].cycle, end_cycle,
                        end_cycle + MOST_AFTER_STOP_BIT + MOST_OF_RECEIVE);
        uint8_t byte = 0, flags;
        board_run_us(20);
        assert_int_equal(remote_read(&byte, 1, &flags), 1);
        assert_int_equal(byte, noise);
    }
}

/* With interrupts off for 5 ms at a time the bytes have pauses, and transmit complete comes before the last of them. */
TEST(the_driver_stays_on_through_a_pause_that_other_interrupts_make)
{
    remote_write(request, sizeof request);
    remote_watch_clock(true, 80);
    wait_until_out();
    remote_watch_clock(false, 0);
    assert_int_equal(board.bytes_seen, sizeof request);
    uint32_t pauses = 0;
    for (uint8_t i = 0; i < sizeof request; i++) {
        assert_int_equal(board.bytes[i].byte, request[i]);
        if (i != 0 && board.bytes[i].begin_cycle != board.bytes[i - 1].end_cycle) pauses++;
    }
    assert_true(pauses >= 2);
    assert_int_equal(board.driver_edges_seen, 2);
    assert_int_equal(board.cut_bytes, 0);
    assert_true(board.driver_edges[1].cycle >= board.bytes[sizeof request - 1].end_cycle);
    board_run_us(10000);
    assert_true(remote_sent());
}

static bool first_has_begun(void *ctx) { return board.bytes_seen != 0; }

/* The interrupt that gives the second byte is late by a character, so that the first one ends at any cycle of it:
 * before the byte is given transmit complete comes of that, and means nothing. */
TEST(a_byte_that_comes_at_any_cycle_of_the_end_of_the_last_one_keeps_the_driver_on)
{
    int pauses = 0;
    for (uint64_t before_cycles = 0; before_cycles < 240; before_cycles++) {
        forget();
        volatile remote_t *const remote = remote_call(REMOTE_WRITE);
        remote->bytes[0] = 0x11;
        remote->bytes[1] = 0x22;
        remote->length = 2;
        assert_true(board_run(first_has_begun, NULL, 1000));
        board_stall(board.bytes[0].end_cycle - board.avr->cycle - before_cycles);
        board_run_us(2000);
        assert_int_equal(board.bytes_seen, 2);
        assert_int_equal(board.cut_bytes, 0);
        assert_int_equal(board.driver_edges_seen, 2);
        assert_true(board.driver_edges[1].cycle >= board.bytes[1].end_cycle);
        if (board.bytes[1].begin_cycle != board.bytes[0].end_cycle) pauses++;
    }
    assert_in_range(pauses, 20, 220); /* it was early and it was late */
}

TEST(sent_is_exact_to_the_stop_bit)
{
    assert_true(remote_sent());
    remote_write(request, sizeof request);
    uint64_t last_false_cycle = 0, first_true_cycle = 0;
    while (first_true_cycle == 0) {
        const uint64_t begin_cycle = board.avr->cycle;
        if (remote_sent())
            first_true_cycle = board.avr->cycle;
        else
            last_false_cycle = begin_cycle;
        board_run(NULL, NULL, 0);
    }
    assert_int_equal(board.bytes_seen, sizeof request);
    const uint64_t end_cycle = board.bytes[sizeof request - 1].end_cycle;
    assert_true(first_true_cycle >= end_cycle);
    assert_true(last_false_cycle < end_cycle + MOST_AFTER_STOP_BIT);
    assert_true(first_true_cycle - last_false_cycle < 1000); /* so near did we look */
}

/* "at most": of the one or two bytes that the hardware has it is not known how much has left. */
TEST(when_the_request_has_left_is_known_to_two_characters)
{
    enum { LOOKS = 40 };
    uint64_t cycles[LOOKS];
    uint32_t left_us[LOOKS];
    unsigned looks = 0;
    assert_int_equal(remote_leaves_in_us(), 0);
    remote_write(request, sizeof request);
    do {
        assert_true(looks < LOOKS);
        cycles[looks] = board.avr->cycle;
        left_us[looks++] = remote_leaves_in_us();
        board_run_us(200);
    } while (!remote_sent());
    assert_in_range(left_us[0], 4583, 4584); /* 8 characters of 11 bits at 19200 baud */
    const uint64_t end_cycle = board.bytes[sizeof request - 1].end_cycle;
    while (looks-- != 0) {
        const uint64_t left_cycles = (uint64_t)left_us[looks] * BOARD_CYCLES_PER_US;
        assert_in_range(cycles[looks] + left_cycles, end_cycle - 1000, end_cycle + 2 * CHARACTER + 1000);
    }
    assert_int_equal(remote_leaves_in_us(), 0);
}

TEST(a_write_is_refused_while_bytes_leave_and_does_not_touch_them)
{
    static const uint8_t other[] = {0xAA, 0xAA, 0xAA, 0xAA};
    assert_int_equal(remote_write(request, sizeof request), sizeof request);
    /* A call takes some hundred cycles: one that begins in the last bit may find it over. */
    while (board.bytes_seen < sizeof request ||
           board.avr->cycle + 2000 < board.bytes[sizeof request - 1].end_cycle)
        assert_int_equal(remote_write(other, sizeof other), 0);
    assert_request_left(sizeof request);
    assert_driver_around(sizeof request);
}

TEST(a_write_of_nothing_or_more_than_its_memory_is_an_error_and_nothing_leaves)
{
    const uint8_t bytes[REMOTE_REQUEST + 1] = {0};
    assert_true(remote_write(bytes, REMOTE_REQUEST + 1) < 0);
    assert_true(remote_begin(&at_19200, true, 8));
    assert_true(remote_write(bytes, 9) < 0);
    assert_true(remote_write(bytes, 0) < 0); /* which would be 256 of whatever is there */
    board_run_us(10000);
    assert_int_equal(board.bytes_seen, 0);
    assert_int_equal(board.driver_edges_seen, 0);
    assert_int_equal(remote_write(request, 8), 8);
    assert_request_left(8);
}

TEST(without_a_driver_pin_none_is_driven)
{
    assert_true(remote_begin(&at_19200, false, 8));
    board.has_driver = false;
    remote_write(request, sizeof request);
    board_run_us(20000);
    assert_sent(request, sizeof request, CHARACTER);
    assert_int_equal(board.driver_edges_seen, 0);
}

TEST(begin_refuses_what_it_cannot_do)
{
    static const fathom_line_settings_t too_fast = {230400, FATHOM_PARITY_EVEN, 1};
    const uint8_t ubrr = board.avr->data[0xC4];
    assert_false(remote_begin(&too_fast, true, 8));
    assert_false(remote_begin(&at_19200, true, 0));
    assert_int_equal(board.avr->data[0xC4], ubrr);
    remote_write(request, sizeof request);
    assert_request_left(sizeof request);
}

static fathom_sim_line_t line;
static void begin_line(void)
{
    fathom_sim_line_init(&line, &at_19200, board.clock.now_us);
    board_join_line(&line);
}

TEST(a_break_holds_txd_low_for_its_time_with_the_driver_on)
{
    begin_line();
    assert_false(line.in_break);
    assert_int_equal(remote_set_break(true), 1);
    assert_true(line.in_break);
    assert_true(board.driver_on);
    board_run_us(5000);
    assert_true(line.in_break);
    assert_int_equal(remote_write(request, sizeof request), 0);
    assert_int_equal(remote_set_break(false), 1);
    assert_false(line.in_break);
    assert_false(board.driver_on);
    assert_int_equal(board.bytes_seen, 0);
    forget();
    assert_request_leaves();
}

TEST(a_break_waits_for_the_last_stop_bit)
{
    begin_line();
    remote_write(request, sizeof request);
    int refused = 0;
    while (remote_set_break(true) == 0) {
        assert_false(line.in_break);
        refused++;
    }
    assert_true(refused > 10);
    assert_true(line.in_break);
    assert_int_equal(board.cut_bytes, 0);
    assert_int_equal(board.bytes_seen, sizeof request);
    assert_true(board.avr->cycle > board.bytes[sizeof request - 1].end_cycle);
    assert_int_equal(remote_set_break(false), 1);
}
