/* SPDX-License-Identifier: MIT */
#include "world.h"

#include "line_internal.h"

#include <stdlib.h>
#include <string.h>

/*
 * A state as bytes. Times are what is left or what has passed, never the clock; those that have passed every length that
 * is compared with them are one value. Pointers are numbers. What the line does not look at again is left out: a
 * time-out that runs for nothing, bytes behind those that it has.
 *
 * unpack sets the line to what stands here and the clock to the end of its range, so that each step wraps it.
 */

enum { MOST_SILENCE_US = UINT16_MAX, SHORT = 200, IS_QUIET = 255, IS_LONG = 255, NO_UNIT = 254 };

/* In WAITING `phase_left_us` is the time-out and FATHOM_LINE_FINISH_US. Its value here is so much more than 0 where the
 * time-out ends. */
enum { TIME_OUT_ENDS = 100 };

/* The facts of the line, one bit each. */
enum { AFTER_GAP = 1, ANSWERED = 2, AGE = 4 };

static uint8_t facts_of(const fathom_line_t *line)
{
    int facts = 0;
    if (line->is_after_gap && options.stream) facts |= AFTER_GAP; /* Only the listener gets it. */
    if (line->is_answered && line->awaited_left_us != 0u) facts |= ANSWERED;
    return (uint8_t)(facts | line->age * AGE);
}

static void set_facts(fathom_line_t *line, uint8_t facts)
{
    line->is_after_gap = (facts & AFTER_GAP) != 0;
    line->age = facts / AGE;
    line->is_answered = (facts & ANSWERED) != 0;
}

/* Silence beyond all that it is compared with, but 65 ms. */
static int most_silence(void)
{
    const int most = options.silence > options.gap ? options.silence : options.gap;
    return most + 1 + (options.stream != 0);
}

static uint8_t short_of(uint32_t us)
{
    if (us > SHORT * TICK_US && us < FATHOM_LINE_SEND_US / 2) {
        fprintf(stderr, "a time of %lu us has no place in a state\n", (unsigned long)us);
        exit(2);
    }
    return us > SHORT * TICK_US ? IS_LONG : (uint8_t)(us / TICK_US);
}

/* What is known of the echo, while a request is on the wire or was cancelled there (enum copy of line_internal.h). */
static uint8_t copy_of(const fathom_line_t *line)
{
    return is_busy(line) || is_echo_due(line) ? line->attempt.copy : (uint8_t)COPY_PAST;
}

/* The time that is left in a phase that has one. */
static uint8_t phase_left_of(const fathom_line_t *line)
{
    if (line->phase == FATHOM_LINE_WAITING) {
        const uint32_t from_us = FATHOM_LINE_FINISH_US - TIME_OUT_ENDS * TICK_US;
        if (line->phase_left_us < from_us || line->phase_left_us > from_us + SHORT * TICK_US) {
            fprintf(stderr, "a response of %lu us has no place in a state\n",
                    (unsigned long)line->phase_left_us);
            exit(2);
        }
        return (uint8_t)((line->phase_left_us - from_us) / TICK_US);
    }
    return line->phase >= FATHOM_LINE_DRAINING || is_waiting(line) ? short_of(line->phase_left_us) : 0;
}

void pack(uint8_t *at)
{
    const uint8_t *const begin = at;
    const fathom_line_t *const line = &world.line;
    memset(at, 0, PACKED);
    *at++ = line->phase;
    *at++ = line->received_count;
    *at++ = line->attempt.request_length;
    *at++ = line->attempt.fault;
    *at++ = copy_of(line);
    *at++ = line->wait;
    *at++ = line->echo;
    *at++ = line->passed_count;
    *at++ = (uint8_t)(line->unsolicited_count | line->unrequested_count << 4);
    *at++ = (uint8_t)(line->slot | line->sender << 4);
    *at++ = facts_of(line);
    *at++ = line->awaited_left_us != 0u ? line->awaited_unit : (uint8_t)NO_UNIT;
    *at++ = short_of(line->awaited_left_us);
    *at++ = (uint8_t)line->quarantined_units; /* units 1 and 2 */
    *at++ = (uint8_t)(line->quarantined_units >> 8);
    *at++ = line->silent_us == MOST_SILENCE_US           ? IS_QUIET
            : line->silent_us > most_silence() * TICK_US ? (uint8_t)most_silence()
                                                         : (uint8_t)(line->silent_us / TICK_US);
    *at++ = phase_left_of(line);
    *at++ = line->quarantined_units != 0 ? short_of(line->quarantine_left_us) : 0;
    *at++ = line->protocol != NULL;
    uint8_t *const order = at;
    at += TRANSACTIONS;
    int i = 0;
    for (const fathom_transaction_t *x = line->head; x != NULL; x = x->link.next) {
        if (i == TRANSACTIONS) abort();
        order[i++] = (uint8_t)((const fathom_modbus_request_t *)x - world.requests + 1);
        *at++ = x->attempts;
    }
    at = order + 2 * TRANSACTIONS;
    *at++ = world.leaving;
    for (i = 0; i != TICKETS; i++) {
        const ticket_t *const ticket = &world.tickets[i];
        *at++ = (uint8_t)(ticket->stage | ticket->transaction << 3 | ticket->flags << 5);
        *at++ = (uint8_t)(ticket->age | (ticket->flags & 8) << 4);
    }
    *at++ = world.quiet;
    *at++ = (uint8_t)(world.came | world.is_news << 7);
    *at++ = world.due;
    *at++ = world.passed;
    *at++ = world.others;
    *at++ = world.waited;
    *at++ = (uint8_t)(world.asked | world.asked_age << 4);
    *at++ = (uint8_t)(world.has_spoken | world.has_frame << 1);
    *at++ = world.rx_length;
    memcpy(at, world.rx, world.rx_length);
    at += world.rx_length;
    memcpy(at, world.frame, line->received_count);
    at += line->received_count;
    if (at - begin > PACKED) abort();
}

