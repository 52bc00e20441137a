/* SPDX-License-Identifier: MIT */
#include "nrf51.h"
#include "registers.h"

enum { COMPARE_1 = 0x144, INTENSET = 0x304, INTENCLR = 0x308, CC_1 = 0x544, INT_COMPARE_1 = 1 << 17 };
enum { LONGEST_US = 1000000000 };

void nrf51_timer_interrupt(void)
{
    TIMER(INTENCLR) = INT_COMPARE_1;
    TIMER(COMPARE_1) = 0;
}

/* Masked from the look at the ring on: an interrupt that is pending ends WFI, and runs afterwards. A compare register
 * that the count has passed already would come in 71 minutes, so it is looked at once more. */
void nrf51_idle(void *ctx, uint32_t max_us)
{
    (void)ctx;
    if (max_us == 0) return;
    if (max_us > LONGEST_US) max_us = LONGEST_US;
    const uint32_t before = lock();
    if (!fathom_serial_waits(&nrf51_serial)) {
        const uint32_t since_us = nrf51_clock.now_us(nrf51_clock.ctx);
        TIMER(CC_1) = since_us + max_us;
        TIMER(COMPARE_1) = 0;
        TIMER(INTENSET) = INT_COMPARE_1;
        NVIC_ISER = 1u << TIMER_INTERRUPT;
        if (fathom_elapsed_us(nrf51_clock.now_us(nrf51_clock.ctx), since_us) < max_us)
            __asm__ volatile("dsb\n\twfi" ::: "memory");
        nrf51_timer_interrupt();
    }
    unlock(before);
}
