/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* struct sigaction, sockets */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <sys/time.h>
#include <unistd.h>

#include "loop_ends_rig.h"

/* What wakes fathom_loop.h, and what ends its sleep, on real descriptors. The clock is simulated, so the numbers of polls
 * and steps are exact. A test that waits for another process, a thread or a signal uses the real clock; its only upper
 * limit is the watchdog or 10 s. */

static fathom_loop_pin_t other;
static fake_sensor_t second;

static const suite_t suite = {.set_up = ends_set_up, .tear_down = ends_tear_down};

/* ---- pins ---- */

TEST(a_pin_is_polled_when_its_descriptor_becomes_ready_and_not_as_long_as_it_is)
{
    add_pin(&pin, &first, ends[0]);
    assert_int_equal(pass(SOON_US), 2); /* the first poll, and the rest of the time */
    assert_int_equal(first.polls, 1);
    send_bytes(1);
    assert_int_equal(pass(SOON_US), 2); /* the byte, and the rest of the time */
    assert_int_equal(first.polls, 2);   /* though nothing has read it */
    send_bytes(1);
    (void)pass(SOON_US);
    assert_int_equal(first.polls, 3);
}

TEST(what_was_there_before_the_pin_was_added_is_seen)
{
    send_bytes(1);
    add_pin(&pin, &first, ends[0]);
    (void)pass(1000);
    assert_true(first.polls >= 1);
}

/* epoll_ctl(2): EPERM. It is polled every 10 ms. */
TEST(a_descriptor_that_epoll_refuses_is_polled_all_the_same)
{
    char path[] = "/tmp/fathom-loop-XXXXXX";
    const int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(unlink(path), 0);
    add_pin(&pin, &first, file);
    assert_int_equal(pass(200000), 21);
    assert_int_equal(first.polls, 21); /* at 0, 10, ..., 200 ms */
    fathom_loop_remove(&pin.source);
    (void)close(file);
}

/* epoll_ctl(2): EEXIST. */
TEST(a_descriptor_of_two_pins_wakes_one_and_the_other_is_polled)
{
    add_pin(&pin, &first, ends[0]);
    add_pin(&other, &second, ends[0]);
    (void)pass(100000);
    assert_int_equal(first.polls, 1);
    assert_int_equal(second.polls, 11); /* at 0, 10, ..., 100 ms */
    fathom_loop_remove(&other.source);  /* which takes nothing from the first */
    send_bytes(1);
    (void)pass(SOON_US);
    assert_int_equal(first.polls, 2);
}

/* If the chip of a line goes away, the kernel reports EPOLLHUP and EPOLLERR; a level would stay as it was. The loop tries
 * again after pauses of 5, 10, 20, 40 and 80 ms, and 80 ms from then on: at 5, 15, 35, 75, 155, 235, 315 and 395 ms. */
TEST(a_pin_whose_chip_has_gone_is_lost_and_said_once_a_pause)
{
    line_rig_end();
    line_rig_begin(&(fathom_loop_config_t){.first_pause_us = 5000, .longest_pause_us = 80000});
    add_pin(&pin, &first, ends[0]);
    (void)pass(1000);
    ends_close(1);
    assert_int_equal(pass(400000), 1 + 8 + 1); /* the loss, each try, and the rest of the time */
    assert_int_equal(first.port_errors, 1);
    assert_int_equal(rig.failed, 1 + 8);
    assert_int_equal(rig.opened, 1);
    assert_string_equal(fathom_loop_error_text(&pin.source), "it is lost");
}

/* ---- bytes ---- */

TEST(what_one_read_does_not_bring_the_next_ones_do)
{
    add_stream(4);
    send_bytes(14);
    assert_int_equal(pass(SOON_US), 5); /* 4, 4, 4 and 2 bytes, and the rest of the time */
    assert_int_equal(stream.bytes, 14);
}

/* Bytes and the hang-up come as one event, and the read of the bytes is short. */
TEST(a_hang_up_right_behind_the_last_bytes_is_seen)
{
    add_stream(64);
    send_bytes(3);
    ends_close(1);
    (void)pass(SOON_US);
    assert_int_equal(stream.bytes, 3);
    assert_true(stream.is_lost);
    assert_int_equal(rig.failed, 1);
}

/* ---- lines ---- */

static size_t write_all(void)
{
    static const uint8_t bytes[251];
    const fathom_uart_t *const uart = &rig.lines[0].bus.uart;
    size_t total = 0;
    while (uart->write(uart->ctx, bytes, sizeof bytes) > 0) total += sizeof bytes;
    return total;
}

TEST(the_rest_of_a_request_leaves_when_the_kernel_has_room_again)
{
    uint8_t got[777];
    posix_time_begin(false); /* the kernel moves the bytes when it finds time */
    posix_pty_open(&rig.ptys[0]);
    line_rig_add(921600);
    (void)pass(1000);
    size_t total = 0, have = 0;
    const uint64_t begin_us = fathom_posix_now_us();
    while (rig.lines[0].source.events != (POLLIN | POLLOUT)) { /* the kernel's buffers fill behind its back */
        total += write_all();
        fathom_loop_wake(&rig.lines[0].source);
        (void)pass(5000);
        assert_true(fathom_posix_now_us() - begin_us < LONG_US);
    }
    while (have < total) {
        have += posix_pty_receive(&rig.ptys[0], got, sizeof got);
        fathom_loop_step(&rig.loop, 1000);
        assert_true(fathom_posix_now_us() - begin_us < LONG_US);
    }
    (void)pass(1000);
    assert_int_equal(rig.lines[0].source.events, POLLIN);
}

