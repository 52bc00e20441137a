/* SPDX-License-Identifier: MIT */
/* The clock against another counter of the board, across its wrap, and the sleep. */
#include "check.h"
#include "fathom_mps2.h"
#include "start.h"

#define COUNTER (*(volatile uint32_t *)0x40028018u)

void timer0_interrupt(void) { fathom_mps2_timer0_interrupt(); }

static uint32_t now_us(void) { return fathom_mps2_clock.now_us(fathom_mps2_clock.ctx); }

/* Counts of SysTick, 40 ns each. */
static uint32_t ticks_in_100_ms(void) { return counted_in_us(&systick, &fathom_mps2_clock, 100000); }

static uint32_t slept(uint32_t max_us)
{
    fathom_mps2_idle_t no_wake = {0, 0};
    return slept_us(&fathom_mps2_clock, fathom_mps2_idle, &no_wake, max_us);
}

int main(void)
{
    fathom_mps2_clock_begin();
    systick_begin();
    check_within(now_us(), 0, 1000, "the clock begins at 0");
    check_within(ticks_in_100_ms(), 2495000, 2505000, "100 ms by the clock are 100 ms by SysTick");
    COUNTER = UINT32_MAX - 50000;
    check_within(ticks_in_100_ms(), 2495000, 2505000, "100 ms are 100 ms across the wrap");
    check_within(now_us(), 49999, 60000, "after which the clock has begun anew");
    check_within(slept(20000), 20000, 20100, "a sleep of 20 ms takes 20 ms");
    check_within(slept(1), 1, 100, "a sleep of 1 us takes not much more");
    COUNTER = UINT32_MAX - 5000;
    check_within(slept(20000), 20000, 20100, "a sleep of 20 ms takes 20 ms across the wrap");
    check_within(slept(0), 0, 20, "no time is no sleep");
    return check_result();
}
