/* SPDX-License-Identifier: MIT */
/* The clock against SysTick, across its wrap, and the sleep. */
#include "board.h"
#include "check.h"
#include "fathom_stm32f4.h"
#include "start.h"

#define TIM2_CNT (*(volatile uint32_t *)0x40000024u)

void tim5_interrupt(void) { fathom_stm32f4_tim5_interrupt(); }
void usart2_interrupt(void) {}

static uint32_t now_us(void) { return fathom_stm32f4_clock.now_us(fathom_stm32f4_clock.ctx); }

/* Counts of SysTick, 168 a us. */
static uint32_t ticks_in_50_ms(void) { return counted_in_us(&systick, &fathom_stm32f4_clock, 50000); }

static uint32_t slept(uint32_t max_us)
{
    fathom_stm32f4_idle_t no_wake = {0, 0};
    return slept_us(&fathom_stm32f4_clock, fathom_stm32f4_idle, &no_wake, max_us);
}

int main(void)
{
    fathom_stm32f4_clock_init(board_begin()->timer_hz);
    systick_begin();
    check_within(now_us(), 0, 1000, "the clock begins at 0");
    check_within(ticks_in_50_ms(), 8380000, 8420000, "50 ms by the clock are 50 ms by SysTick");
    /* QEMU 7.2 sets the alarm of these timers late by the time since its start: at twice now and so long. */
    const uint32_t late_us = now_us();
    check_within(slept(20000), 20000, late_us + 20200, "a sleep of 20 ms ends by itself and not before");
    check_within(slept(0), 0, 20, "no time is no sleep");
    TIM2_CNT = UINT32_MAX - 25000;
    check_within(ticks_in_50_ms(), 8380000, 8420000, "50 ms are 50 ms across the wrap");
    check_within(now_us(), 24999, 30000, "after which the clock has begun anew");
    return check_result();
}
