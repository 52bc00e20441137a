/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* rates above 38400 */
#include <poll.h>
#include <termios.h>

#include "posix_rig.h"
#include "posix_time.h"

/* The bytes of the port, over real pseudo terminals. While bytes are to be on the wire the clock is simulated: it stands
 * still until a wait moves it on, so a busy machine changes nothing. */

/* Each value once, going up, and each value twice, going down. */
enum { ALL = 768 };

static void fill_all(uint8_t *bytes)
{
    for (unsigned i = 0; i != 256; i++) bytes[i] = (uint8_t)i;
    for (unsigned i = 0; i != 512; i++) bytes[256 + i] = (uint8_t)(255 - i / 2);
}

/* That has been received. */
static void come(const char *text)
{
    posix_pty_send(&rig.pty, (const uint8_t *)text, strlen(text));
    assert_true(posix_wait_for(fathom_posix_fd(&rig.port), POLLIN));
}

static int set_up(void **state)
{
    posix_time_begin(false);
    return port_rig_set_up_open(state);
}

static const suite_t suite = PORT_RIG_SUITE(set_up);
static const suite_t plain;

TEST(every_byte_value_arrives_as_it_was_sent)
{
    uint8_t all[ALL];
    uint8_t got[ALL + 1];
    size_t have = 0;
    fill_all(all);
    posix_pty_send(&rig.pty, all, sizeof all);
    while (have < sizeof all) {
        assert_true(posix_wait_for(fathom_posix_fd(&rig.port), POLLIN));
        const int n = port_rig_read(got + have, sizeof got - have);
        assert_true(n > 0);
        have += (size_t)n;
    }
    assert_int_equal(have, sizeof all);
    assert_memory_equal(got, all, sizeof all);
    assert_int_equal(port_rig_read(got, sizeof got), 0);
    assert_int_equal(posix_pty_receive(&rig.pty, got, sizeof got), 0); /* no echo */
}

TEST(after_a_hang_up_every_read_and_write_fails)
{
    assert_int_equal(port_rig_read_one(), 0);
    posix_pty_close(&rig.pty);
    for (int i = 0; i != 3; i++) assert_true(port_rig_read_one() < 0);
    for (int i = 0; i != 3; i++) assert_true(port_rig_write_one() < 0);
    assert_true(port_rig_sent());
    assert_int_equal(fathom_posix_error(&rig.port), FATHOM_POSIX_ERR_LOST);
    assert_non_null(strstr(fathom_posix_error_text(&rig.port), "unplugged"));
    assert_int_equal(fathom_posix_set_line(&rig.port, &port_rig_fast), FATHOM_POSIX_ERR_LOST);
}

TEST(a_lost_port_works_again_once_it_is_reopened)
{
    posix_pty_close(&rig.pty);
    assert_true(port_rig_read_one() < 0);
    fathom_posix_close(&rig.port);
    posix_pty_open(&rig.pty);
    port_rig_open();
    assert_int_equal(port_rig_read_one(), 0); /* through the fathom_uart_t from before */
    assert_int_equal(port_rig_write_one(), 1);
}

static uint8_t pattern(size_t at) { return (uint8_t)(at * 7 + at / 256); }

/* Writes requests of 251 bytes until the port and the far end are full. Returns the number of bytes that the port accepted.
 * The kernel moves bytes to the far end when it finds time, so the port is full when it has been so for 20 ms. */
static size_t fill(void)
{
    uint8_t request[251];
    size_t total = 0;
    bool was_full = false;
    for (;;) {
        for (size_t i = 0; i != sizeof request; i++) request[i] = pattern(total + i);
        const int n = port_rig_write(request, sizeof request);
        if (n == 0 && was_full) return total;
        was_full = n == 0;
        if (was_full) (void)poll(NULL, 0, 20);
        if (was_full) continue;
        assert_int_equal(n, sizeof request);
        total += sizeof request;
        assert_true(total < 10000000);
    }
}

TEST(a_full_port_takes_nothing_and_what_it_took_leaves_whole_and_in_order)
{
    uint8_t got[777];
    const size_t total = fill();
    assert_true(total > 251);
    /* The set-up is what is meant: the kernel took a part of the last request, the port keeps the rest. */
    assert_int_equal(fathom_posix_poll_events(&rig.port), POLLIN | POLLOUT);
    assert_int_equal(port_rig_write(got, 1), 0);
    assert_false(port_rig_sent());

    size_t have = 0;
    while (have < total) {
        assert_true(posix_wait_for(rig.pty.master, POLLIN));
        const size_t n = posix_pty_receive(&rig.pty, got, sizeof got);
        for (size_t i = 0; i != n; i++) assert_int_equal(got[i], pattern(have + i));
        have += n;
        (void)port_rig_read(got, sizeof got); /* which moves the rest along */
    }
    assert_int_equal(have, total);
    assert_int_equal(fathom_posix_poll_events(&rig.port), POLLIN);
    assert_int_equal(posix_pty_receive(&rig.pty, got, sizeof got), 0);
    assert_int_equal(port_rig_write(got, 1), 1);
}

TEST(a_write_of_no_length_or_too_long_leaves_the_port_as_it_was)
{
    uint8_t bytes[FATHOM_POSIX_WRITE_MAX + 1] = {0};
    assert_int_equal(port_rig_write(bytes, 0), 0);
    assert_true(port_rig_write(bytes, sizeof bytes) < 0);
    assert_int_equal(port_rig_write(bytes, FATHOM_POSIX_WRITE_MAX), FATHOM_POSIX_WRITE_MAX);
    assert_int_equal(port_rig_read(bytes, 1), 0);
}

