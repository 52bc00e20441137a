/* SPDX-License-Identifier: MIT */
#include "fathom_mps2.h"

/* CMSDK APB timer 0 (DDI 0479, 4.4): counts down to 0 at the clock of the core. */
#define TIMER0 ((volatile uint32_t *)0x40000000u)
enum { CTRL = 0x00 / 4, VALUE = 0x04 / 4, RELOAD = 0x08 / 4, INTCLEAR = 0x0C / 4 };
enum { CTRL_ENABLE = 1, CTRL_INTERRUPT = 8 };
enum { TIMER0_INTERRUPT = 8 };

#define NVIC_ISER ((volatile uint32_t *)0xE000E100u)

enum { LONGEST_US = 100000000 };

void fathom_mps2_timer0_interrupt(void)
{
    TIMER0[CTRL] = 0;
    TIMER0[INTCLEAR] = 1;
}

static bool byte_waits(const fathom_mps2_idle_t *idle)
{
    for (uint8_t i = 0; i != idle->count; i++)
        if (fathom_serial_waits(&idle->uarts[i].serial)) return true;
    return false;
}

void fathom_mps2_idle(void *ctx, uint32_t max_us)
{
    if (max_us == 0u) return;
    if (max_us > LONGEST_US) max_us = LONGEST_US;
    /* Masked before the timer runs: its interrupt would else come before WFI now and then, and nothing would be left to
     * end it. An interrupt that is pending ends WFI, and runs afterwards. */
    __asm__ volatile("cpsid i" ::: "memory");
    if (!byte_waits(ctx)) {
        TIMER0[CTRL] = 0;
        TIMER0[RELOAD] = 0; /* once */
        TIMER0[VALUE] = max_us * (FATHOM_MPS2_HZ / 1000000u);
        NVIC_ISER[0] = 1u << TIMER0_INTERRUPT;
        TIMER0[CTRL] = CTRL_ENABLE | CTRL_INTERRUPT;
        __asm__ volatile("dsb\n\twfi" ::: "memory");
        fathom_mps2_timer0_interrupt();
    }
    __asm__ volatile("cpsie i\n\tisb" ::: "memory");
}