TEST(a_line_that_is_added_twice_is_refused)
{
    posix_pty_open(&rig.ptys[0]);
    line_rig_add(9600);
    const fathom_line_settings_t settings = {9600, FATHOM_PARITY_NONE, 1};
    assert_int_equal(fathom_loop_add_line(&rig.loop, &rig.lines[0], rig.ptys[0].path, &settings),
                     FATHOM_POSIX_ERR_ARGUMENT);
    assert_true(rig.lines[0].source.is_open);
}

TEST(a_line_that_is_lost_says_why_and_comes_back)
{
    line_rig_end();
    posix_time_begin(false);
    line_rig_begin(&(fathom_loop_config_t){.first_pause_us = 1000, .longest_pause_us = 1000});
    posix_pty_open(&rig.ptys[0]);
    line_rig_add(115200);
    (void)pass(1000);
    const posix_pty_t lost = rig.ptys[0];
    posix_pty_close(&rig.ptys[0]);
    line_rig_until(&rig.port_errors[0], 1);
    assert_non_null(strstr(fathom_loop_error_text(&rig.lines[0].source), lost.path));
    posix_pty_open(&rig.ptys[0]);
    const pid_t far_end = far_end_begin(rig.ptys, 1, 0);
    line_rig_until(&rig.readings[0], 2);
    far_end_end(far_end);
    assert_int_equal(rig.port_errors[0], 1);
    assert_int_equal(rig.errors[0], 0);
}

/* ---- stop, signals, and loops of another kind ---- */

static void on_signal(int number) { fathom_loop_stop(&rig.loop); }
static void on_other_signal(int number) { (void)number; }

static void signal_soon(void (*handler)(int))
{
    struct sigaction action;
    const struct itimerval soon = {{0, SOON_US}, {0, SOON_US}}; /* again and again: one comes in the sleep */
    memset(&action, 0, sizeof action);
    action.sa_handler = handler;
    action.sa_flags = SA_RESTART; /* even so */
    assert_int_equal(sigaction(SIGALRM, &action, NULL), 0);
    assert_int_equal(setitimer(ITIMER_REAL, &soon, NULL), 0);
}

static void no_more_signals(void)
{
    const struct itimerval never = {{0, 0}, {0, 0}};
    assert_int_equal(setitimer(ITIMER_REAL, &never, NULL), 0);
    (void)signal(SIGALRM, SIG_DFL);
    posix_start_watchdog(0);
}

/* Nothing is on the loop, so it sleeps until it is stopped. */
TEST(a_signal_handler_stops_the_run)
{
    signal_soon(on_signal);
    do fathom_loop_run(&rig.loop);
    while (rig.loop.sleeps == 0); /* a busy machine may stop the loop before it sleeps, but not every time */
    no_more_signals();
    assert_in_range(rig.loop.sleeps, 1, 10);
}

/* An eventfd that is full refuses (eventfd(2): EAGAIN); what a signal handler calls leaves errno alone. */
TEST(a_stop_leaves_errno_alone)
{
    assert_int_equal(eventfd_write(rig.loop.stop_fd, UINT64_MAX - 1), 0);
    errno = 300;
    fathom_loop_stop(&rig.loop);
    assert_int_equal(errno, 300);
    fathom_loop_run(&rig.loop);
    assert_int_equal(rig.loop.sleeps, 0);
}

TEST(a_signal_ends_the_sleep_of_a_step)
{
    posix_time_begin(false);
    signal_soon(on_other_signal);
    const uint64_t begin_us = fathom_posix_now_us();
    fathom_loop_step(&rig.loop, FATHOM_NO_DEADLINE);
    assert_true(fathom_posix_now_us() - begin_us < LONG_US);
    no_more_signals();
}

static void *stop_soon(void *arg)
{
    (void)poll(NULL, 0, SOON_US / 1000);
    fathom_loop_stop(arg);
    return NULL;
}

TEST(another_thread_stops_the_run_again_and_again)
{
    for (unsigned i = 0; i < 3 || rig.loop.sleeps == 0; i++) {
        pthread_t thread;
        assert_int_equal(pthread_create(&thread, NULL, stop_soon, &rig.loop), 0);
        fathom_loop_run(&rig.loop);
        assert_int_equal(pthread_join(thread, NULL), 0);
        assert_true(rig.loop.sleeps <= 3 * (i + 1));
    }
}

TEST(a_loop_of_another_kind_sees_when_a_step_has_something_to_do)
{
    add_pin(&pin, &first, ends[0]);
    first.due_us = 500000;
    (void)pass(1000);
    assert_false(is_ready());
    assert_int_equal(fathom_loop_due_us(&rig.loop), 500000 - 1000);
    send_bytes(1);
    assert_true(is_ready());
    fathom_loop_step(&rig.loop, 0);
    assert_int_equal(first.polls, 2);
    assert_false(is_ready());
}

TEST(a_stop_wakes_a_loop_of_another_kind_once)
{
    fathom_loop_stop(&rig.loop);
    assert_true(is_ready());
    fathom_loop_step(&rig.loop, FATHOM_NO_DEADLINE); /* does not sleep */
    assert_false(is_ready());
}

TEST(an_idle_loop_sleeps)
{
    add_pin(&pin, &first, ends[0]);
    (void)pass(1000);
    assert_int_equal(pass(200000), 1);
}

TEST(a_pin_that_is_added_twice_is_there_once)
{
    add_pin(&pin, &first, ends[0]);
    fathom_loop_add_pin(&rig.loop, &pin, ends[0]);
    (void)pass(SOON_US);
    assert_int_equal(first.polls, 1);
}
