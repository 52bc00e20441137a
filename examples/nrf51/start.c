/* SPDX-License-Identifier: MIT */
/* What an image starts with; on a board, the start-up code of the vendor. */
#include <stddef.h>

#include "cortex_m.h" /* Fathom's examples/start */
#include "nrf51.h"
#include "registers.h"
#include "semihosting.h"

enum { EXCEPTIONS = 16, HARD_FAULT = 3 };

extern const start_vector_t start_vectors[];
__attribute__((section(".vectors"), used)) const start_vector_t start_vectors[EXCEPTIONS + 32] = {
    /* NOLINTNEXTLINE(performance-no-int-to-ptr): the first one is no function */
    (start_vector_t)(uintptr_t)start_stack,
    start_reset,
    [2] = start_fault,
    [HARD_FAULT] = start_fault,
    [11] = start_fault,
    [14] = start_fault,
    [15] = start_fault,
    [EXCEPTIONS + UART_INTERRUPT] = nrf51_uart_interrupt,
    [EXCEPTIONS + TIMER_INTERRUPT] = nrf51_timer_interrupt,
};

void start_end(int status) { semihosting_exit(status); }
