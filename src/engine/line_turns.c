/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line_turns.h"

#include "line_internal.h"

/*
 * A line whose next transaction is chosen by a policy. The policy replaces the functions of the line by its own, which
 * report each request and each end of an attempt and then call the functions of the plain line.
 */

static fathom_line_turns_t *turns_of(const fathom_line_t *line) { return (fathom_line_turns_t *)line->kind; }

/* Reports to the policy which requests were submitted and which attempt has ended since the last call. */
static fathom_line_turns_t *notify(const fathom_line_t *line)
{
    fathom_line_turns_t *const turns = turns_of(line);
    uint16_t waiting = 0;
    if (turns->is_busy && !is_busy(line)) turns->ended(turns, turns->address, line->polled_us);
    turns->is_busy = is_busy(line);
    for (const fathom_transaction_t *x = line->head; x != NULL; x = x->link.next) {
        const uint16_t bit = (uint16_t)(1u << (x->address % 16u));
        /* The request was submitted after the last poll; its driver polls directly before it submits. */
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

static fathom_status_t advance(fathom_line_t *line)
{
    fathom_line_turns_t *const turns = notify(line);
    const fathom_status_t status = turns->plain->advance(line);
    (void)notify(line);
    if (line->head != NULL) turns->address = line->head->address;
    turns->polled_us = line->polled_us;
    return status;
}

static uint32_t due_us(const fathom_line_t *line)
{
    if (next(line) != NULL) return turns_of(line)->plain->due_us(line);
    return is_waiting(line) ? least_us(turns_of(line)->wait_us, line->phase_left_us)
                            : turns_of(line)->wait_us;
}

void fathom_line_take_turns(fathom_line_t *line, fathom_line_turns_t *turns)
{
    turns->plain = line->kind;
    turns->kind.scan = line->kind->scan;
    turns->kind.advance = advance;
    turns->kind.next = next;
    turns->kind.due_us = due_us;
    turns->kind.fail_all = line->kind->fail_all;
    turns->polled_us = line->polled_us;
    turns->waiting = 0;
    turns->is_busy = false;
    line->kind = &turns->kind;
}
