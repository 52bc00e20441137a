/* SPDX-License-Identifier: MIT */
#include "fathom/engine/fair_share.h"

/*
 * A policy of line_turns.h that shares the time of a line fairly. It counts the time that each unit used, and
 * holds a long request back for a fast unit.
 */

enum { NEVER_US = UINT16_MAX, HELD_PART = 8 };

static fathom_fair_share_unit_t *unit_of(fathom_fair_share_t *share, uint8_t address)
{
    return &share->units[address % FATHOM_FAIR_SHARE_UNITS];
}

static uint16_t at_most_16_bits(uint32_t us) { return (us > UINT16_MAX) ? UINT16_MAX : (uint16_t)us; }

/* Adds the time since the last count to the time that the unit used. Returns that time. */
static uint32_t bill(fathom_fair_share_t *share, fathom_fair_share_unit_t *unit, uint32_t now_us)
{
    const uint32_t passed_us = fathom_elapsed_us(now_us, share->since_us);
    share->since_us = now_us;
    unit->ahead_us += passed_us;
    return passed_us;
}

static void asked(fathom_line_turns_t *turns, uint8_t address, uint32_t at_us)
{
    fathom_fair_share_unit_t *const unit = unit_of((fathom_fair_share_t *)turns, address);
    unit->again_us = at_most_16_bits(fathom_elapsed_us(at_us, unit->ended_us));
}

static void ended(fathom_line_turns_t *turns, uint8_t address, uint32_t at_us)
{
    fathom_fair_share_t *const share = (fathom_fair_share_t *)turns;
    fathom_fair_share_unit_t *const unit = unit_of(share, address);
    unit->hold_us = at_most_16_bits(bill(share, unit, at_us) / HELD_PART);
    unit->ended_us = at_us;
}

/*
 * If the line is idle for a unit, that unit used the time. Otherwise no unit used the time, except for the silence
 * before the next request, which belongs to the unit of that request.
 */
static void count(fathom_fair_share_t *share, const fathom_line_t *line)
{
    const uint32_t now_us = line->polled_us;
    uint16_t silence_us = line->parts->silence_us;
    if (silence_us == 0u) silence_us = FATHOM_LINE_DEFAULT_SILENCE_US;
    if (share->held_for != NULL)
        (void)bill(share, share->held_for, now_us);
    else if (fathom_elapsed_us(now_us, share->since_us) > silence_us)
        share->since_us = now_us - silence_us;
    share->held_for = NULL;
}

static fathom_transaction_t *next(fathom_line_turns_t *turns, const fathom_line_t *line)
{
    fathom_fair_share_t *const share = (fathom_fair_share_t *)turns;
    fathom_fair_share_unit_t *best = NULL;
    fathom_transaction_t *chosen = NULL;
    count(share, line);
    for (fathom_transaction_t *x = line->head; x != NULL; x = x->link.next) {
        fathom_fair_share_unit_t *const unit = unit_of(share, x->address);
        if (fathom_line_is_quarantined(line, x->address) ||
            ((best != NULL) && (unit->ahead_us >= best->ahead_us)))
            continue;
        best = unit;
        chosen = x;
    }
    turns->wait_us = line->quarantine_left_us;
    if (best == NULL) return NULL;

    for (uint8_t i = 0; i != FATHOM_FAIR_SHARE_UNITS; i++) {
        fathom_fair_share_unit_t *const unit = &share->units[i];
        const uint32_t ended_us = fathom_elapsed_us(line->polled_us, unit->ended_us);
        if ((unit->ahead_us >= best->ahead_us) || (unit->again_us >= best->hold_us) ||
            (ended_us >= best->hold_us) || fathom_line_is_quarantined(line, i))
            continue;
        share->held_for = unit;
        turns->wait_us = best->hold_us - ended_us;
        return NULL;
    }
    const uint32_t least_us = best->ahead_us;
    for (uint8_t i = 0; i != FATHOM_FAIR_SHARE_UNITS; i++)
        (void)fathom_count_down(&share->units[i].ahead_us, least_us);
    return chosen;
}

void fathom_fair_share(fathom_fair_share_t *share, fathom_line_t *line)
{
    for (uint8_t i = 0; i != FATHOM_FAIR_SHARE_UNITS; i++) {
        share->units[i].ahead_us = 0;
        share->units[i].hold_us = 0;
        share->units[i].again_us = NEVER_US;
    }
    share->held_for = NULL;
    share->since_us = line->polled_us;
    share->turns.next = next;
    share->turns.asked = asked;
    share->turns.ended = ended;
    fathom_line_take_turns(line, &share->turns);
}
