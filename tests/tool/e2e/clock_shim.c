/* SPDX-License-Identifier: MIT */
/* Clocks, to be preloaded. With MIDNIGHT_IN_US it is midnight in UTC, of 2026-03-01, so long after the first look. With
 * UNSET_WHILE it is 1970 at the first look, and right as soon as the file of this name is deleted. With LATER_IF, as soon
 * as the file of this name exists, 600 s have passed. */
#define _GNU_SOURCE 1
#include <stdint.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

int clock_gettime(clockid_t clock, struct timespec *now)
{
    static uint64_t first_us;
    const char *const unset_while = getenv("UNSET_WHILE");
    const long result = syscall(SYS_clock_gettime, clock, now);
    const char *const later_if = getenv("LATER_IF");
    if (later_if != NULL) {
        if (clock == CLOCK_MONOTONIC && access(later_if, F_OK) == 0) now->tv_sec += 600;
        return (int)result;
    }
    if (result != 0 || clock != CLOCK_REALTIME) return (int)result;
    const uint64_t real_us = (uint64_t)now->tv_sec * 1000000u + (uint64_t)now->tv_nsec / 1000u;
    if (first_us == 0) first_us = real_us;
    uint64_t us = real_us - first_us;
    if (unset_while != NULL)
        us = access(unset_while, F_OK) == 0 ? us : real_us;
    else /* date -u -d 2026-03-01 +%s */
        us += UINT64_C(1772323200000000) - strtoull(getenv("MIDNIGHT_IN_US"), NULL, 10);
    now->tv_sec = (time_t)(us / 1000000u);
    now->tv_nsec = (long)(us % 1000000u) * 1000;
    return 0;
}

/* OpenSSL reads this clock. */
time_t time(time_t *to)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_REALTIME, &now);
    if (to != NULL) *to = now.tv_sec;
    return now.tv_sec;
}
