/* SPDX-License-Identifier: MIT */
#include <stddef.h>

#include "nrf51.h"
#include "registers.h"

enum { HFCLKSTART = 0x000, HFCLKSTARTED = 0x100 };
enum { START = 0x000, CAPTURE_0 = 0x040, MODE = 0x504, BITMODE = 0x508, PRESCALER = 0x510, CC_0 = 0x540 };
enum { MODE_TIMER = 0, BITMODE_32 = 3, TO_1_MHZ = 4 /* 16 MHz / 2^4 */ };

void nrf51_clock_begin(void)
{
    CLOCK(HFCLKSTARTED) = 0;
    CLOCK(HFCLKSTART) = 1;
    while (CLOCK(HFCLKSTARTED) == 0) {
    }
    TIMER(MODE) = MODE_TIMER;
    TIMER(BITMODE) = BITMODE_32;
    TIMER(PRESCALER) = TO_1_MHZ;
    TIMER(START) = 1;
}

/* The count can be read by way of a capture only; nothing may come in between. */
static uint32_t now_us(void *ctx)
{
    (void)ctx;
    const uint32_t before = lock();
    TIMER(CAPTURE_0) = 1;
    const uint32_t now = TIMER(CC_0);
    unlock(before);
    return now;
}

const fathom_clock_t nrf51_clock = {now_us, NULL};
