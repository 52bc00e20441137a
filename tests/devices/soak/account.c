/* SPDX-License-Identifier: MIT */
#include "rig.h"

/*
 * The books of a run. Each figure stands in two places that know nothing of each other: the port and the simulator
 * on one side, the counters of line, stream, unit and response on the other. Runs are so short that no counter stops
 * (16 bits).
 */

/* modbus_unit.h: after the third silence in a row one time-out, then two, four, eight, sixteen. */
enum { PATIENCE = 3, MAX_DOUBLINGS = 4 };
/* What ends up in the next turn of the loop, and the one after it; pauses and frames on the wire. */
enum { TURNS = 6, WIRE_US = 60000 };
/* stream.h: without gaps the frame under way is lost, the next one vouches for the one after it, which is given with
 * the first byte that follows. */
enum { FRAMES_WITHOUT_GAP = 4 };

static uint32_t longest_backoff_us(const rig_unit_t *unit)
{
    const uint32_t option_us = unit->rig->options.backoff_us;
    const uint32_t default_us = soak_facts[unit->setting].timeout_us << MAX_DOUBLINGS;
    return option_us != 0 ? option_us : default_us;
}

uint32_t rig_patience_us(const rig_unit_t *unit)
{
    const soak_facts_t *const facts = &soak_facts[unit->setting];
    const uint32_t slack_us = TURNS * unit->rig->loop_us + WIRE_US + facts->period_us;
    if (!soak_is_asked(unit->setting)) return facts->timeout_us + slack_us;
    const uint32_t attempts = (unit->rig->options.retries + 1u) * unit->rig->count;
    const uint32_t attempts_us = attempts * 2 * (facts->timeout_us + WIRE_US);
    return attempts_us + longest_backoff_us(unit) + slack_us;
}

uint32_t rig_recovery_us(const rig_unit_t *unit)
{
    const soak_facts_t *const facts = &soak_facts[unit->setting];
    const uint32_t slack_us = TURNS * unit->rig->loop_us + (uint32_t)facts->length * facts->char_us;
    /* what ends a frame there is a silence */
    if (facts->proof == SOAK_GAP) return facts->period_us + FATHOM_STREAM_DEFAULT_GAP_US + slack_us;
    if (facts->proof == SOAK_NO_GAP) return FRAMES_WITHOUT_GAP * facts->period_us + slack_us;
    /* The request that is out may be lost, and then the unit is quarantined, or left alone after several. */
    uint32_t wait_us = facts->timeout_us;
    const uint32_t timeouts_in_row = unit->timeouts_in_row + 1;
    if (timeouts_in_row >= PATIENCE) {
        const uint32_t doublings =
            timeouts_in_row - PATIENCE < MAX_DOUBLINGS ? timeouts_in_row - PATIENCE : MAX_DOUBLINGS;
        wait_us <<= doublings;
        if (wait_us > longest_backoff_us(unit)) wait_us = longest_backoff_us(unit);
        if (wait_us < facts->timeout_us) wait_us = facts->timeout_us;
    }
    const uint32_t attempts_us = 2 * facts->timeout_us * unit->rig->options.retries;
    for (uint8_t i = 0; i < unit->rig->count; i++) /* the others have their turn first */
        if (&unit->rig->units[i] != unit)
            wait_us += soak_facts[unit->rig->units[i].setting].response_us + WIRE_US;
    return attempts_us + facts->timeout_us + wait_us + facts->period_us + facts->response_us + WIRE_US +
           slack_us;
}

static void differ(rig_unit_t *unit, uint64_t a, uint64_t b)
{
    unit->totals.unaccounted += a > b ? a - b : b - a;
}

static void exceed(rig_unit_t *unit, uint64_t a, uint64_t most)
{
    if (a > most) unit->totals.unaccounted += a - most;
}

/* Every request has one outcome, and the driver has handed over every one. */
static void account_asked(rig_unit_t *unit)
{
    const fathom_modbus_unit_t *const counted = soak_unit_of(&unit->driver, unit->setting);
    const uint32_t outcomes = unit->responses + unit->failures;
    if (unit->rig->options.retries == 0)
        differ(unit, unit->requests, outcomes + (unit->is_open ? 1 : 0));
    else
        exceed(unit, outcomes, unit->requests);
    differ(unit, counted->failures, unit->failures);
    differ(unit, (uint64_t)counted->responses * soak_facts[unit->setting].probes, unit->samples);
    differ(unit, soak_implausible(&unit->driver, unit->setting), unit->refused);
    unit->totals.lost = unit->failures;
}

