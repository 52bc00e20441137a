/* SPDX-License-Identifier: MIT */
/* The rates and formats of port/avr: ATmega328P 20.10 at 16 MHz, by hand. */
#include "suite.h"

#include "remote.h"

enum { UCSR0A = 0xC0, UCSR0C = 0xC2, UBRR0L = 0xC4, UBRR0H = 0xC5, U2X = 0x02 };

static const fathom_line_settings_t at_19200 = {19200, FATHOM_PARITY_EVEN, 1};

static const fathom_line_settings_t at_9600 = {9600, FATHOM_PARITY_NONE, 1};
static const uint8_t request[] = {1, 2, 3};

static int start(void **state)
{
    remote_start();
    assert_true(remote_begin(&at_19200, false, 8));
    return 0;
}

static const suite_t suite = {.set_up = start, .tear_down = board_stop};

static uint16_t ubrr(void) { return (uint16_t)(board.avr->data[UBRR0L] | board.avr->data[UBRR0H] << 8); }

static bool u2x(void) { return (board.avr->data[UCSR0A] & U2X) != 0; }

/* 2000000 / baud, to the nearest, is what divides with U2X0; half of that, where it is even, does without, and that is
 * to be preferred, as the receiver looks at a bit 16 times then. */
TEST(every_rate_has_the_divisor_that_the_arithmetic_says)
{
    static const struct {
        uint32_t baud;
        uint16_t ubrr;
        bool u2x;
    } rates[] = {
        {1200, 1666, true},  /* 1666.7: 1667 */
        {2400, 832, true},   /* 833.3: 833 */
        {4800, 416, true},   /* 416.7: 417 */
        {9600, 103, false},  /* 208.3: 208 */
        {14400, 138, true},  /* 138.9: 139 */
        {19200, 51, false},  /* 104.2: 104 */
        {28800, 68, true},   /* 69.4: 69 */
        {38400, 25, false},  /* 52.1: 52 */
        {57600, 34, true},   /* 34.7: 35, off by 0.8 % */
        {76800, 12, false},  /* 26.04: 26 */
        {115200, 16, true},  /* 17.4: 17, off by 2.1 % */
        {250000, 3, false},  /* 8 */
        {500000, 1, false},  /* 4 */
        {1000000, 0, false}, /* 2 */
        {2000000, 0, true},  /* 1 */
        {128000, 7, false},  /* 15.6: 16, off by 2.3 % */
    };
    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        const fathom_line_settings_t line = {rates[i].baud, FATHOM_PARITY_NONE, 1};
        assert_int_equal(remote_set_line(&line), 1);
        assert_int_equal(ubrr(), rates[i].ubrr);
        assert_int_equal(u2x(), rates[i].u2x);
        const uint64_t cycle = board.avr->cycle;
        assert_int_equal(remote_set_line(&line), 1); /* again: they hold */
        assert_true(board.avr->cycle > cycle);
        assert_int_equal(ubrr(), rates[i].ubrr);
    }
}

TEST(rates_beyond_two_and_a_half_percent_are_refused_and_change_nothing)
{
    /* 230400: 8.7, 3.5 % off; 300000: 6.7, 4.8 %; 3000000: 0.7; 100: 20000, more than 4096 */
    static const uint32_t bauds[] = {230400, 300000, 3000000, UINT32_MAX, 100, 0};
    for (size_t i = 0; i < sizeof bauds / sizeof bauds[0]; i++) {
        const fathom_line_settings_t line = {bauds[i], FATHOM_PARITY_NONE, 2};
        assert_true(remote_set_line(&line) < 0);
        assert_int_equal(ubrr(), 51);
        assert_false(u2x());
        assert_int_equal(board.avr->data[UCSR0C], 0x26);
    }
}

/* ATmega328P 20.11.4: UPM01 0x20, UPM00 0x10, USBS0 0x08, UCSZ01 and UCSZ00 0x06. */
TEST(every_format_has_its_bits)
{
    static const uint8_t parities[] = {0x00, 0x20, 0x30};
    /* Once parity, once stop bits are what changes from one to the next. */
    for (uint8_t i = 0; i < 12; i++) {
        const uint8_t parity = i < 6 ? i % 3 : i / 2 % 3;
        const uint8_t stop_bits = (i < 6 ? i / 3 : i % 2) + 1;
        const fathom_line_settings_t line = {9600, parity, stop_bits};
        assert_int_equal(remote_set_line(&line), 1);
        assert_int_equal(board.avr->data[UCSR0C], 0x06 | parities[parity] | (stop_bits == 2 ? 0x08 : 0));
    }
    static const fathom_line_settings_t wrong[] = {{9600, 3, 1}, {9600, 0, 0}, {9600, 0, 3}};
    for (size_t i = 0; i < 3; i++) {
        assert_true(remote_set_line(&wrong[i]) < 0);
        assert_int_equal(board.avr->data[UCSR0C], 0x3E);
    }
}

TEST(settings_wait_until_all_bytes_have_left)
{
    const fathom_line_settings_t never = {230400, FATHOM_PARITY_NONE, 1};
    remote_write(request, sizeof request);
    int refused = 0;
    for (;;) {
        const uint64_t begin_cycle = board.avr->cycle;
        const int done = remote_set_line(&at_9600);
        if (done == 1) break;
        assert_int_equal(done, 0);
        assert_int_equal(ubrr(), 51);
        refused++;
        assert_true(board.bytes_seen < 3 || begin_cycle < board.bytes[2].end_cycle + 100);
    }
    assert_true(refused > 10);
    assert_int_equal(board.bytes_seen, 3);
    assert_true(board.avr->cycle >= board.bytes[2].end_cycle);
    for (int i = 0; i < 3; i++)
        assert_int_equal(board.bytes[i].end_cycle - board.bytes[i].begin_cycle, 11 * 52 * 16);
    remote_write(request, 1);
    assert_true(remote_set_line(&never) < 0);
    board_run_us(2000);
    assert_int_equal(board.bytes[3].end_cycle - board.bytes[3].begin_cycle, 10 * 104 * 16);
}

TEST(settings_that_hold_already_do_so_at_once_also_while_bytes_leave)
{
    assert_int_equal(remote_write(request, sizeof request), 3);
    assert_int_equal(remote_set_line(&at_19200), 1);
    assert_int_equal(remote_set_line(&at_9600), 0);
    board_run_us(3000);
    assert_int_equal(board.bytes_seen, 3);
    assert_int_equal(remote_set_line(&at_9600), 1);
    assert_int_equal(remote_write(request, sizeof request), 3);
    assert_int_equal(remote_set_line(&at_9600), 1);
    assert_int_equal(remote_set_line(&at_19200), 0);
    assert_int_equal(ubrr(), 103);
}

TEST(what_was_received_before_is_kept)
{
    static const uint8_t bytes[] = {5, 6, 7};
    uint8_t got[8], flags;
    board_feed(bytes, NULL, 3, board.avr->cycle, 0);
    board_run_us(3000);
    assert_int_equal(remote_set_line(&at_9600), 1);
    assert_int_equal(remote_read(got, 8, &flags), 3);
    assert_int_equal(flags, 0);
    assert_memory_equal(got, bytes, 3);
}
