/* SPDX-License-Identifier: MIT */
#ifndef MPS2_START_H
#define MPS2_START_H

/* The interrupts of the board (AN385 3.7) that Fathom's port has a use for. An image defines those that it enables;
 * the others end it with START_FAULT. */
void uart0_interrupt(void); /* RX and TX */
void uart1_interrupt(void);
void uart2_interrupt(void);
void uart3_interrupt(void);
void uart4_interrupt(void);
void timer0_interrupt(void);

#endif
