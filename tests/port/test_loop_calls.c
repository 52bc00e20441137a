/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "loop_fake.h"
#include "loop_line_rig.h"
#include "posix_time.h"

/* The system calls of fathom_loop.h. The tests count calls, and read the time that a sleep requests; they measure no time.
 * Tests in which a far end responds use the real clock, with a time-out of 1 s; the others use a simulated clock. */

typedef struct {
    unsigned reads, empty_reads, writes, ioctls, opens;
    int control_error;      /* of epoll_ctl */
    unsigned adds, changes; /* of it: calls with EPOLL_CTL_ADD, and EPOLL_CTL_MOD */
    size_t write_most;      /* bytes that one write takes; 0: all */
} calls_t;

static calls_t calls;

/* NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): the linker gives these names */
ssize_t __real_read(int fd, void *bytes, size_t length);
ssize_t __wrap_read(int fd, void *bytes, size_t length);
ssize_t __real_write(int fd, const void *bytes, size_t length);
ssize_t __wrap_write(int fd, const void *bytes, size_t length);
int __real_ioctl(int fd, unsigned long request, ...);
int __wrap_ioctl(int fd, unsigned long request, ...);
int __real_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...);

int __real_epoll_ctl(int epoll, int operation, int fd, struct epoll_event *event);
int __wrap_epoll_ctl(int epoll, int operation, int fd, struct epoll_event *event);

ssize_t __wrap_read(int fd, void *bytes, size_t length)
{
    const ssize_t n = __real_read(fd, bytes, length);
    calls.reads++;
    calls.empty_reads += n <= 0;
    return n;
}

ssize_t __wrap_write(int fd, const void *bytes, size_t length)
{
    calls.writes++;
    posix_time.is_first = true;
    return __real_write(fd, bytes,
                        calls.write_most != 0 && length > calls.write_most ? calls.write_most : length);
}

int __wrap_ioctl(int fd, unsigned long request, ...)
{
    va_list arguments;
    va_start(arguments, request);
    void *const out = va_arg(arguments, void *);
    va_end(arguments);
    calls.ioctls++;
    return __real_ioctl(fd, request, out);
}

int __wrap_open(const char *path, int flags, ...)
{
    calls.opens++;
    return __real_open(path, flags);
}

int __wrap_epoll_ctl(int epoll, int operation, int fd, struct epoll_event *event)
{
    calls.adds += operation == EPOLL_CTL_ADD;
    calls.changes += operation == EPOLL_CTL_MOD;
    if (calls.control_error == 0) return __real_epoll_ctl(epoll, operation, fd, event);
    errno = calls.control_error;
    return -1;
}
/* NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming) */

static pid_t far_end;

/* Counts from now on. */
static void count_calls(void)
{
    memset(&calls, 0, sizeof calls);
    posix_time.epoll_count = posix_time.ppoll_count = 0;
    posix_time.longest_first_us = 0;
}

static int set_up(void **state)
{
    posix_start_watchdog(0);
    posix_time_begin(false);
    count_calls();
    line_rig_begin(NULL);
    return 0;
}

static int tear_down(void **state)
{
    if (far_end > 0) far_end_end(far_end);
    far_end = 0;
    line_rig_end();
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = tear_down};

/* So many lines, that answer after so long. */
static void begin_late(unsigned count, uint32_t baud, unsigned late_ms)
{
    for (unsigned i = 0; i != count; i++) posix_pty_open(&rig.ptys[i]);
    far_end = far_end_begin(rig.ptys, count, late_ms);
    for (unsigned i = 0; i != count; i++) line_rig_add(baud);
}
static void begin(unsigned count, uint32_t baud) { begin_late(count, baud, 0); }

static unsigned total(const unsigned *counts)
{
    unsigned sum = 0;
    for (unsigned i = 0; i != rig.count; i++) sum += counts[i];
    return sum;
}

