/* SPDX-License-Identifier: MIT */
/*
 * The clock: TIM2, which counts microseconds in 32 bits. The init function also sets up TIM5 for the sleep, because it
 * knows the rate.
 */
#include <stddef.h>

#include "internal/stm32f4_port.h"

static void begin_timer(volatile uint32_t *timer, uint32_t timer_hz)
{
    timer[TIM_CR1] = TIM_CR1_URS; /* UG below must not raise an interrupt. */
    timer[TIM_PSC] = (timer_hz / 1000000u) - 1u;
    timer[TIM_ARR] = UINT32_MAX;
    timer[TIM_EGR] = TIM_EGR_UG; /* The update makes the prescaler effective and sets CNT to 0. */
}

void fathom_stm32f4_clock_init(uint32_t timer_hz)
{
    RCC_APB1ENR |= RCC_TIM2 | RCC_TIM5;
    (void)RCC_APB1ENR;
    begin_timer(TIM5, timer_hz);
    begin_timer(TIM2, timer_hz);
    TIM2[TIM_CR1] = TIM_CR1_CEN | TIM_CR1_URS;
}

static uint32_t now_us(void *ctx)
{
    (void)ctx;
    return TIM2[TIM_CNT];
}

const fathom_clock_t fathom_stm32f4_clock = {now_us, NULL};
