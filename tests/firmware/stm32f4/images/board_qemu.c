/* SPDX-License-Identifier: MIT */
/*
 * QEMU 7.2's netduinoplus2 in place of a board. What it does otherwise than the chip: its timers are clocked with
 * 1 GHz, and its USARTs take a byte at once and raise no interrupt for TXE and TC. So SysTick calls the interrupt
 * instead, once for each byte of a request and twice for its end.
 */
#include "board.h"

#include "cortex_m.h"
#include "semihosting.h"
#include "start.h"
#include "tell.h"

#define SYST_CSR (*(volatile uint32_t *)0xE000E010u)
#define SYST_RVR (*(volatile uint32_t *)0xE000E014u)
#define SYST_CVR (*(volatile uint32_t *)0xE000E018u)

enum { CORE_HZ = 168000000, TIMES = 10 };

void systick_interrupt(void)
{
    for (int i = 0; i != TIMES; i++) usart2_interrupt();
}

const board_clocks_t *board_begin(void)
{
    static const board_clocks_t clocks = {42000000, 84000000, 1000000000};
    SYST_RVR = CORE_HZ / 1000 - 1;
    SYST_CVR = 0;
    SYST_CSR = 7; /* the clock of the core, its interrupt, on */
    return &clocks;
}

void board_use(const fathom_sample_t *sample) { tell_sample("gate", sample); }
void board_fail(fathom_status_t status) { tell_error("gate", status); }
void start_end(int status) { semihosting_exit(status); }
