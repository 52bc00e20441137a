/* SPDX-License-Identifier: MIT */
#include <stddef.h>

#include "fathom_virt.h"
#include "internal/virt.h"

/* Low first to the end of time, so that no interrupt comes of a half that is new and one that is old (Privileged
 * Architecture 3.2.1). */
static void set_alarm(uint64_t ticks)
{
    VIRT_MTIMECMP[0] = UINT32_MAX;
    VIRT_MTIMECMP[1] = (uint32_t)(ticks >> 32);
    VIRT_MTIMECMP[0] = (uint32_t)ticks;
}

void fathom_virt_timer_interrupt(void) { set_alarm(UINT64_MAX); }

void fathom_virt_idle(void *ctx, uint32_t max_us)
{
    const fathom_virt_uart_t *const uart = ctx;
    if (max_us == 0u) return;
    /* Masked before the timer runs: its interrupt would else come before WFI now and then, and nothing would be left to
     * end it. An interrupt that is pending ends WFI, and runs afterwards. */
    __asm__ volatile("csrc mstatus, %0" ::"r"(VIRT_MSTATUS_MIE) : "memory");
    if ((uart == NULL) || !fathom_serial_waits(&uart->serial)) {
        set_alarm(fathom_virt_ticks() + ((uint64_t)max_us * (FATHOM_VIRT_TIMER_HZ / 1000000u)));
        __asm__ volatile("csrs mie, %0" ::"r"(VIRT_MIE_MTIE) : "memory");
        __asm__ volatile("wfi" ::: "memory");
        fathom_virt_timer_interrupt();
    }
    __asm__ volatile("csrs mstatus, %0" ::"r"(VIRT_MSTATUS_MIE) : "memory");
}
