/* SPDX-License-Identifier: MIT */
#include "profile.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RETURN_ADDRESS = 2 };

static uint16_t stack_pointer(const avr_t *avr)
{
    return (uint16_t)(avr->data[R_SPL] | avr->data[R_SPH] << 8);
}

static void tally(profile_cost_t *cost, uint32_t cycles, uint16_t stack)
{
    if (cost->calls == 0 || cycles < cost->shortest_cycles) cost->shortest_cycles = cycles;
    if (cycles > cost->longest_cycles) cost->longest_cycles = cycles;
    if (stack > cost->stack) cost->stack = stack;
    cost->calls++;
    cost->last_cycles = cycles;
    cost->total_cycles += cycles;
}

static void before(void *ctx)
{
    profile_t *const profile = (profile_t *)ctx;
    const avr_t *const avr = profile->board->avr;
    profile->cycle = avr->cycle;
    profile->asleep = avr->state == cpu_Sleeping;
    profile->running = avr->interrupts.running_ptr;
    profile->entered = false;
    if (profile->asleep || profile->depth != 0) return;
    for (uint8_t i = 0; i < profile->functions_used; i++) {
        profile_function_t *const function = &profile->functions[i];
        if (function->running || avr->pc != function->address) continue;
        function->running = true;
        function->cycles = 0;
        function->stack_pointer = function->deepest = stack_pointer(avr);
    }
}

static void interrupt(void *ctx, uint8_t vector)
{
    profile_t *const profile = (profile_t *)ctx;
    profile->entered = true;
    profile->vector = vector;
    profile->entries++;
}

static void charge_main(profile_t *profile, uint32_t cycles, uint16_t pointer)
{
    profile->main_cycles += cycles;
    for (uint8_t i = 0; i < profile->functions_used; i++) {
        profile_function_t *const function = &profile->functions[i];
        if (!function->running) continue;
        function->cycles += cycles;
        if (pointer < function->deepest) function->deepest = pointer;
        if (pointer <= function->stack_pointer) continue; /* it has not returned */
        function->running = false;
        tally(&function->cost, function->cycles,
              (uint16_t)(function->stack_pointer + RETURN_ADDRESS - function->deepest));
    }
}

static void after(void *ctx)
{
    profile_t *const profile = (profile_t *)ctx;
    const avr_t *const avr = profile->board->avr;
    const uint32_t cycles =
        (uint32_t)(avr->cycle - profile->cycle) - (profile->entered ? (uint32_t)BOARD_ENTRY_CYCLES : 0);
    const uint16_t now = stack_pointer(avr);
    const uint16_t pointer = (uint16_t)(now + (profile->entered ? RETURN_ADDRESS : 0)); /* before the entry */
    if (now < profile->deepest_pointer) profile->deepest_pointer = now;
    if (profile->asleep) {
        profile->asleep_cycles += cycles;
    } else if (profile->depth == 0) {
        charge_main(profile, cycles, pointer);
    } else {
        profile->nested[profile->depth - 1].cycles += cycles;
        if (pointer < profile->nested[profile->depth - 1].deepest)
            profile->nested[profile->depth - 1].deepest = pointer;
    }
    const int left = profile->running + (profile->entered ? 1 : 0) - avr->interrupts.running_ptr;
    if (left == 1 && profile->depth != 0) {
        profile->depth--;
        const uint8_t vector = profile->nested[profile->depth].vector;
        tally(&profile->interrupts[vector], profile->nested[profile->depth].cycles,
              (uint16_t)(profile->nested[profile->depth].stack_pointer + RETURN_ADDRESS -
                         profile->nested[profile->depth].deepest));
    }
    if (!profile->entered) return;
    if (profile->depth == PROFILE_NESTED || profile->vector >= PROFILE_VECTORS) {
        fprintf(stderr, "interrupts nested too deep\n");
        exit(EXIT_FAILURE);
    }
    profile->nested[profile->depth].vector = profile->vector;
    profile->nested[profile->depth].cycles = 0;
    profile->nested[profile->depth].stack_pointer = profile->nested[profile->depth].deepest = now;
    profile->depth++;
}

void profile_begin(profile_t *profile, board_t *board)
{
    memset(profile, 0, sizeof *profile);
    profile->board = board;
    profile->deepest_pointer = stack_pointer(board->avr);
    profile->observer.before = before;
    profile->observer.after = after;
    profile->observer.interrupt = interrupt;
    profile->observer.ctx = profile;
    board->observer = &profile->observer;
}

void profile_end(profile_t *profile) { profile->board->observer = NULL; }

const profile_cost_t *profile_function(profile_t *profile, const char *symbol)
{
    if (profile->functions_used == PROFILE_FUNCTIONS) {
        fprintf(stderr, "too many functions\n");
        exit(EXIT_FAILURE);
    }
    profile_function_t *const function = &profile->functions[profile->functions_used++];
    function->address = board_address(profile->board, symbol);
    return &function->cost;
}

uint16_t profile_deepest_stack(const profile_t *profile)
{
    return (uint16_t)(profile->board->avr->ramend - profile->deepest_pointer);
}

uint64_t profile_awake_cycles(const profile_t *profile)
{
    uint64_t cycles = profile->main_cycles + (uint64_t)profile->entries * BOARD_ENTRY_CYCLES;
    for (int i = 0; i < PROFILE_VECTORS; i++) cycles += profile->interrupts[i].total_cycles;
    return cycles;
}