TEST(sent_takes_as_long_as_the_bytes_take_on_a_wire)
{
    const fathom_line_settings_t slow = {9600, FATHOM_PARITY_EVEN, 2};
    const uint8_t bytes[100] = {0};
    const uint32_t needed_us = 100u * 12u * 1000000u / 9600u; /* start, 8, parity, 2 stop bits */
    assert_true(port_rig_sent());
    assert_int_equal(fathom_posix_set_line(&rig.port, &slow), FATHOM_POSIX_OK);
    assert_true(port_rig_sent());
    posix_time_stop();
    const uint64_t start_us = fathom_posix_now_us();
    assert_int_equal(port_rig_write(bytes, 60), 60);
    assert_int_equal(port_rig_write(bytes, 40), 40); /* follows the first */
    while (fathom_posix_now_us() - start_us < needed_us) {
        const uint32_t left_us = needed_us - (uint32_t)(fathom_posix_now_us() - start_us);
        assert_false(port_rig_sent());
        assert_int_equal(port_rig_leaves_in_us(), left_us);
        fathom_posix_wait(&rig.port, left_us > 1000 ? 1000 : 1);
    }
    assert_true(port_rig_sent());
    assert_int_equal(port_rig_leaves_in_us(), 0);
}

/* Waits until all bytes have left, in simulated time. */
static void until_sent(void)
{
    for (unsigned ms = 0; !port_rig_sent(); ms++) {
        assert_true(ms < POSIX_LIMIT_MS);
        fathom_posix_wait(&rig.port, 1000);
    }
}

/* hal.h: 1 they hold, 0 bytes are still leaving, < 0 it cannot. */
TEST(the_hal_changes_the_line_between_two_requests)
{
    const fathom_uart_t uart = fathom_posix_uart(&rig.port);
    const fathom_line_settings_t even = {9600, FATHOM_PARITY_EVEN, 1};
    const fathom_line_settings_t odd_rate = {31250, FATHOM_PARITY_NONE, 1};
    const uint8_t bytes[50] = {0};
    posix_time_stop();
    assert_int_equal(uart.set_line(uart.ctx, &usual), 1);
    assert_int_equal(port_rig_speed(), B9600);
    assert_int_equal(uart.set_line(uart.ctx, &even), 1);
    assert_int_equal(rig.port.line.parity, FATHOM_PARITY_EVEN);
    assert_int_equal(port_rig_write(bytes, sizeof bytes), sizeof bytes);
    assert_int_equal(uart.set_line(uart.ctx, &even), 1); /* nothing to change, so nothing to wait for */
    assert_int_equal(uart.set_line(uart.ctx, &port_rig_fast), 0);
    assert_int_equal(fathom_posix_set_line(&rig.port, &port_rig_fast), FATHOM_POSIX_ERR_BUSY);
    assert_int_equal(port_rig_speed(), B9600);
    until_sent();
    assert_true(uart.set_line(uart.ctx, &odd_rate) < 0);
    assert_int_equal(fathom_posix_error(&rig.port), FATHOM_POSIX_ERR_ARGUMENT);
    assert_int_equal(port_rig_speed(), B9600);
    assert_int_equal(uart.set_line(uart.ctx, &port_rig_fast), 1);
    assert_int_equal(port_rig_speed(), B230400);
}

TEST(a_closed_port_fails_and_can_be_closed_again)
{
    fathom_posix_line_errors_t errors;
    fathom_posix_close(&rig.port);
    fathom_posix_close(&rig.port);
    assert_int_equal(fathom_posix_fd(&rig.port), -1);
    assert_true(port_rig_read_one() < 0);
    assert_true(port_rig_write_one() < 0);
    assert_true(port_rig_sent());
    assert_int_equal(port_rig_leaves_in_us(), 0);
    assert_int_equal(fathom_posix_set_line(&rig.port, &port_rig_fast), FATHOM_POSIX_ERR_CLOSED);
    assert_int_equal(fathom_posix_line_errors(&rig.port, &errors), FATHOM_POSIX_ERR_CLOSED);
    assert_int_equal(fathom_posix_error(&rig.port), FATHOM_POSIX_ERR_CLOSED);
}

TEST_IN(plain, a_port_of_zeros_is_a_closed_one_and_not_standard_input)
{
    static fathom_posix_uart_t zeros;
    const fathom_uart_t uart = fathom_posix_uart(&zeros);
    const unsigned before = posix_count_fds();
    uint8_t byte = 0;
    assert_true(uart.write(uart.ctx, &byte, 1) < 0);
    assert_int_equal(fathom_posix_set_line(&zeros, &port_rig_fast), FATHOM_POSIX_ERR_CLOSED);
    fathom_posix_close(&zeros);
    assert_int_equal(posix_count_fds(), before);
}

TEST(a_pseudo_terminal_counts_no_line_errors)
{
    fathom_posix_line_errors_t errors = {1, 2, 3, 4};
    assert_int_equal(fathom_posix_line_errors(&rig.port, &errors), FATHOM_POSIX_ERR_UNSUPPORTED);
    assert_int_equal(errors.parity, 1);
    assert_int_equal(port_rig_read_one(), 0); /* the port is none the worse */
}

TEST(a_small_buffer_gets_the_bytes_in_portions)
{
    uint8_t got[4] = {0};
    come("abc");
    assert_int_equal(port_rig_read(got, 0), 0); /* no room is no hang-up */
    assert_int_equal(port_rig_read(got, 2), 2);
    assert_int_equal(port_rig_read(got + 2, 2), 1);
    assert_memory_equal(got, "abc", 3);
}
