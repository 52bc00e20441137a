/* SPDX-License-Identifier: MIT */
/* The clock: the low word of TIMER, which counts microseconds. The init function starts TIMER and its ticks. */
#include "fathom_rp2040.h"
#include "rp2040.h"

enum { HZ_PER_MHZ = 1000000 };

void fathom_rp2040_clock_init(uint32_t ref_hz)
{
    if (ref_hz != 0u) RP2040_WATCHDOG_TICK = (ref_hz / HZ_PER_MHZ) | RP2040_WATCHDOG_TICK_ENABLE;
    rp2040_clear(&RP2040_RESETS_RESET, RP2040_RESETS_TIMER);
    while ((RP2040_RESETS_RESET_DONE & RP2040_RESETS_TIMER) == 0u) { /* some cycles of clk_sys */
    }
}

static uint32_t now_us(void *ctx)
{
    (void)ctx;
    return RP2040_TIMER_RAWL;
}

const fathom_clock_t fathom_rp2040_clock = {now_us, NULL};
