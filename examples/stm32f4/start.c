/* SPDX-License-Identifier: MIT */
#include "start.h"

#include "cortex_m.h"

#define OR_FAULT __attribute__((weak, alias("start_unexpected")))

void start_unexpected(void);
void start_unexpected(void) { start_fault(); }

void systick_interrupt(void) OR_FAULT;
void tim2_interrupt(void) OR_FAULT;
void usart1_interrupt(void) OR_FAULT;
void usart2_interrupt(void) OR_FAULT;
void usart3_interrupt(void) OR_FAULT;
void tim5_interrupt(void) OR_FAULT;
void uart4_interrupt(void) OR_FAULT;
void uart5_interrupt(void) OR_FAULT;
void usart6_interrupt(void) OR_FAULT;

enum { EXCEPTIONS = 16 }; /* before interrupt 0 */

extern const start_vector_t start_vectors[];
__attribute__((section(".vectors"), used)) const start_vector_t start_vectors[EXCEPTIONS + 82] = {
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
    [15] = systick_interrupt,
    [EXCEPTIONS + 28] = tim2_interrupt,
    [EXCEPTIONS + 37] = usart1_interrupt,
    [EXCEPTIONS + 38] = usart2_interrupt,
    [EXCEPTIONS + 39] = usart3_interrupt,
    [EXCEPTIONS + 50] = tim5_interrupt,
    [EXCEPTIONS + 52] = uart4_interrupt,
    [EXCEPTIONS + 53] = uart5_interrupt,
    [EXCEPTIONS + 71] = usart6_interrupt,
};