/* The responses come whole, 13 bytes in one write. A response brings a reading, or the last one is on its way: one more a
 * line. A request is a write, a response a read, whether it has left is asked once; it sleeps for the silence before the
 * request (or the pace), for the end of the request, and for the response. The clock runs in the sleeps alone, since a
 * loop that a busy machine wakes more than a millisecond late reads once more. */
TEST(eight_lines_ask_the_system_for_what_is_there_and_nothing_else)
{
    posix_time_stop();
    posix_time.waits = true;
    begin(8, 115200);
    line_rig_until(&rig.readings[0], 1); /* all is as it stays */
    line_rig_until(&rig.readings[7], 2);
    count_calls();
    const unsigned before = total(rig.readings);
    line_rig_until(&rig.readings[0], 40);
    const unsigned transactions = total(rig.readings) - before;
    assert_true(transactions > 8 * 30);
    assert_int_equal(total(rig.errors) + total(rig.port_errors), 0);
    assert_int_equal(calls.empty_reads, 0);
    assert_in_range(calls.reads, transactions, transactions + 8);
    assert_in_range(calls.writes, transactions - 8, transactions + 8);
    assert_in_range(calls.ioctls, 0, transactions + 8); /* a response may come while the request leaves */
    assert_in_range(posix_time.epoll_count, 1, 4 * transactions);
}

/* What was waiting before the descriptor was watched is looked for once. */
TEST(a_line_that_has_nothing_to_say_is_read_once)
{
    posix_time_stop();
    posix_pty_open(&rig.ptys[0]);
    line_rig_add(115200);
    count_calls();
    for (unsigned i = 0; i != 50; i++) fathom_loop_step(&rig.loop, 10000);
    assert_in_range(calls.reads, 1, 1);
    assert_int_equal(calls.writes, 1);
}

/* fathom_posix.h: leaves_in_us. At 1200 baud the 80 bits of a request leave for 66.7 ms; the response comes after 100 ms.
 * The loop sleeps three times a request: for the silence before it, for its end, and for the response. If the port does
 * not know when the request ends, each sleep requests at most 1 ms. If a busy machine wakes the loop late, the loop sleeps
 * less often, and the first sleep after a write requests less; so requests go on until one has requested most of its time.
 */
TEST(the_loop_wakes_once_for_the_end_of_a_request)
{
    begin_late(1, 1200, 100);
    line_rig_until(&rig.readings[0], 1);
    count_calls();
    unsigned requests = 0;
    while (requests < 4 || posix_time.longest_first_us < 50000) {
        assert_in_range(++requests, 1, 100);
        while (rig.readings[0] != 1 + requests) fathom_loop_step(&rig.loop, FATHOM_NO_DEADLINE);
    }
    assert_in_range(posix_time.epoll_count, requests, requests * 3 + 1);
    assert_in_range(calls.ioctls, 1, requests + 1);
    assert_in_range(posix_time.longest_first_us, 50000, 67000);
    rig.lines[0].bus.uart.leaves_in_us = NULL;
    line_rig_until(&rig.readings[0], rig.readings[0] + 1);
    count_calls();
    line_rig_until(&rig.readings[0], rig.readings[0] + 2);
    assert_true(calls.writes > 0);
    assert_in_range(posix_time.longest_first_us, 1, 1000);
    assert_int_equal(rig.errors[0], 0);
}

/* The pauses are a hundredth of the default ones: 5 ms, up to 80 ms. Within 800 ms the loop tries to open the port at 5, 15,
 * 35, 75 and 155 ms and every 80 ms from then on, at 235 to 795 ms: 13 times. It sleeps once for each, and once until the
 * test's own limit. */
