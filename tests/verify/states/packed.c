/* SPDX-License-Identifier: MIT */
#include "world.h"

#include <stdlib.h>
#include <string.h>

/*
 * A state as bytes. Times are what is left or what has passed, never the clock; those that have passed every length that
 * is compared with them are one value. Pointers are numbers. What the line does not look at again is left out: a
 * time-out that runs for nothing, bytes behind those that it has.
 *
 * unpack sets the line to what stands here and the clock to the end of its range, so that each step wraps it.
 */

enum { QUIET_US = UINT16_MAX, SHORT = 200, IS_QUIET = 255, IS_LONG = 255 };

/* fathom_line_t.state is a phase in these bits; there no time-out runs (src/engine/line_internal.h). */
enum { LEAVING_ON = 3 };

/* Of fathom_line_t.known, what the listener alone is told (src/engine/line_internal.h). */
enum { AFTER_GAP = 8 };

/* Silence beyond all that it is compared with, but 65 ms. */
static int most_silence(void)
{
    const int most = options.silence > options.gap ? options.silence : options.gap;
    return most + 1 + (options.stream != 0);
}

static uint8_t short_of(uint32_t us)
{
    if (us > SHORT && us < FATHOM_LINE_SEND_US / 2) {
        fprintf(stderr, "a time of %lu us has no place in a state\n", (unsigned long)us);
        exit(2);
    }
    return us > SHORT ? IS_LONG : (uint8_t)us;
}

void pack(uint8_t *at)
{
    const uint8_t *const begin = at;
    const fathom_line_t *const line = &world.line;
    memset(at, 0, PACKED);
    *at++ = line->state;
    *at++ = line->have;
    *at++ = line->need;
    *at++ = options.stream ? line->known : (uint8_t)(line->known & ~AFTER_GAP);
    *at++ = line->sent;
    *at++ = (uint8_t)line->quarantined; /* units 1 and 2 */
    *at++ = (uint8_t)(line->quarantined >> 8);
    *at++ = line->silent_us == QUIET_US        ? IS_QUIET
            : line->silent_us > most_silence() ? (uint8_t)most_silence()
                                               : (uint8_t)line->silent_us;
    *at++ = line->state >= LEAVING_ON ? short_of(line->left_us) : 0;
    *at++ = line->quarantined != 0 ? short_of(line->quarantine_left_us) : 0;
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
    *at++ = world.rx_length;
    memcpy(at, world.rx, world.rx_length);
    at += world.rx_length;
    memcpy(at, world.frame, line->have);
    at += line->have;
    if (at - begin > PACKED) abort();
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
    line->state = *at++;
    line->have = *at++;
    line->need = *at++;
    line->known = *at++;
    line->sent = *at++;
    line->quarantined = *at++;
    line->quarantined = (uint16_t)(line->quarantined | *at++ << 8);
    line->silent_us = *at == IS_QUIET ? QUIET_US : *at;
    at++;
    line->left_us = *at == IS_LONG ? FATHOM_LINE_SEND_US : *at;
    at++;
    line->quarantine_left_us = *at == IS_LONG ? FATHOM_LINE_SEND_US : *at;
    at++;
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
    world.rx_length = *at++;
    memcpy(world.rx, at, world.rx_length);
    at += world.rx_length;
    memcpy(world.frame, at, line->have);
    world.now_us = UINT32_MAX;
    line->polled_us = world.now_us - world.passed;
}
