/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_AVR_PROFILE_H
#define FATHOM_TEST_AVR_PROFILE_H

#include <stdbool.h>
#include <stdint.h>

#include "board.h"

/*
 * What an image costs: follows every instruction. Cycles are the datasheet's; those of an interrupt go from its
 * vector, with the jump there, to the end of its reti, without the 4 of its entry (which belong to `entries`), and
 * without what interrupts it.
 */
enum { PROFILE_VECTORS = 26, PROFILE_NESTED = 8, PROFILE_FUNCTIONS = 8 };

typedef struct {
    uint32_t calls, longest_cycles, shortest_cycles, last_cycles;
    uint64_t total_cycles;
    uint16_t stack; /* bytes, the deepest: with the return address, and all that it calls */
} profile_cost_t;

/* A function of the image, called from the main loop: without interrupts, in cycles and in stack, and without sleep.
 * It must not be inlined, nor call itself. */
typedef struct {
    profile_cost_t cost;
    uint32_t address;
    uint16_t stack_pointer; /* at its first instruction */
    uint32_t cycles;
    uint16_t deepest;
    bool running;
} profile_function_t;

/* An interrupt that runs. */
typedef struct {
    uint8_t vector;
    uint32_t cycles;
    uint16_t stack_pointer, deepest;
} profile_frame_t;

typedef struct {
    profile_cost_t interrupts[PROFILE_VECTORS]; /* by vector number, ATmega328P 12.4, from 0 */
    profile_function_t functions[PROFILE_FUNCTIONS];
    uint8_t functions_used;
    uint64_t main_cycles; /* of the main loop, awake */
    uint64_t asleep_cycles;
    uint32_t entries;         /* of interrupts; 4 cycles each */
    uint16_t deepest_pointer; /* the stack pointer, interrupts and all */
    avr_flashaddr_t address;  /* of the instruction */
    uint16_t settled_pointer; /* the stack pointer when its halves last belonged together */
    bool half_written;        /* avr-gcc moves it by OUT to its high and then to its low half */

    /* inside */
    profile_frame_t nested[PROFILE_NESTED];
    uint8_t depth;
    uint8_t running; /* simavr's count at the beginning of the instruction */
    bool entered;    /* an interrupt at the end of this instruction */
    uint8_t vector;
    bool asleep;
    uint64_t cycle;
} profile_t;

extern profile_t profile;

/* Begins now, with everything 0. */
void profile_begin(void);

/* To be called between begin and the calls of interest. */
const profile_cost_t *profile_function(const char *symbol);

/* Bytes between the end of the RAM and the deepest stack pointer. */
uint16_t profile_deepest_stack(void);

/* Awake, in interrupts or in the main loop, since the beginning. */
uint64_t profile_awake_cycles(void);

/* The vectors of interest. */
enum { PROFILE_INT0 = 1, PROFILE_USART_RECEIVE = 18, PROFILE_USART_EMPTY = 19, PROFILE_USART_TRANSMIT = 20 };
enum { PROFILE_TIMER1_CAPTURE = 10, PROFILE_TIMER1_COMPARE_B = 12, PROFILE_TIMER1_OVERFLOW = 13 };

#endif
