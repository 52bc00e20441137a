/* SPDX-License-Identifier: MIT */
#include "host.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

run_t run;
shared_t *shared;
void (*run_boundary)(void);

/* Cycles: the slots of a side lie so far apart that the interrupts of the first have ended; a path is not longer. */
enum { SLOT_CYCLES = 1500, WINDOW_CYCLES = 2 * SLOT_CYCLES, MOST_CYCLES = 200000 };

/* ---- the image ---- */

volatile calls_t *image_calls(void)
{
    static volatile calls_t *calls; /* symbols are looked for one by one */
    if (calls == NULL) calls = (volatile calls_t *)(void *)board_data("calls");
    return calls;
}

static bool has_come(void *ctx) { return board.avr->cycle >= *(const uint64_t *)ctx; }

static void run_to(uint64_t cycle) { board_run(has_come, &cycle, cycle / BOARD_CYCLES_PER_US); }

void image_run(uint64_t cycles) { run_to(board.avr->cycle + cycles); }

static bool is_done(void *ctx)
{
    const volatile calls_t *const calls = (const volatile calls_t *)ctx;
    return calls->call == 0;
}

/* What it did may have destroyed anything, so the run ends here. */
static void hang(const char *what)
{
    shared->wrongs++;
    printf("wrong %s: %s at %04x", run.scenario->name, what, (unsigned)board.avr->pc);
    for (uint8_t i = 0; i < run.raises; i++)
        printf(", %s at %04x", event_names[run.raised[i].event], run.raised[i].address);
    putchar('\n');
    _exit(EXIT_SUCCESS);
}

void image_call(uint8_t call)
{
    volatile calls_t *const calls = image_calls();
    calls->call = call;
    if (!board_run(is_done, (void *)(uintptr_t)calls, MOST_CYCLES / BOARD_CYCLES_PER_US))
        hang("the image hangs");
    if (call == CALL_SET_BREAK) truth.has_break = true;
    if (call == CALL_WRITE && calls->result > 0) {
        for (int i = 0; i < calls->result; i++) truth.sent[truth.sent_count++] = calls->bytes[i];
        truth.requests++;
    }
}

/* ---- what happens in the path ---- */

static void has_happened(uint8_t number)
{
    raised_t *const raised = &run.raised[number];
    const avr_t *const avr = board.avr;
    raised->has_raised = true;
    raised->cycle = avr->cycle;
    raised->raised_step = run.step;
    /* Behind sei and reti one more instruction is carried out. */
    raised->could_enter = avr->sreg[S_I] && avr->interrupt_state > -2 && avr->interrupts.running_ptr == 0;
}

static avr_cycle_count_t raise_now(avr_t *avr, avr_cycle_count_t when, void *param)
{
    raised_t *const raised = (raised_t *)param;
    const uint8_t number = (uint8_t)(raised - run.raised);
    if (!event_raise(raised->event, number)) { /* no character left, say: nothing to be seen here */
        shared->nothing++;
        _exit(EXIT_SUCCESS);
    }
    has_happened(number);
    return 0;
}

static avr_cycle_count_t overflows_now(avr_t *avr, avr_cycle_count_t when, void *param)
{
    has_happened(0);
    return 0;
}

static raised_t *add(event_t event)
{
    raised_t *const raised = &run.raised[run.raises++];
    memset(raised, 0, sizeof *raised);
    raised->event = event;
    return raised;
}

void run_raise(event_t event) { avr_cycle_timer_register(board.avr, 1, raise_now, add(event)); }

void run_raise_here(event_t event) { raise_now(board.avr, 0, add(event)); }

/* The address of what has just come is that of the next instruction that is not the interrupt's. */
static void note(uint16_t address)
{
    for (uint8_t i = 0; i < run.raises; i++)
        if (run.raised[i].has_raised && run.raised[i].address == 0) run.raised[i].address = address;
}

static uint8_t characters_left(void)
{
    uint32_t begun = 0;
    for (uint32_t i = 0; i < board.bytes_seen; i++) begun += board.bytes[i].from_here;
    return (uint8_t)(truth.sent_count - begun + board.usart.shifting);
}

/* The last instruction. */
static uint32_t records_seen;
static uint64_t last_cycle;
static uint16_t last_pc;
static bool is_known; /* where the path begins */

static void record_last(void)
{
    if (is_known) return;
    if (shared->length == MOST_BOUNDARIES) board_give_up("the path is longer than there is room for");
    shared->pcs[shared->length] = last_pc;
    shared->cycles[shared->length++] = last_cycle;
}

