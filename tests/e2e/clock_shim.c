/* SPDX-License-Identifier: MIT */
/*
 * A monotonic clock for test_clock.py, to be preloaded. When the program first looks, its lower 32 bits of
 * microseconds are WRAP_IN_US from their wrap; JUMP_IN_US later it has gained three times 2^32 us, which is
 * not to be seen in 32 bits.
 */
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
    if (result != 0 || clock != CLOCK_MONOTONIC) return (int)result;
    const uint64_t real_us = (uint64_t)now->tv_sec * 1000000u + (uint64_t)now->tv_nsec / 1000u;
    const char *const wrap = getenv("WRAP_IN_US");
    const char *const jump = getenv("JUMP_IN_US");
    if (first_us == 0) first_us = real_us;
    uint64_t us = (UINT64_C(7) << 32) - strtoull(wrap != NULL ? wrap : "0", NULL, 10) + (real_us - first_us);
    if (jump != NULL && real_us - first_us > strtoull(jump, NULL, 10)) us += UINT64_C(3) << 32;
    now->tv_sec = (time_t)(us / 1000000u);
    now->tv_nsec = (long)(us % 1000000u) * 1000;
    return 0;
}
