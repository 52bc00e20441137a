/* SPDX-License-Identifier: MIT */
#ifndef REGISTERS_H
#define REGISTERS_H

#include <stdint.h>

/* The parts of the chip as arrays of words, by the offsets of the manual. */
#define CLOCK(offset) (((volatile uint32_t *)0x40000000u)[(offset) / 4]) /* 13 */
#define UART(offset)  (((volatile uint32_t *)0x40002000u)[(offset) / 4]) /* 29 */
#define TIMER(offset) (((volatile uint32_t *)0x40008000u)[(offset) / 4]) /* 18 */
#define GPIO(offset)  (((volatile uint32_t *)0x50000000u)[(offset) / 4]) /* 14 */
#define NVIC_ISER     (*(volatile uint32_t *)0xE000E100u)

enum { UART_INTERRUPT = 2, TIMER_INTERRUPT = 8 };

/* The interrupts off; returns what they were. */
static inline uint32_t lock(void)
{
    uint32_t before = 0;
    __asm__ volatile("mrs %0, primask\n\tcpsid i" : "=r"(before)::"memory");
    return before;
}

static inline void unlock(uint32_t before) { __asm__ volatile("msr primask, %0" ::"r"(before) : "memory"); }

#endif