static void before(void)
{
    const uint16_t pc = (uint16_t)board.avr->pc;
    note(pc);
    records_seen = board.recorded;
    last_cycle = board.avr->cycle;
    last_pc = pc;
    if (is_known && run.is_armed && !run.is_in_path && pc == shared->pcs[0]) run.is_in_path = true;
    if (!run.is_in_path) return;
    shared->executed[pc / 2] = 1;
    if (run_boundary != NULL && pc != shared->pcs[shared->length - 1]) run_boundary();
    run.step++;
}

static void after(void)
{
    if (!run.is_armed) return;
    if (run.is_in_path) record_last();
    if (board.recorded == records_seen) return;
    const board_record_t *const record = &board.records[(board.recorded - 1) % BOARD_RECORDS];
    if (record->kind != CALLS_BEGIN && record->kind != CALLS_END) return;
    const bool ends = record->kind == CALLS_END;
    if (!ends) record_last();
    run.is_in_path = !ends;
    run.left[ends] = characters_left();
    *(ends ? &run.end_cycle : &run.begin_cycle) = board.avr->cycle;
    if (ends) run.is_armed = false;
    if (ends) run.has_ended = true;
}

static void interrupt(uint8_t vector)
{
    const uint8_t *const data = board.avr->data;
    const uint16_t top = (uint16_t)(data[R_SPL] | data[R_SPH] << 8);
    note((uint16_t)((data[top + 1] << 8 | data[top + 2]) * 2));
    for (uint8_t i = 0; i < run.raises; i++) {
        raised_t *const raised = &run.raised[i];
        if (!raised->has_raised || raised->has_entered) continue;
        if (!event_has_vector(raised->event, vector)) { /* of two that wait the other one is first */
            if (raised->raised_step == run.step) raised->could_enter = false;
            continue;
        }
        raised->has_entered = true;
        raised->entered_step = run.step;
        return;
    }
}

/* ---- a run ---- */

uint64_t slot_cycle(uint8_t slot)
{
    return slot < SLOTS_BEFORE
               ? shared->window_cycle + slot * (uint64_t)SLOT_CYCLES
               : shared->cycles[shared->length - 1] + 500 + (slot - SLOTS_BEFORE) * (uint64_t)SLOT_CYCLES;
}

/* The side's slots from window_cycle on. */
static void pass_window(const order_t *order, uint8_t first_slot, uint64_t window_cycle)
{
    for (uint8_t slot = first_slot; slot < first_slot + 2; slot++) {
        for (uint8_t i = 0; order != NULL && i < 2; i++)
            if (order->slots[i] == slot && order->events[i] != EVENT_NONE &&
                order->events[i] != EVENT_OVERFLOW)
                event_raise(order->events[i], i);
        run_to(window_cycle + (slot - first_slot + 1U) * (uint64_t)SLOT_CYCLES);
    }
}

static void ask(const scenario_t *scenario)
{
    volatile calls_t *const calls = image_calls();
    calls->length = scenario->length;
    calls->which = scenario->which;
    calls->flags = scenario->flags;
    calls->is_masked = scenario->is_masked;
    calls->baud = scenario->baud;
    calls->parity = scenario->parity;
    calls->stop_bits = scenario->stop_bits;
    calls->gather_us = scenario->gather_us;
    calls->time_us[0] = scenario->most_us;
    for (uint8_t i = 0; i < CALLS_BYTES; i++) calls->bytes[i] = (uint8_t)(0x61 + i);
    run.is_armed = true;
    image_call(scenario->call);
    if (!run.has_ended) hang("the path does not end");
    run.returned = *(calls_t *)(uintptr_t)calls;
    calls->is_masked = 0;
}

void scenario_run(const scenario_t *scenario, const order_t *order, uint64_t overflow_cycle,
                  event_t at_overflow)
{
    static const board_observer_t observer = {before, after, interrupt};
    memset(&run, 0, sizeof run);
    run.scenario = scenario;
    is_known = shared->length != 0;
    board.observer = &observer;
    truth_begin(scenario->zero_us);
    if (overflow_cycle != 0) {
        const uint64_t stall = truth_overflow_cycle() - overflow_cycle;
        board_stall(stall);
        if (order == NULL) {
            add(EVENT_OVERFLOW);
            avr_cycle_timer_register(board.avr, overflow_cycle + stall - board.avr->cycle, overflows_now,
                                     NULL);
        }
        if (at_overflow != EVENT_NONE)
            avr_cycle_timer_register(board.avr, overflow_cycle + stall - board.avr->cycle, raise_now,
                                     add(at_overflow));
    }
    if (scenario->prepare != NULL) scenario->prepare();
    image_run(100);
    const uint64_t window_cycle = board.avr->cycle;
    if (!is_known) shared->window_cycle = window_cycle;
    pass_window(order, 0, window_cycle);
    ask(scenario);
    image_run(500); /* more than the longest interrupts take */
    if (order != NULL) pass_window(order, SLOTS_BEFORE, board.avr->cycle);
    outcome_take();
}
