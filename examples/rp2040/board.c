/* SPDX-License-Identifier: MIT */
#include "board.h"
#include "../start/cortex_m.h"
#include "rp2040.h"

/* A debugger, or a simulator, finds there how it ended. */
void start_end(int status)
{
    RP2040_WATCHDOG_SCRATCH(0) = (uint32_t)status;
    RP2040_WATCHDOG_SCRATCH(1) = BOARD_ENDED;
    __asm__ volatile("cpsid i");
    for (;;) __asm__ volatile("wfi");
}