static uint32_t long_of(uint8_t ticks)
{
    return ticks == IS_LONG ? FATHOM_LINE_SEND_US : ticks * (uint32_t)TICK_US;
}

static const fathom_protocol_t *protocol_used; /* the client's: its own, so it is learnt */

void unpack(const uint8_t *at)
{
    static world_t empty;
    static bool is_made;
    if (!is_made) {
        /* The clients keep their tables to themselves: a submit names it. */
        world_begin();
        empty = world;
        for (int i = 0; i != TRANSACTIONS && protocol_used == NULL; i++) {
            if (!there_is(i)) continue;
            (void)world_submit(i);
            protocol_used = world.requests[i].transaction.protocol;
        }
        is_made = true;
    }
    world = empty;
    fathom_line_t *const line = &world.line;
    line->phase = *at++;
    line->received_count = *at++;
    line->attempt.request_length = *at++;
    line->attempt.fault = *at++;
    line->attempt.copy = *at++;
    line->wait = *at++;
    line->echo = *at++;
    line->passed_count = *at++;
    line->unsolicited_count = *at & 15;
    line->unrequested_count = *at++ >> 4;
    line->slot = *at & 15;
    line->sender = *at++ >> 4;
    set_facts(line, *at++);
    line->awaited_unit = *at++;
    line->awaited_left_us = long_of(*at++);
    line->quarantined_units = *at++;
    line->quarantined_units = (uint16_t)(line->quarantined_units | *at++ << 8);
    line->silent_us = *at == IS_QUIET ? MOST_SILENCE_US : (uint16_t)(*at * TICK_US);
    at++;
    line->phase_left_us = line->phase == FATHOM_LINE_WAITING
                              ? FATHOM_LINE_FINISH_US - TIME_OUT_ENDS * TICK_US + *at * (uint32_t)TICK_US
                              : long_of(*at);
    at++;
    line->quarantine_left_us = long_of(*at++);
    line->protocol = *at++ != 0 ? protocol_used : NULL;
    fathom_transaction_t **link = &line->head;
    for (int i = 0; i != TRANSACTIONS && at[i] != 0; i++) {
        fathom_transaction_t *const x = &world.requests[at[i] - 1].transaction;
        fill_in(at[i] - 1);
        x->protocol = protocol_used;
        x->address = address_of(at[i] - 1);
        x->attempts = at[TRANSACTIONS + i];
        x->status = FATHOM_PENDING;
        *link = x;
        link = &x->link.next;
    }
    at += 2 * TRANSACTIONS;
    world.leaving = *at++;
    for (int i = 0; i != TICKETS; i++) {
        ticket_t *const ticket = &world.tickets[i];
        ticket->stage = *at & 7;
        ticket->transaction = *at >> 3 & 3;
        ticket->flags = (uint8_t)(*at++ >> 5);
        ticket->age = *at & 0x7F;
        ticket->flags = (uint8_t)(ticket->flags | (*at++ >> 7) << 3);
    }
    world.quiet = *at++;
    world.came = *at & 0x7F;
    world.is_news = *at++ >> 7;
    world.due = *at++;
    world.passed = *at++;
    world.others = *at++;
    world.waited = *at++;
    world.asked = *at & 15;
    world.asked_age = *at++ >> 4;
    world.has_spoken = *at & 1;
    world.has_frame = *at++ >> 1;
    world.rx_length = *at++;
    memcpy(world.rx, at, world.rx_length);
    at += world.rx_length;
    memcpy(world.frame, at, line->received_count);
    world.now_us = UINT32_MAX;
    line->polled_us = world.now_us - world.passed * (uint32_t)TICK_US;
}
