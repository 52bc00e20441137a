/* SPDX-License-Identifier: MIT */
/* A calendar for test_rows.py, to be preloaded: MIDNIGHT_IN_US after the first look it is midnight in UTC, of
 * 2026-03-01. */
#define _GNU_SOURCE 1
#include <stdint.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

int clock_gettime(clockid_t clock, struct timespec *now)
{
    static uint64_t first_us;
    const long result = syscall(SYS_clock_gettime, clock, now);
    if (result != 0 || clock != CLOCK_REALTIME) return (int)result;
    const uint64_t real_us = (uint64_t)now->tv_sec * 1000000u + (uint64_t)now->tv_nsec / 1000u;
    if (first_us == 0) first_us = real_us;
    /* date -u -d 2026-03-01 +%s */
    const uint64_t us =
        UINT64_C(1772323200000000) - strtoull(getenv("MIDNIGHT_IN_US"), NULL, 10) + (real_us - first_us);
    now->tv_sec = (time_t)(us / 1000000u);
    now->tv_nsec = (long)(us % 1000000u) * 1000;
    return 0;
}
