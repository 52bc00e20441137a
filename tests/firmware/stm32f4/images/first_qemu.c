/* SPDX-License-Identifier: MIT */
/*
 * QEMU's netduinoplus2 in place of a board, for the first programs. board_qemu.c says what QEMU does otherwise than the
 * chip. The programs set the clock and the interrupts themselves, so the linker puts a function of this file before the
 * one that sets the clock, and SysTick calls the interrupts of both USARTs.
 */
#include "cortex_m.h"
#include "fathom_stm32f4.h"
#include "semihosting.h"
#include "start.h"

#define SYST_CSR (*(volatile uint32_t *)0xE000E010u)
#define SYST_RVR (*(volatile uint32_t *)0xE000E014u)
#define SYST_CVR (*(volatile uint32_t *)0xE000E018u)

enum { CORE_HZ = 168000000, TIMER_HZ = 1000000000, TIMES = 10 };

/* NOLINTBEGIN(bugprone-reserved-identifier): the linker's names */
void __real_fathom_stm32f4_clock_init(uint32_t timer_hz);
void __wrap_fathom_stm32f4_clock_init(uint32_t timer_hz);

void __wrap_fathom_stm32f4_clock_init(uint32_t timer_hz)
{
    (void)timer_hz;
    __real_fathom_stm32f4_clock_init(TIMER_HZ);
    SYST_RVR = CORE_HZ / 1000 - 1;
    SYST_CVR = 0;
    SYST_CSR = 7; /* the clock of the core, its interrupt, on */
}
/* NOLINTEND(bugprone-reserved-identifier) */

void systick_interrupt(void)
{
    for (int i = 0; i != TIMES; i++) {
        usart1_interrupt();
        usart2_interrupt();
    }
}

void start_end(int status) { semihosting_exit(status); }
