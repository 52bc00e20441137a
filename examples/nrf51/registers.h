/* SPDX-License-Identifier: MIT */
#ifndef REGISTERS_H
#define REGISTERS_H

#include <stdint.h>

/* The parts of the chip as arrays of words, by the offsets of the manual. */
#define AT(base, offset) (((volatile uint32_t *)(base))[(offset) / 4])

#define CLOCK(offset) AT(0x40000000u, offset) /* 13 */
#define UART(offset)  AT(0x40002000u, offset) /* 29 */
#define TIMER(offset) AT(0x40008000u, offset) /* 18 */
#define GPIO(offset)  AT(0x50000000u, offset) /* 14 */
#define NVIC_ISER     AT(0xE000E100u, 0)

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
