/* SPDX-License-Identifier: MIT */
/* The clock against another counter of the board, across its wrap, and the sleep. */
#include "check.h"
#include "fathom_mps2.h"
#include "start.h"

#define SYST_CSR (*(volatile uint32_t *)0xE000E010u)
#define SYST_RVR (*(volatile uint32_t *)0xE000E014u)
#define SYST_CVR (*(volatile uint32_t *)0xE000E018u)
#define COUNTER  (*(volatile uint32_t *)0x40028018u)

enum { SYST_BITS = 0xFFFFFF };

void timer0_interrupt(void) { fathom_mps2_timer0_interrupt(); }

static uint32_t now_us(void) { return fathom_mps2_clock.now_us(fathom_mps2_clock.ctx); }

/* Counts of SysTick, 40 ns each, in so many us; it counts down. */
static uint32_t ticks_in_us(uint32_t length_us)
{
    const uint32_t since_us = now_us();
    const uint32_t since = SYST_CVR;
    while (fathom_elapsed_us(now_us(), since_us) < length_us) {
    }
    return (since - SYST_CVR) & SYST_BITS;
}

static uint32_t slept_us(uint32_t max_us)
{
    fathom_mps2_idle_t nobody = {0, 0};
    const uint32_t since_us = now_us();
    fathom_mps2_idle(&nobody, max_us);
    return fathom_elapsed_us(now_us(), since_us);
}

int main(void)
{
    fathom_mps2_clock_begin();
    SYST_RVR = SYST_BITS;
    SYST_CVR = 0;
    SYST_CSR = 5; /* the clock of the core, on, no interrupt */
    check_within(now_us(), 0, 1000, "the clock begins at 0");
    check_within(ticks_in_us(100000), 2495000, 2505000, "100 ms by the clock are 100 ms by SysTick");
    COUNTER = UINT32_MAX - 50000;
    check_within(ticks_in_us(100000), 2495000, 2505000, "100 ms are 100 ms across the wrap");
    check_within(now_us(), 49999, 60000, "after which the clock has begun anew");
    check_within(slept_us(20000), 20000, 20100, "a sleep of 20 ms takes 20 ms");
    check_within(slept_us(1), 1, 100, "a sleep of 1 us takes not much more");
    COUNTER = UINT32_MAX - 5000;
    check_within(slept_us(20000), 20000, 20100, "a sleep of 20 ms takes 20 ms across the wrap");
    check_within(slept_us(0), 0, 20, "no time is no sleep");
    return check_result();
}
