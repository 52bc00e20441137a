/* SPDX-License-Identifier: MIT */
#include "host.h"

#include <string.h>

/* ATmega328P 36, in data space. */
enum { PORTB = 0x25, DDRD = 0x2A, PORTD = 0x2B };

/* What the times of an interrupt may be off by: int0 by the interrupts that ran before it, icp1 by a tick, but for an
 * edge that came in its own interrupt (fathom_avr.h). */
enum { INT0_US = 45, ICP1_US = 1, SHORT_US = 60 };

static void add(uint8_t value)
{
    outcome_t *const outcome = &run.outcome;
    if (outcome->log_length < LOG) outcome->log[outcome->log_length++] = value;
}

static uint32_t apart(uint32_t a_us, uint32_t b_us)
{
    const uint32_t apart_us = a_us - b_us;
    return apart_us < UINT32_C(0x80000000) ? apart_us : b_us - a_us;
}

/* Which of the pulses at that pin it is. */
static uint8_t pulse_of(uint8_t which, uint32_t width_us, uint32_t end_us)
{
    for (uint8_t i = 0; i + 1 < truth.edges[which]; i = (uint8_t)(i + 2)) {
        const uint32_t rise_us = truth_us(truth.edge_cycles[which][i]);
        const uint32_t fall_us = truth_us(truth.edge_cycles[which][i + 1]);
        const bool is_exact = which == 1 && fall_us - rise_us > SHORT_US &&
                              (i == 0 || rise_us - truth_us(truth.edge_cycles[which][i - 1]) > SHORT_US);
        const uint32_t most_us = is_exact ? ICP1_US : INT0_US;
        if (apart(width_us, fall_us - rise_us) <= most_us && apart(end_us, fall_us) <= most_us) return i / 2;
    }
    return NO_PULSE;
}

/* The level counts where there was no pulse; else rules.c looks at it. */
static void add_take(const calls_t *taken)
{
    add((uint8_t)taken->result);
    if (taken->result == 1 && scenario_begins())
        add(0); /* both pins feed one side */
    else if (taken->result == 1)
        add(pulse_of(taken->which, taken->time_us[0], taken->time_us[1]));
    else
        add(taken->is_high);
}

static void add_read(const calls_t *read)
{
    add((uint8_t)read->result);
    add(read->flags);
    for (int i = 0; i < read->result && i < CALLS_BYTES; i++) add(read->bytes[i]);
}

static void read_the_rest(void)
{
    volatile calls_t *const calls = image_calls();
    do {
        calls->length = CALLS_BYTES;
        image_call(CALL_READ);
        add_read((const calls_t *)(uintptr_t)calls);
    } while (calls->result > 0);
}

static void take_the_rest(uint8_t which)
{
    volatile calls_t *const calls = image_calls();
    do {
        calls->which = which;
        image_call(CALL_TAKE);
        add_take((const calls_t *)(uintptr_t)calls);
    } while (calls->result > 0);
}

/* avr-gcc lays fathom_edges_t out without padding: 4 pulses of 9 bytes, a time of 4, then lost, missed and is_high. A rise
 * that was fed and has not fallen again shows in is_high. */
static void look_at_edges(uint8_t which)
{
    enum { SIDE = 51 + 250, LOST = 40, MISSED = 41, IS_HIGH = 42 };
    const uint8_t *const edges = board_data("sides") + which * SIDE;
    run.outcome.rises[which] = edges[IS_HIGH];
    run.outcome.lost[which] = edges[LOST];
    run.outcome.missed[which] = edges[MISSED];
}

void outcome_take(void)
{
    outcome_t *const outcome = &run.outcome;
    memset(outcome, 0, sizeof *outcome);
    const uint8_t call = run.scenario->call;
    board.observer = NULL; /* what comes now is no part of it */
    if (call != CALL_NOW && call != CALL_LEAVES && call != CALL_IDLE) outcome->result = run.returned.result;
    if (call == CALL_READ) add_read(&run.returned);
    if (call == CALL_TAKE) add_take(&run.returned);
    while (usart_hurry(&board.usart)) image_run(400);
    read_the_rest();
    take_the_rest(0);
    take_the_rest(1);
    image_call(CALL_SENT);
    outcome->is_sent = (uint8_t)image_calls()->result;
    memcpy(outcome->counters, board_data("fathom_avr_usart0_counters"), sizeof outcome->counters);
    for (uint32_t i = 0; i < board.bytes_seen; i++)
        if (board.bytes[i].from_here && outcome->wire_length < MOST_SENT)
            outcome->wire[outcome->wire_length++] = board.bytes[i].byte;
    outcome->driver_edges = (uint8_t)board.driver_edges_seen;
    look_at_edges(0);
    look_at_edges(1);
    outcome->port_b = board.avr->data[PORTB];
    outcome->port_d = board.avr->data[PORTD];
    outcome->direction_d = board.avr->data[DDRD];
}
