/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_POSIX_TIME_H
#define FATHOM_TESTS_POSIX_TIME_H

#include <stdbool.h>
#include <stdint.h>

/*
 * The time that the port under test sees, and the sleeps that it requests. Link with -Wl,--wrap= each of clock_gettime,
 * ppoll and syscall, which is here only epoll_pwait2(2).
 *
 * A simulated clock stands still. A sleep that a ready descriptor ends takes no time. A sleep that nothing ends moves the
 * clock on by the time that was requested, and returns at once. So the tests are exact and a busy machine changes nothing.
 * If a test waits for another process, a thread or a signal, it uses the real clock, or a simulated one with `waits`: the
 * sleeps last, and the clock moves as described. So it never runs ahead of the process, and the test is exact too.
 */
typedef struct {
    bool is_simulated, waits;
    uint64_t now_us;                   /* the simulated clock */
    unsigned epoll_count, ppoll_count; /* calls */
    int epoll_error, ppoll_error;      /* errno of each call; 0: the call succeeds */
    /* The time that the last call requested. */
    bool is_endless;
    int64_t seconds, nanoseconds;
    /* The longest time that a call requested while is_first was set, in microseconds. The call clears is_first. */
    bool is_first;
    int64_t longest_first_us;
} posix_time_t;

extern posix_time_t posix_time;

/* Clears posix_time. The clock is the real one, or a simulated one that starts at an hour. */
void posix_time_begin(bool is_simulated);

/* Changes to a simulated clock that starts at the time that it is. */
void posix_time_stop(void);

#endif
