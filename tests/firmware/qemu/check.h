/* SPDX-License-Identifier: MIT */
#ifndef QEMU_CHECK_H
#define QEMU_CHECK_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/wait.h"
#include "fathom/hal.h"

/* For images that test themselves: each writes a line "ok WHAT" or "FAILED WHAT", by semihosting. */
void check(bool is_right, const char *what);

/* Is `value` at least `least` and at most `most`? If not, the three are written too, in hex. */
void check_within(uint32_t value, uint32_t least, uint32_t most, const char *what);

/* Another counter of the board, to compare a clock with: how far it goes in so many us by the clock. */
typedef struct {
    const volatile uint32_t *at;
    uint32_t bits;
    bool is_down;
} counter_t;
uint32_t counted_in_us(const counter_t *counter, const fathom_clock_t *clock, uint32_t length_us);

/* SysTick of a Cortex-M, from now on with the clock of the core; it counts down. */
extern const counter_t systick;
void systick_begin(void);

/* How long a sleep of at most so long takes. */
uint32_t slept_us(const fathom_clock_t *clock, fathom_idle_t idle, void *idle_ctx, uint32_t max_us);

/* 200 short ones, for a test that runs them with 1 us an instruction, so that every place on the way to WFI is one at
 * which the time may be up. Where that loses the alarm the sleep does not end. What main returns. */
int check_short_sleeps(fathom_idle_t idle, void *idle_ctx);

int set(const fathom_uart_t *uart, uint32_t baud, uint8_t parity, uint8_t stop_bits);

/* A request of as much as the port's memory holds, while interrupts are off or none comes; it leaves afterwards. */
void check_request(const fathom_uart_t *uart, uint8_t size, uint32_t takes_us);

/* What main returns: 0 if nothing failed, else 1. */
int check_result(void);

#endif