TEST(a_lost_port_costs_a_sleep_and_an_open_a_pause)
{
    line_rig_end();
    posix_time_stop();
    line_rig_begin(&(fathom_loop_config_t){.first_pause_us = 5000, .longest_pause_us = 80000});
    posix_pty_open(&rig.ptys[0]);
    line_rig_add(115200);
    fathom_loop_step(&rig.loop, 1000);
    posix_pty_close(&rig.ptys[0]);
    line_rig_until(&rig.failed, 1);
    count_calls();
    const uint64_t until_us = fathom_posix_now_us() + 800000;
    for (uint64_t now_us; (now_us = fathom_posix_now_us()) < until_us;)
        fathom_loop_step(&rig.loop, (uint32_t)(until_us - now_us));
    assert_int_equal(calls.opens, 13);
    assert_int_equal(posix_time.epoll_count, 13 + 1);
    assert_int_equal(calls.reads + calls.writes + calls.ioctls, 0);
    assert_int_equal(rig.failed, 1 + calls.opens);
    assert_int_equal(rig.port_errors[0], 1);
}

/* Linux before 5.11 says ENOSYS, a sandbox that does not know it EPERM. */
static void sleeps_without_pwait2(void **state)
{
    posix_time.epoll_error = *(const int *)*state;
    begin(2, 115200);
    line_rig_until(&rig.readings[0], 5);
    line_rig_until(&rig.readings[1], 5);
    assert_int_equal(posix_time.epoll_count, 1);
    assert_true(rig.loop.has_no_pwait2);
    assert_in_range(rig.loop.sleeps, 1, 300); /* it does not spin */
    assert_int_equal(total(rig.errors), 0);
}
static int no_such_call = ENOSYS, not_allowed = EPERM;
TEST_ROW(a_kernel_without_epoll_pwait2_will_do, sleeps_without_pwait2, &no_such_call)
TEST_ROW(a_sandbox_that_refuses_epoll_pwait2_will_do, sleeps_without_pwait2, &not_allowed)

/* Signals end all of these at once. */
static void expect_limits(void)
{
    static const struct {
        uint32_t max_us;
        int64_t seconds, nanoseconds;
    } rows[] = {{1, 0, 1000},    {999999, 0, 999999000}, {1000000, 1, 0},
                {2000000, 2, 0}, {7000003, 7, 3000},     {4294967294u, 4294, 967294000}};
    for (unsigned i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        fathom_loop_step(&rig.loop, rows[i].max_us);
        assert_false(posix_time.is_endless);
        assert_int_equal(posix_time.seconds, rows[i].seconds);
        assert_int_equal(posix_time.nanoseconds, rows[i].nanoseconds);
    }
    fathom_loop_step(&rig.loop, FATHOM_NO_DEADLINE);
    assert_true(posix_time.is_endless);
    assert_int_equal(rig.loop.sleeps, sizeof rows / sizeof rows[0] + 1);
}

TEST(a_sleep_is_requested_to_the_microsecond_with_epoll_pwait2)
{
    posix_time.epoll_error = EINTR;
    expect_limits();
    assert_false(rig.loop.has_no_pwait2); /* a signal is not what that is about */
    assert_int_equal(posix_time.epoll_count, rig.loop.sleeps);
}

TEST(a_sleep_is_requested_to_the_microsecond_without_it)
{
    posix_time.epoll_error = ENOSYS;
    posix_time.ppoll_error = EINTR;
    expect_limits();
    assert_true(rig.loop.has_no_pwait2);
    assert_int_equal(posix_time.ppoll_count, rig.loop.sleeps);
}

/* 64 are what one sleep tells of; the others come with the next one. */
static void more_than_a_sleep_tells_of(void **state)
{
    static fake_source_t sources[100];
    posix_time.epoll_error = *(const int *)*state;
    for (unsigned i = 0; i != 100; i++) {
        fake_source(&sources[i]);
        sources[i].due_us = FATHOM_NO_DEADLINE;
        sources[i].fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
        fathom_loop_add(&rig.loop, &sources[i].source);
    }
    fathom_loop_step(&rig.loop, 0);
    for (unsigned i = 0; i != 100; i++) {
        assert_int_equal(sources[i].polls, 1);
        assert_int_equal(eventfd_write(sources[i].fd, 1), 0);
    }
    fathom_loop_step(&rig.loop, 0);
    fathom_loop_step(&rig.loop, 0);
    for (unsigned i = 0; i != 100; i++) {
        assert_int_equal(sources[i].polls, 2);
        fathom_loop_remove(&sources[i].source);
        (void)close(sources[i].fd);
    }
}
static int no_error;
TEST_ROW(a_hundred_that_are_ready_at_once_are_all_polled, more_than_a_sleep_tells_of, &no_error)
TEST_ROW(a_hundred_are_so_without_epoll_pwait2_too, more_than_a_sleep_tells_of, &no_such_call)

