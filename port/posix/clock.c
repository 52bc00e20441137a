/* SPDX-License-Identifier: MIT */
/* The clock of the HAL and of programs, from CLOCK_MONOTONIC. The HAL gets the low 32 bits, programs get all 64. */
#define _DEFAULT_SOURCE 1 /* clock_gettime */
#include "fathom_posix.h"

#include <time.h>

uint64_t fathom_posix_now_us(void)
{
    struct timespec now = {0, 0};
    /* This cannot fail: Linux has this clock since 2.6, and the pointer is valid. */
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

static uint32_t now_us(void *ctx)
{
    (void)ctx;
    return (uint32_t)fathom_posix_now_us();
}

fathom_clock_t fathom_posix_clock(void)
{
    const fathom_clock_t clock = {now_us, NULL};
    return clock;
}
