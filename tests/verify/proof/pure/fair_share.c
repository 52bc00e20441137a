/* SPDX-License-Identifier: MIT */
/*
 * The share of a line's time: a line with any queue of up to three transactions, any quarantines and times. What of the
 * line it looks at is any; what it calls is called as fathom_line_turns does.
 *
 * proves: src/engine/fair_share.c src/engine/line_turns.c
 * with: src/engine/line_attempt.c
 * unreached: count_0
 * options: -eva-auto-loop-unroll 16
 */
#include "fathom/engine/fair_share.h"
#include "assumptions.h"

static fathom_line_t line;
static fathom_fair_share_t share;
static fathom_transaction_t transactions[3];

static void plain_scan(fathom_line_t *object, bool over) {}
static fathom_status_t plain_advance(fathom_line_t *object)
{
    return any_bool() ? FATHOM_PENDING : FATHOM_ERR_PORT;
}
static fathom_transaction_t *plain_next(const fathom_line_t *object) { return object->head; }
static uint32_t plain_due_us(const fathom_line_t *object) { return any_32(); }
static void plain_fail_all(fathom_line_t *object) {}

static const fathom_line_kind_t plain = {plain_scan, plain_advance, plain_next, plain_due_us, plain_fail_all};

/* A queue of 0 to 3, of any units. */
static void any_line(void)
{
    line.phase = any_8_in(FATHOM_LINE_IDLE, FATHOM_LINE_WAITING);
    line.wait = any_8_in(0, 3);
    line.phase_left_us = any_32();
    line.is_slow = any_bool();
    line.quarantined_units = any_16();
    line.polled_us = any_32();
    line.quarantine_left_us = any_32();
    line.head = NULL;
    for (uint8_t i = 0; i != 3; i++) {
        transactions[i].address = any_8();
        transactions[i].link.next = line.head;
        if (any_bool()) line.head = &transactions[i];
    }
}

int main(void)
{
    static fathom_line_parts_t config;
    config.silence_us = any_16();
    line.parts = &config;
    line.kind = &plain;
    any_line();
    fathom_fair_share(&share, &line);
    while (any_bool()) {
        any_line();
        (void)line.kind->advance(&line);
        (void)line.kind->next(&line);
        (void)line.kind->due_us(&line);
    }
    return 0;
}
