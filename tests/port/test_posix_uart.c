/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* rates above 38400, struct sigaction, timers */
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

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

/* ---- fathom_posix_wait, and the clock ----
 *
 * The event that ends a wait happens in another thread after 30 ms, so that the wait has normally begun. If the machine is
 * slower, the wait returns at once, and every assertion holds nevertheless. Upper limits of times are 10 s; the tests read
 * the time that a wait requests instead. */

enum { LONG_US = POSIX_LIMIT_MS * 1000, EVENT_US = 30000 };

static uint64_t timed_wait_us(uint32_t max_us)
{
    const uint64_t start_us = fathom_posix_now_us();
    fathom_posix_wait(&rig.port, max_us);
    return fathom_posix_now_us() - start_us;
}

/* Runs `event` in another thread, soon; the wait is in between. */
static uint64_t wait_for_event_us(void *(*event)(void *), uint32_t max_us)
{
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, event, NULL), 0);
    const uint64_t took_us = timed_wait_us(max_us);
    assert_int_equal(pthread_join(thread, NULL), 0);
    return took_us;
}

static void pass_a_while(void)
{
    const struct timespec time = {0, EVENT_US * 1000L};
    (void)nanosleep(&time, NULL);
}

static void *send_a_byte(void *arg)
{
    pass_a_while();
    return write(rig.pty.master, "x", 1) == 1 ? NULL : arg;
}

static void *hang_up(void *arg)
{
    pass_a_while();
    (void)close(rig.pty.master);
    rig.pty.master = -1;
    return NULL;
}

TEST(bytes_that_are_there_end_the_wait_at_once)
{
    posix_pty_send(&rig.pty, (const uint8_t *)"x", 1);
    assert_true(timed_wait_us(FATHOM_NO_DEADLINE) < LONG_US);
    assert_int_equal(port_rig_read_one(), 1);
}

TEST(bytes_that_come_end_the_wait)
{
    uint8_t byte = 0;
    assert_true(wait_for_event_us(send_a_byte, LONG_US) < LONG_US);
    assert_int_equal(port_rig_read(&byte, 1), 1);
    assert_true(wait_for_event_us(send_a_byte, FATHOM_NO_DEADLINE) < LONG_US);
    assert_int_equal(port_rig_read(&byte, 1), 1);
    assert_int_equal(byte, 'x');
}

/* ppoll(2) sleeps for the requested time, without the processor. The clock is simulated. */
TEST(an_idle_wait_is_one_sleep_and_is_not_rounded_up_to_milliseconds)
{
    static const struct {
        uint32_t us;
        int64_t seconds, nanoseconds;
    } rows[] = {{0, 0, 0},          {1, 0, 1000},           {999, 0, 999000},  {200, 0, 200000},
                {1750, 0, 1750000}, {300000, 0, 300000000}, {1000001, 1, 1000}};
    posix_time_stop();
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        posix_time.ppoll_count = 0;
        assert_true(timed_wait_us(rows[i].us) >= rows[i].us);
        assert_int_equal(posix_time.ppoll_count, 1);
        assert_false(posix_time.is_endless);
        assert_int_equal(posix_time.seconds, rows[i].seconds);
        assert_int_equal(posix_time.nanoseconds, rows[i].nanoseconds);
    }
}

TEST(a_hang_up_ends_the_wait_and_no_later_wait_sleeps)
{
    assert_true(wait_for_event_us(hang_up, FATHOM_NO_DEADLINE) < LONG_US);
    assert_true(timed_wait_us(FATHOM_NO_DEADLINE) < LONG_US); /* not read yet */
    assert_true(port_rig_read_one() < 0);
    assert_true(timed_wait_us(FATHOM_NO_DEADLINE) < LONG_US); /* known to be lost */
    fathom_posix_close(&rig.port);
    assert_true(timed_wait_us(FATHOM_NO_DEADLINE) < LONG_US); /* closed */
}

static volatile sig_atomic_t signals;

static void on_signal(int number)
{
    (void)number;
    signals++;
}

TEST(a_signal_ends_the_wait_and_does_no_harm_to_the_port)
{
    struct sigaction action;
    struct sigevent event;
    /* Again and again, so that one comes while the wait sleeps. */
    const struct itimerspec soon = {{0, EVENT_US * 1000L}, {0, EVENT_US * 1000L}};
    const struct itimerspec never = {{0, 0}, {0, 0}};
    timer_t timer;
    memset(&action, 0, sizeof action);
    memset(&event, 0, sizeof event);
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART; /* even so */
    assert_int_equal(sigaction(SIGUSR1, &action, NULL), 0);
    event.sigev_notify = SIGEV_SIGNAL;
    event.sigev_signo = SIGUSR1;
    assert_int_equal(timer_create(CLOCK_MONOTONIC, &event, &timer), 0);
    assert_int_equal(timer_settime(timer, 0, &soon, NULL), 0);
    assert_true(timed_wait_us(FATHOM_NO_DEADLINE) < LONG_US);
    assert_true(signals > 0);
    assert_int_equal(timer_settime(timer, 0, &never, NULL), 0);
    assert_int_equal(timer_delete(timer), 0);
    assert_int_equal(port_rig_read_one(), 0);
    assert_int_equal(fathom_posix_error(&rig.port), FATHOM_POSIX_OK);
}

TEST(a_poll_of_ones_own_sees_what_the_wait_sees)
{
    struct pollfd entry = {fathom_posix_fd(&rig.port), fathom_posix_poll_events(&rig.port), 0};
    assert_int_equal(entry.events, POLLIN);
    assert_int_equal(poll(&entry, 1, 0), 0);
    posix_pty_send(&rig.pty, (const uint8_t *)"x", 1);
    assert_int_equal(poll(&entry, 1, POSIX_LIMIT_MS), 1);
    assert_int_equal(entry.revents, POLLIN);
}

TEST_IN(plain, the_clock_counts_microseconds)
{
    const fathom_clock_t clock = fathom_posix_clock();
    const uint32_t start_us = clock.now_us(clock.ctx);
    const uint64_t long_start_us = fathom_posix_now_us();
    struct timespec before;
    struct timespec after;
    assert_int_equal(clock_gettime(CLOCK_BOOTTIME, &before), 0); /* another clock, at the same pace */
    pass_a_while();
    assert_int_equal(clock_gettime(CLOCK_BOOTTIME, &after), 0);
    const uint64_t long_end_us = fathom_posix_now_us();
    const uint32_t end_us = clock.now_us(clock.ctx);
    const int64_t real_us =
        (int64_t)(after.tv_sec - before.tv_sec) * 1000000 + (after.tv_nsec - before.tv_nsec) / 1000;
    assert_true(real_us >= EVENT_US);
    assert_true(long_end_us - long_start_us + 1 >= (uint64_t)real_us); /* each rounds down: 1 us */
    assert_true(long_end_us - long_start_us < LONG_US);
    assert_true(fathom_elapsed_us(end_us, start_us) >= long_end_us - long_start_us);
    assert_true(fathom_elapsed_us(end_us, start_us) < LONG_US);
}
