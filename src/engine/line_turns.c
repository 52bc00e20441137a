/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line_turns.h"

#include "line_internal.h"

static fathom_line_turns_t *turns_of(const fathom_line_t *line) { return (fathom_line_turns_t *)line->kind; }

/* Tells the policy what has happened since the last call. */
static fathom_line_turns_t *notify(const fathom_line_t *line)
{
    fathom_line_turns_t *const turns = turns_of(line);
    uint16_t waiting = 0;
    if (turns->is_busy && !is_busy(line)) turns->ended(turns, turns->address, line->polled_us);
    turns->is_busy = is_busy(line);
    for (const fathom_transaction_t *x = line->head; x != NULL; x = x->link.next) {
        const uint16_t bit = (uint16_t)(1u << (x->address & 15u));
        /* It was submitted after the last poll; and its driver polled right before that. */
        if (((turns->waiting | waiting) & bit) == 0u) turns->asked(turns, x->address, turns->polled_us);
        waiting |= bit;
    }
    turns->waiting = waiting;
    return turns;
}

static fathom_transaction_t *next(const fathom_line_t *line)
{
    fathom_line_turns_t *const turns = notify(line);
    return turns->next(turns, line);
}

static fathom_status_t go_on(fathom_line_t *line)
{
    fathom_line_turns_t *const turns = notify(line);
    const fathom_status_t status = turns->plain->go_on(line);
    (void)notify(line);
    if (line->head != NULL) turns->address = line->head->address;
    turns->polled_us = line->polled_us;
    return status;
}

static uint32_t due_us(const fathom_line_t *line)
{
    if (next(line) == NULL) return turns_of(line)->wait_us;
    return turns_of(line)->plain->due_us(line);
}

void fathom_line_take_turns(fathom_line_t *line, fathom_line_turns_t *turns)
{
    turns->plain = line->kind;
    turns->kind.scan = line->kind->scan;
    turns->kind.go_on = go_on;
    turns->kind.next = next;
    turns->kind.due_us = due_us;
    turns->kind.give_up = line->kind->give_up;
    turns->polled_us = line->polled_us;
    turns->waiting = 0;
    turns->is_busy = false;
    line->kind = &turns->kind;
}

bool fathom_line_is_quarantined(const fathom_line_t *line, uint8_t address)
{
    return (line->quarantined & quarantine_bits(address)) != 0u;
}
