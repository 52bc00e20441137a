/* SPDX-License-Identifier: MIT */
/* The sleep of the main loop (WFI). An alarm of TIMER ends it when the time has passed. */
#include "fathom_rp2040.h"
#include "internal/alarm.h"

void fathom_rp2040_idle_init(fathom_rp2040_idle_t *idle)
{
    idle->has_news = true;
    fathom_rp2040_alarm_enable(idle->alarm);
}

void fathom_rp2040_idle(void *ctx, uint32_t max_us)
{
    fathom_rp2040_idle_t *const idle = ctx;
    __asm__ volatile("cpsid i" ::: "memory");
    if (!idle->has_news && (max_us != 0u)) {
        const bool has_deadline = max_us != FATHOM_NO_DEADLINE;
        if (has_deadline)
            fathom_rp2040_alarm_set(idle->alarm, (max_us < (UINT32_MAX / 2u)) ? max_us : (UINT32_MAX / 2u));
        __asm__ volatile("dsb\n\twfi" ::: "memory");
        if (has_deadline) fathom_rp2040_alarm_clear(idle->alarm);
    }
    __asm__ volatile("cpsie i\n\tisb" ::: "memory"); /* Pending interrupts run here. */
    /* The caller polls next, so events up to now are no longer news. */
    idle->has_news = false;
}

void fathom_rp2040_idle_alarm(fathom_rp2040_idle_t *idle) { fathom_rp2040_alarm_clear(idle->alarm); }
