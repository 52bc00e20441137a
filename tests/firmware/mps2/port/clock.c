/* SPDX-License-Identifier: MIT */
#include <stddef.h>

#include "fathom_mps2.h"

/* FPGAIO (AN385 4.6). COUNTER goes up by one each PRESCALE + 1 periods of the clock. */
#define FPGAIO   ((volatile uint32_t *)0x40028000u)
#define COUNTER  (0x18 / 4)
#define PRESCALE (0x1C / 4)
#define PSCNTR   (0x20 / 4)

void fathom_mps2_clock_begin(void)
{
    FPGAIO[PRESCALE] = (FATHOM_MPS2_HZ / 1000000u) - 1u;
    FPGAIO[PSCNTR] = 0;
    FPGAIO[COUNTER] = 0;
}

static uint32_t now_us(void *ctx)
{
    (void)ctx;
    return FPGAIO[COUNTER];
}

const fathom_clock_t fathom_mps2_clock = {now_us, NULL};
