/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_AVR_BOARD_INSIDE_H
#define FATHOM_TEST_AVR_BOARD_INSIDE_H

#include "board.h"

/* What board.c, board_core.c and board_wires.c want of each other. */

/* Puts what is wrong in simavr's processor right. */
void board_mend(avr_t *avr);

/* Once the processor is there: the USART's ends. */
void board_wire(void);

/* The line has a byte for the UART, which ended ago_us ago. */
void board_arrived(uint8_t byte, uint8_t flags, uint32_t ago_us);

#endif
