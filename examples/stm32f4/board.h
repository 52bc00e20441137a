/* SPDX-License-Identifier: MIT */
#ifndef STM32F4_BOARD_H
#define STM32F4_BOARD_H

#include <stdint.h>

#include "fathom/sample.h"
#include "fathom/status.h"

/* What an example has to know of where it runs: a board, board.c, or a simulator. */
typedef struct {
    uint32_t pclk1_hz;
    uint32_t pclk2_hz;
    uint32_t timer_hz; /* of TIM2 and TIM5 */
} board_clocks_t;

/* Begins what the board needs, and returns its clocks. */
const board_clocks_t *board_begin(void);

/* A reading, or how an attempt failed. */
void board_use(const fathom_sample_t *sample);
void board_fail(fathom_status_t status);

#endif
