/* SPDX-License-Identifier: MIT */
#include "profile.h"

#include <string.h>

enum { RETURN_ADDRESS = 2 };

profile_t profile;

static uint16_t stack_pointer(const avr_t *avr)
{
    return (uint16_t)(avr->data[R_SPL] | avr->data[R_SPH] << 8);
}

/* After the instruction at profile.address. */
static uint16_t settled_stack_pointer(const avr_t *avr)
{
    const uint16_t code = (uint16_t)(avr->flash[profile.address] | avr->flash[profile.address + 1] << 8);
    if ((code & 0xFE0F) == 0xBE0E) profile.half_written = true;  /* OUT 3E */
    if ((code & 0xFE0F) == 0xBE0D) profile.half_written = false; /* OUT 3D */
    if (!profile.half_written) profile.settled_pointer = stack_pointer(avr);
    return profile.settled_pointer;
}

static void add_call(profile_cost_t *cost, uint32_t cycles, uint16_t stack)
{
    if (cost->calls == 0 || cycles < cost->shortest_cycles) cost->shortest_cycles = cycles;
    if (cycles > cost->longest_cycles) cost->longest_cycles = cycles;
    if (stack > cost->stack) cost->stack = stack;
    cost->calls++;
    cost->last_cycles = cycles;
    cost->total_cycles += cycles;
}

static void before(void)
{
    const avr_t *const avr = board.avr;
    profile.cycle = avr->cycle;
    profile.address = avr->pc;
    profile.asleep = avr->state == cpu_Sleeping;
    profile.running = avr->interrupts.running_ptr;
    profile.entered = false;
    if (profile.asleep || profile.depth != 0) return;
    for (uint8_t i = 0; i < profile.functions_used; i++) {
        profile_function_t *const function = &profile.functions[i];
        if (function->running || avr->pc != function->address) continue;
        function->running = true;
        function->cycles = 0;
        function->stack_pointer = function->deepest = stack_pointer(avr);
    }
}

static void interrupt(uint8_t vector)
{
    profile.entered = true;
    profile.vector = vector;
    profile.entries++;
}

static void charge_main(uint32_t cycles, uint16_t pointer)
{
    profile.main_cycles += cycles;
    for (uint8_t i = 0; i < profile.functions_used; i++) {
        profile_function_t *const function = &profile.functions[i];
        if (!function->running) continue;
        function->cycles += cycles;
        if (pointer < function->deepest) function->deepest = pointer;
        if (pointer <= function->stack_pointer) continue; /* it has not returned */
        function->running = false;
        add_call(&function->cost, function->cycles,
                 (uint16_t)(function->stack_pointer + RETURN_ADDRESS - function->deepest));
    }
}

static void after(void)
{
    const avr_t *const avr = board.avr;
    const uint32_t cycles =
        (uint32_t)(avr->cycle - profile.cycle) - (profile.entered ? (uint32_t)BOARD_ENTRY_CYCLES : 0);
    const uint16_t now = settled_stack_pointer(avr);
    const uint16_t pointer = (uint16_t)(now + (profile.entered ? RETURN_ADDRESS : 0)); /* before the entry */
    if (now < profile.deepest_pointer) profile.deepest_pointer = now;
    if (profile.asleep) {
        profile.asleep_cycles += cycles;
    } else if (profile.depth == 0) {
        charge_main(cycles, pointer);
    } else {
        profile_frame_t *const frame = &profile.nested[profile.depth - 1];
        frame->cycles += cycles;
        if (pointer < frame->deepest) frame->deepest = pointer;
    }
    const int left = profile.running + (profile.entered ? 1 : 0) - avr->interrupts.running_ptr;
    if (left == 1 && profile.depth != 0) {
        const profile_frame_t *const frame = &profile.nested[--profile.depth];
        add_call(&profile.interrupts[frame->vector], frame->cycles,
                 (uint16_t)(frame->stack_pointer + RETURN_ADDRESS - frame->deepest));
    }
    if (!profile.entered) return;
    if (profile.depth == PROFILE_NESTED || profile.vector >= PROFILE_VECTORS)
        board_give_up("interrupts nested too deep");
    profile.nested[profile.depth++] = (profile_frame_t){profile.vector, 0, now, now};
}

void profile_begin(void)
{
    static const board_observer_t observer = {before, after, interrupt};
    memset(&profile, 0, sizeof profile);
    profile.deepest_pointer = profile.settled_pointer = stack_pointer(board.avr);
    board.observer = &observer;
}

const profile_cost_t *profile_function(const char *symbol)
{
    if (profile.functions_used == PROFILE_FUNCTIONS) board_give_up("too many functions");
    profile_function_t *const function = &profile.functions[profile.functions_used++];
    function->address = board_address(symbol);
    return &function->cost;
}

uint16_t profile_deepest_stack(void) { return (uint16_t)(board.avr->ramend - profile.deepest_pointer); }

uint64_t profile_awake_cycles(void)
{
    uint64_t cycles = profile.main_cycles + (uint64_t)profile.entries * BOARD_ENTRY_CYCLES;
    for (int i = 0; i < PROFILE_VECTORS; i++) cycles += profile.interrupts[i].total_cycles;
    return cycles;
}