/* Each loss is of another pseudo terminal. */
TEST(a_line_that_is_lost_says_why_and_comes_back_and_a_thousand_losses_leave_no_descriptor)
{
    line_rig_end();
    line_rig_begin(&(fathom_loop_config_t){.first_pause_us = 1, .longest_pause_us = 1});
    posix_pty_open(&rig.ptys[0]);
    line_rig_add(115200);
    line_rig_until(&rig.opened, 1);
    const unsigned before = posix_count_fds();
    for (unsigned n = 1; n != 1001; n++) {
        const posix_pty_t lost = rig.ptys[0];
        posix_pty_close(&rig.ptys[0]);
        line_rig_until(&rig.port_errors[0], n);
        assert_non_null(strstr(fathom_loop_error_text(&rig.lines[0].source), lost.path));
        posix_pty_open(&rig.ptys[0]); /* whose path is in the same place */
        line_rig_until(&rig.opened, n + 1);
        assert_string_equal(fathom_loop_error_text(&rig.lines[0].source), "");
    }
    assert_int_equal(posix_count_fds(), before);
    far_end = far_end_begin(rig.ptys, 1, 0);
    line_rig_until(&rig.readings[0], 2);
    assert_int_equal(rig.port_errors[0], 1000);
    assert_int_equal(rig.errors[0], 0);
}

TEST(a_loop_that_cannot_watch_its_own_end_is_an_error_and_leaves_no_descriptor)
{
    fathom_loop_t loop;
    const unsigned before = posix_count_fds();
    calls.control_error = ENOMEM;
    assert_int_equal(fathom_loop_init(&loop, NULL), FATHOM_POSIX_ERR_SYSTEM);
    calls.control_error = 0;
    assert_int_equal(posix_count_fds(), before);
}

/* A descriptor that epoll refuses is none of its own: it may be another source's, which a change would take away. */
static void leaves_in_parts(void **state)
{
    uint8_t request[8];
    calls.control_error = *(const int *)*state;
    calls.write_most = 1; /* so that it waits for room too */
    posix_pty_open(&rig.ptys[0]);
    line_rig_add(115200);
    while (calls.writes < sizeof request) fathom_loop_step(&rig.loop, 10000);
    assert_true(calls.adds > 0);
    assert_int_equal(calls.changes > 0, calls.control_error == 0);
    fathom_loop_step(&rig.loop, 10000);
    assert_int_equal(rig.lines[0].source.events, POLLIN); /* all of it has left */
    posix_pty_receive_all(&rig.ptys[0], request, sizeof request);
}

TEST_ROW(a_line_whose_request_leaves_in_parts_waits_for_room, leaves_in_parts, &no_error)
TEST_ROW(a_line_that_epoll_does_not_wait_for_is_never_changed_there, leaves_in_parts, &not_allowed)

/* 0, 1, 2 and the two of the loop are what others have; each init takes two, and gives them back. */
TEST(init_and_deinit_leave_no_descriptor_behind)
{
    fathom_loop_t loop;
    const unsigned before = posix_count_fds();
    for (unsigned n = 0; n != 100; n++) {
        assert_int_equal(fathom_loop_init(&loop, NULL), FATHOM_POSIX_OK);
        assert_int_equal(posix_count_fds(), before + 2);
        fathom_loop_deinit(&loop);
        assert_int_equal(posix_count_fds(), before);
    }
}
