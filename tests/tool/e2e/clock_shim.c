/* SPDX-License-Identifier: MIT */
/*
 * Clocks for test_clock.py and test_rows.py, to be preloaded. The monotonic one: when the program first looks, its
 * lower 32 bits of microseconds are WRAP_IN_US from their wrap; JUMP_IN_US later it has gained three times 2^32 us, which
 * is not to be seen in 32 bits. The calendar, with MIDNIGHT_IN_US: so long after the first look it is midnight in UTC, of
 * 2026-03-01.
 */
#define _GNU_SOURCE 1
#include <stdint.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

static uint64_t number_of(const char *name)
{
    const char *const text = getenv(name);
    return text != NULL ? strtoull(text, NULL, 10) : 0;
}

static uint64_t monotonic_us(uint64_t real_us)
{
    static uint64_t first_us;
    if (first_us == 0) first_us = real_us;
    uint64_t us = (UINT64_C(7) << 32) - number_of("WRAP_IN_US") + (real_us - first_us);
    if (getenv("JUMP_IN_US") != NULL && real_us - first_us > number_of("JUMP_IN_US")) us += UINT64_C(3) << 32;
    return us;
}

static uint64_t calendar_us(uint64_t real_us)
{
    static uint64_t first_us;
    if (first_us == 0) first_us = real_us;
    /* date -u -d 2026-03-01 +%s */
    return UINT64_C(1772323200000000) - number_of("MIDNIGHT_IN_US") + (real_us - first_us);
}

int clock_gettime(clockid_t clock, struct timespec *now)
{
    const long result = syscall(SYS_clock_gettime, clock, now);
    const int is_calendar = clock == CLOCK_REALTIME && getenv("MIDNIGHT_IN_US") != NULL;
    if (result != 0 || (clock != CLOCK_MONOTONIC && !is_calendar)) return (int)result;
    const uint64_t real_us = (uint64_t)now->tv_sec * 1000000u + (uint64_t)now->tv_nsec / 1000u;
    const uint64_t us = is_calendar ? calendar_us(real_us) : monotonic_us(real_us);
    now->tv_sec = (time_t)(us / 1000000u);
    now->tv_nsec = (long)(us % 1000000u) * 1000;
    return 0;
}
