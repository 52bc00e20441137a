/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* ppoll, syscall */
#include "posix_time.h"

#include <errno.h>
#include <linux/time_types.h>
#include <poll.h>
#include <stdarg.h>
#include <sys/epoll.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include "fathom_posix.h"
#include "suite.h"

enum { SIXTH = 6 };

/* NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): the linker gives these names */
int __real_clock_gettime(clockid_t clock, struct timespec *time);
int __wrap_clock_gettime(clockid_t clock, struct timespec *time);
int __real_ppoll(struct pollfd *entries, nfds_t count, const struct timespec *limit, const sigset_t *mask);
int __wrap_ppoll(struct pollfd *entries, nfds_t count, const struct timespec *limit, const sigset_t *mask);
long __real_syscall(long number, ...);
long __wrap_syscall(long number, ...);

posix_time_t posix_time;

static void note(bool is_endless, int64_t seconds, int64_t nanoseconds)
{
    posix_time.is_endless = is_endless;
    posix_time.seconds = seconds;
    posix_time.nanoseconds = nanoseconds;
    if (!posix_time.is_first || is_endless) return;
    posix_time.is_first = false;
    const int64_t us = seconds * 1000000 + nanoseconds / 1000;
    if (us > posix_time.longest_first_us) posix_time.longest_first_us = us;
}

/* Ends a simulated sleep in which nothing became ready. */
static void pass_time(void)
{
    posix_time.now_us += (uint64_t)posix_time.seconds * 1000000u + (uint64_t)posix_time.nanoseconds / 1000u;
}

int __wrap_clock_gettime(clockid_t clock, struct timespec *time)
{
    if (!posix_time.is_simulated || clock != CLOCK_MONOTONIC) return __real_clock_gettime(clock, time);
    time->tv_sec = (time_t)(posix_time.now_us / 1000000u);
    time->tv_nsec = (long)(posix_time.now_us % 1000000u) * 1000;
    return 0;
}

int __wrap_ppoll(struct pollfd *entries, nfds_t count, const struct timespec *limit, const sigset_t *mask)
{
    static const struct timespec none;
    assert_int_equal(count, 1);
    posix_time.ppoll_count++;
    note(limit == NULL, limit != NULL ? limit->tv_sec : 0, limit != NULL ? limit->tv_nsec : 0);
    if (posix_time.ppoll_error != 0) {
        errno = posix_time.ppoll_error;
        return -1;
    }
    if (!posix_time.is_simulated || limit == NULL) return __real_ppoll(entries, count, limit, mask);
    const int ready = __real_ppoll(entries, count, posix_time.waits ? limit : &none, mask);
    if (ready == 0) pass_time();
    return ready;
}

long __wrap_syscall(long number, ...)
{
    static const struct __kernel_timespec none;
    long a[SIXTH];
    va_list arguments;
    va_start(arguments, number);
    for (unsigned i = 0; i != SIXTH; i++) a[i] = va_arg(arguments, long);
    va_end(arguments);
    assert_int_equal(number, SYS_epoll_pwait2);
    posix_time.epoll_count++;
    const struct __kernel_timespec *const limit = (const void *)a[3];
    note(limit == NULL, limit != NULL ? limit->tv_sec : 0, limit != NULL ? limit->tv_nsec : 0);
    if (posix_time.epoll_error != 0) {
        errno = posix_time.epoll_error;
        return -1;
    }
    if (!posix_time.is_simulated || limit == NULL)
        return __real_syscall(number, a[0], a[1], a[2], a[3], a[4], a[5]);
    const long ready = __real_syscall(number, a[0], a[1], a[2], posix_time.waits ? limit : &none, a[4], a[5]);
    if (ready == 0) pass_time();
    return ready;
}
/* NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming) */

void posix_time_begin(bool is_simulated)
{
    memset(&posix_time, 0, sizeof posix_time);
    posix_time.is_simulated = is_simulated;
    posix_time.now_us = 3600000000u;
}

void posix_time_stop(void)
{
    const uint64_t now_us = fathom_posix_now_us();
    posix_time_begin(true);
    posix_time.now_us = now_us;
}