/* Every byte that the port gave is in a counter, and every frame that was found was read, refused or replaced by a
 * newer one. A frame that nothing has hit is lost only where a counter says so. */
static void account_stream(rig_unit_t *unit)
{
    const fathom_stream_t *const stream = soak_stream_of(&unit->driver, unit->setting);
    const uint16_t *const of_line = unit->rig->counters;
    const uint16_t *const counters = stream->counters;
    const uint64_t read = unit->totals.readings / soak_facts[unit->setting].probes + unit->refused;
    uint32_t seen = (uint32_t)counters[FATHOM_STREAM_MISSED] + of_line[FATHOM_LINE_OLD_BYTES];
    if (soak_facts[unit->setting].proof == SOAK_NO_GAP)
        seen += (uint32_t)counters[FATHOM_STREAM_AMBIGUOUS] + counters[FATHOM_STREAM_UNSURE];
    differ(unit, counters[FATHOM_STREAM_FRAMES], read + counters[FATHOM_STREAM_MISSED]);
    differ(unit, unit->rig->bytes_read + unit->rig->overruns_reported,
           (uint64_t)counters[FATHOM_STREAM_BYTES] + of_line[FATHOM_LINE_BAD_BYTES] +
               of_line[FATHOM_LINE_DROPPED_BYTES] + of_line[FATHOM_LINE_OLD_BYTES]);
    differ(unit, counters[FATHOM_STREAM_BYTES],
           (uint64_t)counters[FATHOM_STREAM_FRAMES] * stream->length + counters[FATHOM_STREAM_DROPPED_BYTES] +
               stream->undecided_count);
    exceed(unit, unit->clean_lost, seen);
    unit->totals.lost = unit->totals.transactions > read ? unit->totals.transactions - read : 0;
}

/* What the line has counted for all units together. */
static void account_line(rig_t *rig)
{
    const uint16_t *const counters = rig->counters;
    uint64_t requests = 0, responses = 0, open = 0;
    uint64_t failures = counters[FATHOM_LINE_NO_RESPONSES];
    failures += (uint64_t)counters[FATHOM_LINE_CHECKSUM_ERRORS] + counters[FATHOM_LINE_EXCEPTIONS];
    failures += (uint64_t)counters[FATHOM_LINE_MALFORMED] + counters[FATHOM_LINE_PORT_ERRORS];
    failures += (uint64_t)counters[FATHOM_LINE_BUSY_ATTEMPTS] + counters[FATHOM_LINE_OTHER_MASTERS];
    for (uint8_t i = 0; i < rig->count; i++) {
        requests += rig->units[i].requests;
        responses += rig->units[i].responses;
        open += rig->units[i].is_open ? 1 : 0;
    }
    differ(&rig->units[0], counters[FATHOM_LINE_RESPONSES], responses);
    if (rig->options.retries == 0)
        differ(&rig->units[0], requests, counters[FATHOM_LINE_RESPONSES] + failures + open);
    else
        exceed(&rig->units[0], requests, counters[FATHOM_LINE_RESPONSES] + failures + open);
}

void rig_account(rig_unit_t *unit)
{
    for (uint8_t kind = 1; kind < FATHOM_SIM_FAULT_END; kind++)
        unit->totals.hits[kind] = unit->fault.counters[kind];
    if (!soak_is_asked(unit->setting)) {
        account_stream(unit);
        return;
    }
    account_asked(unit);
    if (unit == &unit->rig->units[0]) account_line(unit->rig);
}

void rig_totals_add(rig_totals_t *a, const rig_totals_t *b)
{
    a->transactions += b->transactions;
    a->readings += b->readings;
    a->errors += b->errors;
    a->lost += b->lost;
    a->stuck += b->stuck;
    a->unaccounted += b->unaccounted;
    a->unexplained += b->unexplained;
    a->joint += b->joint;
    a->joint_full += b->joint_full;
    a->old += b->old;
    a->wrong_responses += b->wrong_responses;
    for (uint8_t i = 0; i < TRUTH_VERDICTS; i++) a->verdicts[i] += b->verdicts[i];
    for (uint8_t i = 0; i < FATHOM_SIM_FAULT_END; i++) a->hits[i] += b->hits[i];
}
