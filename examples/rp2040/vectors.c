/* SPDX-License-Identifier: MIT */
#include "vectors.h"
#include "../start/cortex_m.h"
#include "rp2040.h"

#define WEAK __attribute__((weak))

WEAK void timer_irq_0(void) { start_fault(); }
WEAK void timer_irq_1(void) { start_fault(); }
WEAK void timer_irq_2(void) { start_fault(); }
WEAK void timer_irq_3(void) { start_fault(); }
WEAK void io_irq_bank0(void) { start_fault(); }
WEAK void dma_irq_0(void) { start_fault(); }
WEAK void uart0_irq(void) { start_fault(); }
WEAK void uart1_irq(void) { start_fault(); }

enum { EXCEPTIONS = 16, INTERRUPTS = 26 }; /* before interrupt 0, and of the chip */

#define CHIP(interrupt) (EXCEPTIONS + (interrupt))

__attribute__((section(".vectors"), used)) static const start_vector_t vectors[EXCEPTIONS + INTERRUPTS] = {
    /* NOLINTNEXTLINE(performance-no-int-to-ptr): the first one is no function */
    (start_vector_t)(uintptr_t)start_stack,
    start_reset,
    [2] = start_fault,  /* NMI */
    [3] = start_fault,  /* HardFault */
    [11] = start_fault, /* SVCall */
    [14] = start_fault, /* PendSV */
    [15] = start_fault, /* SysTick */
    [CHIP(RP2040_IRQ_TIMER_0)] = timer_irq_0,
    [CHIP(RP2040_IRQ_TIMER_0 + 1)] = timer_irq_1,
    [CHIP(RP2040_IRQ_TIMER_0 + 2)] = timer_irq_2,
    [CHIP(RP2040_IRQ_TIMER_0 + 3)] = timer_irq_3,
    [CHIP(RP2040_IRQ_DMA_0)] = dma_irq_0,
    [CHIP(RP2040_IRQ_IO_BANK0)] = io_irq_bank0,
    [CHIP(RP2040_IRQ_UART0)] = uart0_irq,
    [CHIP(RP2040_IRQ_UART0 + 1)] = uart1_irq,
};
