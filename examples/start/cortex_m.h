/* SPDX-License-Identifier: MIT */
#ifndef START_CORTEX_M_H
#define START_CORTEX_M_H

#include <stdint.h>

/*
 * The least that starts C on a Cortex-M: for simulators, and to read. On a board take the start-up code of its maker,
 * which sets the clocks too. Each machine has its vector table and its linker script beside its examples.
 */
enum { START_FAULT = 99 }; /* start_end's, after an exception without a handler */

typedef void (*start_vector_t)(void);

extern uint32_t start_stack[]; /* its top, from the linker */

void start_reset(void); /* memory, main, start_end */
void start_fault(void);

/* The machine's: what happens after main. */
void start_end(int status);

#endif
