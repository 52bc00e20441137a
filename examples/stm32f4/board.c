/* SPDX-License-Identifier: MIT */
/* A board with an STM32F405, as it comes out of reset: everything runs from the 16 MHz of HSI, which is within 1 %
 * (RM0090 7.2.2): good enough for a UART, and a distance by pulse is off by as much. A board with a crystal sets its
 * clocks in board_begin. */
#include "board.h"

#include "cortex_m.h"
#include "fathom_stm32f4.h"

static const fathom_stm32f4_pin_t light = {'B', 0};
static fathom_pin_t lamp;

const board_clocks_t *board_begin(void)
{
    static const board_clocks_t clocks = {16000000, 16000000, 16000000};
    lamp = fathom_stm32f4_output(&light);
    return &clocks;
}

/* On PB0: high while something is nearer than 1 m, and while that is not known. */
void board_use(const fathom_sample_t *sample)
{
    const bool is_far =
        sample->kind == FATHOM_NO_TARGET || (sample->kind == FATHOM_TARGET && sample->distance_mm >= 1000);
    lamp.set(lamp.ctx, !is_far);
}

void board_fail(fathom_status_t status)
{
    (void)status;
    lamp.set(lamp.ctx, true);
}

void start_end(int status)
{
    (void)status;
    lamp.set(lamp.ctx, true);
}
