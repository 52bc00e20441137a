/* SPDX-License-Identifier: MIT */
/* The sleep of the main loop (WFI). The interrupt of TIM5 ends it when the time has passed. */
#include "internal/stm32f4_port.h"

enum { DIER_UIE = 1, TIM5_INTERRUPT = 50 };

void fathom_stm32f4_tim5_interrupt(void)
{
    TIM5[TIM_CR1] = TIM_CR1_URS;
    TIM5[TIM_DIER] = 0;
    TIM5[TIM_SR] = 0;
}

static bool byte_waits(const fathom_stm32f4_idle_t *idle)
{
    for (uint8_t i = 0; i != idle->count; i++)
        if (fathom_serial_waits(&idle->usarts[i].serial)) return true;
    return false;
}

void fathom_stm32f4_idle(void *ctx, uint32_t max_us)
{
    if (max_us == 0u) return;
    /* Interrupts are masked before the timer runs. Otherwise the interrupt of the timer could come before WFI, and
     * nothing would end WFI. A pending interrupt ends WFI and runs afterwards. */
    __asm__ volatile("cpsid i" ::: "memory");
    if ((fathom_stm32f4_happened == 0u) && !byte_waits(ctx)) {
        TIM5[TIM_CR1] = TIM_CR1_URS;
        TIM5[TIM_CNT] = 0;
        TIM5[TIM_ARR] = max_us;
        TIM5[TIM_SR] = 0;
        TIM5[TIM_DIER] = DIER_UIE;
        fathom_stm32f4_enable_interrupt(TIM5_INTERRUPT);
        TIM5[TIM_CR1] = TIM_CR1_CEN | TIM_CR1_URS | TIM_CR1_OPM;
        __asm__ volatile("dsb\n\twfi" ::: "memory");
        fathom_stm32f4_tim5_interrupt();
    }
    __asm__ volatile("cpsie i\n\tisb" ::: "memory"); /* Pending interrupts run here. */
    fathom_stm32f4_happened = 0; /* The caller polls next, so events up to now are no longer news. */
}
