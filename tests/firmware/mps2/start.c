/* SPDX-License-Identifier: MIT */
#include "start.h"

#include "cortex_m.h"
#include "semihosting.h"

#define OR_FAULT __attribute__((weak, alias("start_unexpected")))

void start_unexpected(void);
void start_unexpected(void) { start_fault(); }

void uart0_interrupt(void) OR_FAULT;
void uart1_interrupt(void) OR_FAULT;
void uart2_interrupt(void) OR_FAULT;
void uart3_interrupt(void) OR_FAULT;
void uart4_interrupt(void) OR_FAULT;
void timer0_interrupt(void) OR_FAULT;

enum { EXCEPTIONS = 16 }; /* before interrupt 0 */

extern const start_vector_t start_vectors[];
__attribute__((section(".vectors"), used)) const start_vector_t start_vectors[EXCEPTIONS + 22] = {
    /* NOLINTNEXTLINE(performance-no-int-to-ptr): the first one is no function */
    (start_vector_t)(uintptr_t)start_stack,
    start_reset,
    [2] = start_fault,
    [3] = start_fault,
    [4] = start_fault,
    [5] = start_fault,
    [6] = start_fault,
    [11] = start_fault,
    [12] = start_fault,
    [14] = start_fault,
    [15] = start_fault,
    [EXCEPTIONS + 0] = uart0_interrupt,
    [EXCEPTIONS + 1] = uart0_interrupt,
    [EXCEPTIONS + 2] = uart1_interrupt,
    [EXCEPTIONS + 3] = uart1_interrupt,
    [EXCEPTIONS + 4] = uart2_interrupt,
    [EXCEPTIONS + 5] = uart2_interrupt,
    [EXCEPTIONS + 8] = timer0_interrupt,
    [EXCEPTIONS + 18] = uart3_interrupt,
    [EXCEPTIONS + 19] = uart3_interrupt,
    [EXCEPTIONS + 20] = uart4_interrupt,
    [EXCEPTIONS + 21] = uart4_interrupt,
};

void start_end(int status) { semihosting_exit(status); }
