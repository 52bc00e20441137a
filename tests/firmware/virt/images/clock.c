/* SPDX-License-Identifier: MIT */
/* The clock against another one of the board, across its wrap, and the sleep. */
#include "check.h"
#include "fathom_virt.h"
#include "start.h"

#define MTIME ((volatile uint32_t *)0x0200BFF8u)
/* ns, of which it latches the high half; wraps after 4.3 s */
static const counter_t rtc_low = {(volatile uint32_t *)0x00101000u, UINT32_MAX, false};

void timer_interrupt(void) { fathom_virt_timer_interrupt(); }

static uint32_t now_us(void) { return fathom_virt_clock.now_us(fathom_virt_clock.ctx); }

static uint32_t ns_in_100_ms(void) { return counted_in_us(&rtc_low, &fathom_virt_clock, 100000); }

static uint32_t slept(uint32_t max_us) { return slept_us(&fathom_virt_clock, fathom_virt_idle, 0, max_us); }

static void set_mtime(uint64_t ticks)
{
    MTIME[1] = (uint32_t)(ticks >> 32);
    MTIME[0] = (uint32_t)ticks;
}

/* A reading of the low half before it wraps and of the high half behind it, or the other way round, is off by 429
 * seconds. In simulated time the wrap comes upon other instructions in each round. */
static bool is_steady(void)
{
    for (uint32_t early = 20; early != 148; early++) {
        set_mtime(0x100000000 - early);
        uint32_t last_us = now_us();
        for (int i = 0; i != 50; i++) {
            const uint32_t us = now_us();
            if (fathom_elapsed_us(us, last_us) > 100) return false;
            last_us = us;
        }
    }
    return true;
}

int main(void)
{
    /* 2^32 us are 42949672960 ticks of 100 ns. */
    const uint64_t wrap = 42949672960;
    check(fathom_virt_us(0) == 0 && fathom_virt_us(10) == 1, "10 ticks are 1 us");
    check(fathom_virt_us(0xFFFFFFFF) == 429496729, "the end of the low half of mtime is in the 430th second");
    check(fathom_virt_us(0x100000000) == 429496729, "where the clock goes on");
    check(fathom_virt_us(wrap - 1) == 0xFFFFFFFF, "2^32 us less one tick are 4294967295 us");
    check(fathom_virt_us(wrap) == 0, "2^32 us are 0");
    check(fathom_virt_us(wrap * 3 + 70) == 7, "and each 2^32 more are");

    check_within(ns_in_100_ms(), 99900000, 100100000, "100 ms by the clock are 100 ms by the RTC");
    set_mtime(0x100000000 - 500000);
    check_within(ns_in_100_ms(), 99900000, 100100000, "100 ms are 100 ms across the low half of mtime");
    check_within(now_us(), 429496729 + 49900, 429496729 + 60000, "which is no wrap of the clock");
    check(is_steady(), "no reading jumps while the low half wraps");
    set_mtime(wrap - 500000);
    check_within(ns_in_100_ms(), 99900000, 100100000, "100 ms are 100 ms across the wrap");
    check_within(now_us(), 49999, 60000, "after which the clock has begun anew");

    check_within(slept(20000), 20000, 20100, "a sleep of 20 ms takes 20 ms");
    check_within(slept(1), 1, 100, "a sleep of 1 us takes not much more");
    set_mtime(0x100000000 - 50000);
    check_within(slept(20000), 20000, 20100, "a sleep of 20 ms takes 20 ms across the low half of mtime");
    check_within(slept(0), 0, 20, "no time is no sleep");
    return check_result();
}
