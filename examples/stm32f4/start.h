/* SPDX-License-Identifier: MIT */
#ifndef STM32F4_START_H
#define STM32F4_START_H

/* The interrupts (RM0090 table 62) that Fathom's port has a use for. An image defines those that it enables; the
 * others end it with START_FAULT. */
void systick_interrupt(void);
void tim2_interrupt(void);
void usart1_interrupt(void);
void usart2_interrupt(void);
void usart3_interrupt(void);
void tim5_interrupt(void);
void uart4_interrupt(void);
void uart5_interrupt(void);
void usart6_interrupt(void);

#endif
