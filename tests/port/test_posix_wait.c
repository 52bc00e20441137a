/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* struct sigaction, timers */
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

#include "posix_rig.h"
#include "posix_time.h"

/*
 * fathom_posix_wait over real pseudo terminals, and the clock, in real time. The event that ends a wait happens in another
 * thread after 30 ms, so that the wait has normally begun. If the machine is slower, the wait returns at once, and every
 * assertion holds nevertheless. Upper limits of times are 10 s; the tests read the time that a wait requests instead.
 */

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

static int set_up(void **state)
{
    posix_time_begin(false);
    return port_rig_set_up_open(state);
}

static const suite_t suite = PORT_RIG_SUITE(set_up);
static const suite_t plain;

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

TEST(the_time_ends_the_wait_and_not_earlier)
{
    static const uint32_t times_us[] = {0, 1, 999, 1750, 20000, 100000};
    for (size_t i = 0; i != sizeof times_us / sizeof times_us[0]; i++) {
        const uint64_t took_us = timed_wait_us(times_us[i]);
        assert_true(took_us >= times_us[i]);
        assert_true(took_us < LONG_US);
    }
}

/* ppoll(2) sleeps for the requested time, without the processor. The clock is simulated. */
TEST(an_idle_wait_is_one_sleep_and_is_not_rounded_up_to_milliseconds)
{
    static const struct {
        uint32_t us;
        int64_t seconds, nanoseconds;
    } rows[] = {{200, 0, 200000}, {1750, 0, 1750000}, {300000, 0, 300000000}, {1000001, 1, 1000}};
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

TEST_IN(plain, the_clock_never_runs_back_and_counts_microseconds)
{
    const fathom_clock_t clock = fathom_posix_clock();
    uint64_t last_us = fathom_posix_now_us();
    for (int i = 0; i != 100000; i++) {
        const uint64_t now_us = fathom_posix_now_us();
        assert_true(now_us >= last_us);
        last_us = now_us;
    }
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

TEST_IN(plain, the_short_clock_is_the_low_half_of_the_long_one)
{
    const fathom_clock_t clock = fathom_posix_clock();
    const uint64_t before_us = fathom_posix_now_us();
    const uint32_t between_us = clock.now_us(clock.ctx);
    const uint64_t after_us = fathom_posix_now_us();
    assert_true(fathom_elapsed_us(between_us, (uint32_t)before_us) <= after_us - before_us);
}
