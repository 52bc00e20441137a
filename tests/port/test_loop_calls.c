/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* syscall */
#include <errno.h>
#include <fcntl.h>
#include <linux/time_types.h>
#include <poll.h>
#include <stdarg.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "loop_fake.h"
#include "loop_line_rig.h"

/* What fathom_loop.h asks of the system: calls are counted, not times. */

enum { SIXTH = 6 };

typedef struct {
    unsigned reads, empty_reads, writes, ioctls, opens, sleeps;
    int sleep_error;        /* of epoll_pwait2; 0: none */
    int poll_error;         /* of ppoll(2), which takes its place */
    int control_error;      /* of epoll_ctl */
    unsigned adds, changes; /* of it: calls with EPOLL_CTL_ADD, and EPOLL_CTL_MOD */
    size_t write_most;      /* bytes that one write takes; 0: all */
    /* What the last of both was asked for. */
    bool is_endless;
    int64_t seconds, nanoseconds;
    /* The longest limit of a first sleep behind a write. */
    bool has_written;
    int64_t longest_us;
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
long __real_syscall(long number, ...);
long __wrap_syscall(long number, ...);
int __real_ppoll(struct pollfd *entries, nfds_t count, const struct timespec *limit, const sigset_t *mask);
int __wrap_ppoll(struct pollfd *entries, nfds_t count, const struct timespec *limit, const sigset_t *mask);

int __real_epoll_ctl(int epoll, int operation, int fd, struct epoll_event *event);
int __wrap_epoll_ctl(int epoll, int operation, int fd, struct epoll_event *event);

static void asked_for(bool is_endless, int64_t seconds, int64_t nanoseconds)
{
    calls.is_endless = is_endless;
    calls.seconds = seconds;
    calls.nanoseconds = nanoseconds;
    if (!calls.has_written || is_endless) return;
    calls.has_written = false;
    const int64_t us = seconds * 1000000 + nanoseconds / 1000;
    if (us > calls.longest_us) calls.longest_us = us;
}

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
    calls.has_written = true;
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

long __wrap_syscall(long number, ...)
{
    long a[SIXTH];
    va_list arguments;
    va_start(arguments, number);
    for (unsigned i = 0; i != SIXTH; i++) a[i] = va_arg(arguments, long);
    va_end(arguments);
    calls.sleeps++;
    const struct __kernel_timespec *const limit = (const void *)a[3];
    asked_for(limit == NULL, limit != NULL ? limit->tv_sec : 0, limit != NULL ? limit->tv_nsec : 0);
    if (calls.sleep_error != 0) {
        errno = calls.sleep_error;
        return -1;
    }
    return __real_syscall(number, a[0], a[1], a[2], a[3], a[4], a[5]);
}

int __wrap_ppoll(struct pollfd *entries, nfds_t count, const struct timespec *limit, const sigset_t *mask)
{
    assert_int_equal(count, 1);
    asked_for(limit == NULL, limit != NULL ? limit->tv_sec : 0, limit != NULL ? limit->tv_nsec : 0);
    if (calls.poll_error == 0) return __real_ppoll(entries, count, limit, mask);
    errno = calls.poll_error;
    return -1;
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

static int set_up(void **state)
{
    posix_start_watchdog(0);
    memset(&calls, 0, sizeof calls);
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
 * request (or the pace), for the end of the request, and for the response. */
TEST(eight_lines_ask_the_system_for_what_is_there_and_nothing_else)
{
    begin(8, 115200);
    line_rig_until(&rig.readings[0], 1); /* all is as it stays */
    line_rig_until(&rig.readings[7], 2);
    memset(&calls, 0, sizeof calls);
    const unsigned before = total(rig.readings);
    line_rig_until(&rig.readings[0], 40);
    const unsigned transactions = total(rig.readings) - before;
    assert_true(transactions > 8 * 30);
    assert_int_equal(total(rig.errors) + total(rig.port_errors), 0);
    assert_int_equal(calls.empty_reads, 0);
    assert_in_range(calls.reads, transactions, transactions + 8);
    assert_in_range(calls.writes, transactions - 8, transactions + 8);
    assert_in_range(calls.ioctls, 0, transactions + 8); /* a response may come while the request leaves */
    assert_in_range(calls.sleeps, 1, 4 * transactions);
}

/* What was waiting before the descriptor was watched is looked for once. */
TEST(a_line_that_has_nothing_to_say_is_read_once)
{
    posix_pty_open(&rig.ptys[0]);
    line_rig_add(115200);
    memset(&calls, 0, sizeof calls);
    for (unsigned i = 0; i != 50; i++) fathom_loop_step(&rig.loop, 10000);
    assert_in_range(calls.reads, 1, 1);
    assert_int_equal(calls.writes, 1);
}

/* fathom_posix.h: leaves_in_us. At 1200 baud the 80 bits of the request leave for 66.7 ms; the response comes after 100. It
 * sleeps for the silence before the request, the end of the request, and the response; and where the port does not tell
 * when that end is, a millisecond at most. How long is what it asks for: on a busy machine it sleeps longer, less often. */
TEST(the_loop_wakes_once_for_the_end_of_a_request)
{
    begin_late(1, 1200, 100);
    line_rig_until(&rig.readings[0], 1);
    memset(&calls, 0, sizeof calls);
    line_rig_until(&rig.readings[0], 5);
    /* 12; one more for each 100 ms that a busy machine delays a response. Each millisecond: 66 a request. */
    assert_in_range(calls.sleeps, 4, 4 * 3 + 12);
    assert_in_range(calls.ioctls, 1, 4 * 2); /* 4 where no other program delays it */
    assert_in_range(calls.longest_us, 50000, 67000);
    rig.lines[0].uart.leaves_in_us = NULL;
    line_rig_until(&rig.readings[0], 6);
    memset(&calls, 0, sizeof calls);
    line_rig_until(&rig.readings[0], 8);
    assert_true(calls.writes > 0);
    assert_in_range(calls.longest_us, 1, 1000);
    assert_int_equal(calls.empty_reads, 0);
    assert_int_equal(rig.errors[0], 0);
}

/* Pauses a hundredth of the usual ones: 5 ms, up to 80 ms; 800 ms of these are 80 s. open is tried at 5, 15, 35, 75, 155
 * ms and each 80 ms from then on: 13 times; a sleep for each, and for the test's own limit. */
TEST(a_lost_port_costs_a_sleep_and_an_open_a_pause)
{
    line_rig_end();
    line_rig_begin(&(fathom_loop_config_t){.first_pause_us = 5000, .longest_pause_us = 80000});
    posix_pty_open(&rig.ptys[0]);
    line_rig_add(115200);
    fathom_loop_step(&rig.loop, 1000);
    posix_pty_close(&rig.ptys[0]);
    line_rig_until(&rig.failed, 1);
    memset(&calls, 0, sizeof calls);
    const uint64_t until_us = fathom_posix_now_us() + 800000;
    for (uint64_t now_us; (now_us = fathom_posix_now_us()) < until_us;)
        fathom_loop_step(&rig.loop, (uint32_t)(until_us - now_us));
    assert_in_range(calls.opens, 4, 13);
    assert_in_range(calls.sleeps, calls.opens, calls.opens + 3);
    assert_int_equal(calls.reads + calls.writes + calls.ioctls, 0);
    assert_int_equal(rig.failed, 1 + calls.opens);
    assert_int_equal(rig.port_errors[0], 1);
}

/* Linux before 5.11 says ENOSYS, a sandbox that does not know it EPERM. */
static void sleeps_without_pwait2(void **state)
{
    calls.sleep_error = *(const int *)*state;
    begin(2, 115200);
    line_rig_until(&rig.readings[0], 5);
    line_rig_until(&rig.readings[1], 5);
    assert_int_equal(calls.sleeps, 1);
    assert_true(rig.loop.has_no_pwait2);
    assert_in_range(rig.loop.sleeps, 1, 300); /* it does not spin */
    assert_int_equal(total(rig.errors), 0);
}
static int no_such_call = ENOSYS, not_allowed = EPERM;
TEST_ROW(a_kernel_without_epoll_pwait2_will_do, sleeps_without_pwait2, &no_such_call)
TEST_ROW(a_sandbox_that_refuses_epoll_pwait2_will_do, sleeps_without_pwait2, &not_allowed)

TEST(there_too_a_sleep_ends_after_its_time_and_not_before)
{
    calls.sleep_error = ENOSYS;
    uint64_t least_us = UINT64_MAX;
    /* On a busy machine many of them are long. */
    for (unsigned i = 0; i != 1000 && least_us > 900; i++) {
        const uint64_t begin_us = fathom_posix_now_us();
        fathom_loop_step(&rig.loop, 200);
        const uint64_t took_us = fathom_posix_now_us() - begin_us;
        assert_true(took_us >= 200);
        if (took_us < least_us) least_us = took_us;
    }
    assert_in_range(least_us, 200, 900); /* not rounded up to milliseconds */
}

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
        assert_false(calls.is_endless);
        assert_int_equal(calls.seconds, rows[i].seconds);
        assert_int_equal(calls.nanoseconds, rows[i].nanoseconds);
    }
    fathom_loop_step(&rig.loop, FATHOM_NO_DEADLINE);
    assert_true(calls.is_endless);
}

TEST(a_sleep_is_asked_for_to_the_microsecond_with_epoll_pwait2)
{
    calls.sleep_error = EINTR;
    expect_limits();
    assert_false(rig.loop.has_no_pwait2);
}

TEST(a_sleep_is_asked_for_to_the_microsecond_without_it)
{
    calls.sleep_error = ENOSYS;
    calls.poll_error = EINTR;
    expect_limits();
    assert_true(rig.loop.has_no_pwait2);
}

/* A signal is not what has_no_pwait2 is about. */
TEST(an_interrupted_sleep_is_over_and_no_more)
{
    calls.sleep_error = EINTR;
    fathom_loop_step(&rig.loop, 1000000);
    assert_false(rig.loop.has_no_pwait2);
    assert_int_equal(calls.sleeps, 1);
}

/* 64 are what one sleep tells of; the others come with the next one. */
static void more_than_a_sleep_tells_of(void **state)
{
    static fake_source_t sources[100];
    calls.sleep_error = *(const int *)*state;
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
TEST(a_thousand_losses_leave_no_descriptor_behind)
{
    line_rig_end();
    line_rig_begin(&(fathom_loop_config_t){.first_pause_us = 1, .longest_pause_us = 1});
    posix_pty_open(&rig.ptys[0]);
    line_rig_add(115200);
    line_rig_until(&rig.opened, 1);
    const unsigned before = posix_count_fds();
    for (unsigned n = 1; n != 1001; n++) {
        posix_pty_close(&rig.ptys[0]);
        line_rig_until(&rig.port_errors[0], n);
        posix_pty_open(&rig.ptys[0]); /* whose path is in the same place */
        line_rig_until(&rig.opened, n + 1);
        assert_string_equal(fathom_loop_error_text(&rig.lines[0].source), "");
    }
    assert_int_equal(posix_count_fds(), before);
    far_end = far_end_begin(rig.ptys, 1, 0);
    line_rig_until(&rig.readings[0], 1);
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
    calls.control_error = *(const int *)*state;
    calls.write_most = 1; /* so that it waits for room too */
    posix_pty_open(&rig.ptys[0]);
    line_rig_add(115200);
    for (unsigned i = 0; i != 20; i++) fathom_loop_step(&rig.loop, 10000);
    assert_true(calls.writes > 0);
    assert_true(calls.adds > 0);
    assert_int_equal(calls.changes > 0, calls.control_error == 0);
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
