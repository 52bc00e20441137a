/* SPDX-License-Identifier: MIT */
#include <stddef.h>

#include "fathom_virt.h"
#include "internal/virt.h"

uint64_t fathom_virt_ticks(void)
{
    for (;;) {
        const uint32_t high = VIRT_MTIME[1];
        const uint32_t low = VIRT_MTIME[0];
        if (VIRT_MTIME[1] == high)
            return ((uint64_t)high << 32) | low; /* else the low half wrapped in between */
    }
}

static uint32_t now_us(void *ctx)
{
    (void)ctx;
    return fathom_virt_us(fathom_virt_ticks());
}

const fathom_clock_t fathom_virt_clock = {now_us, NULL};
