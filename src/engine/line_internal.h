/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_LINE_INTERNAL_H
#define FATHOM_LINE_INTERNAL_H

#include "../common.h"
#include "fathom/engine/line_turns.h"

/*
 * What the sources of a line share, and no user needs. line.c is every line's, and line_listening.c that of one which
 * only listens. line_request.c has the queue, line_send.c what goes out, line_response.c what comes in. The others are
 * what a config names: line_marks.c, line_find_echo.c, line_count.c.
 */

/* What the line does; and what has gone wrong with the response to the transaction at the head of the queue. */
enum {
    IDLE = 0,
    IN_BREAK = 1,             /* the host holds the line low */
    ENDING = 2,               /* no longer, but for the port, which has left_us to let it go */
    LEAVING = 3,              /* a request that was cancelled still leaves */
    REFUSED = 4,              /* the port was too busy to take the request */
    SENDING = 5,              /* the port has taken it: from here on a transaction is on the wire */
    LISTENING = 7,            /* it has left; the response may come */
    PHASE = 7,                /* these bits */
    RESPONSE_CORRUPT = 8,     /* a response came and was wrong from end to end */
    RESPONSE_TRUNCATED = 16,  /* a response seemed to begin and broke off */
    RESPONSE_BAD = 24,        /* either: nothing more is expected than the rest of it */
    RESPONSE_UNEXPECTED = 32, /* the unit sent something else; the response may still come */
    NOISY = 64,               /* bytes came that were not taken */
    ECHOED = 128              /* the request came back, or is known not to */
};

/* fathom_line_t.known */
enum {
    ECHO = 3,      /* fathom_line_echo() */
    ECHO_DUE = 4,  /* the request that was cancelled may still come back */
    AFTER_GAP = 8, /* of the listener: before the first byte in the frame there was a gap, or a response */
    LATE = 16,     /* since the last byte there has been time for a request: a frame may come any time */
    ONE_UNASKED = 32,
    UNASKED = 96, /* so many bytes since the last response belonged to no transaction */
    /* There were four, no glitch but the shortest frame of all protocols here: a device sends by itself; forgotten
     * after a silence of QUIET_US. */
    OTHERS_SEND = 128
};

/* As much as silent_us can hold. */
enum { QUIET_US = UINT16_MAX };

static inline uint8_t phase(const fathom_line_t *line) { return line->state & PHASE; }

/* Is a transaction on the wire? */
static inline bool is_busy(const fathom_line_t *line) { return line->state >= SENDING; }

static inline uint16_t gap_us(const fathom_line_t *line)
{
    return (uint16_t)or_default(line->config->gap_us, FATHOM_LINE_DEFAULT_GAP_US);
}

static inline uint16_t silence_us(const fathom_line_t *line)
{
    return (uint16_t)or_default(line->config->silence_us, FATHOM_LINE_DEFAULT_SILENCE_US);
}

static inline void set_silent(fathom_line_t *line, uint32_t us)
{
    line->silent_us = (us > UINT16_MAX) ? UINT16_MAX : (uint16_t)us;
}

static inline void count(fathom_line_t *line, uint8_t which, uint8_t by)
{
    if (line->config->count != NULL) line->config->count(line, which, by);
}

static inline void forget(fathom_line_t *line, unsigned what) { line->known &= (uint8_t)~what; }

/* Is the transaction at the head on the wire, and one that a unit responds to? */
static inline bool expects_response(const fathom_line_t *line) { return line->sent != 0u; }

/* The bits of `quarantined` for a unit; all of them for any unit. */
static inline uint16_t quarantine_bits(uint8_t address)
{
    return (uint16_t)((address == FATHOM_LINE_ANY_UNIT) ? UINT16_MAX : (1u << (address & 15u)));
}

/* A device sends by itself, and there has been time for a request. */
static inline bool is_late(const fathom_line_t *line)
{
    return (line->known & (LATE | OTHERS_SEND)) == (LATE | OTHERS_SEND);
}

/* Looks at the clock and lets the time since the look before pass; returns how long that was. */
uint32_t fathom_line_look(fathom_line_t *line);

/* fathom_line_init and _init_listening, but for what the two do not share. */
fathom_status_t fathom_line_begin(fathom_line_t *line, const fathom_line_config_t *config,
                                  const fathom_line_kind_t *kind);

/* The first `length` bytes leave the frame, to the listener; with 0 it is called for lost bytes. */
void fathom_line_leave(fathom_line_t *line, uint8_t length);

/* The first `length` bytes of the frame are done with. */
void fathom_line_drop(fathom_line_t *line, uint8_t length);

fathom_status_t fathom_line_broken(fathom_line_t *line);

/* Where the transaction is linked, or the end of the queue. */
fathom_transaction_t **fathom_line_find(fathom_line_t *line, const fathom_transaction_t *transaction);

/* *link leaves the queue; if it was on the wire, the wire is free. */
void fathom_line_finish(fathom_line_t *line, fathom_transaction_t **link, fathom_status_t status);

/* The line is free and has been silent: the next transaction leaves. A source of its own, so that a poll which sends
 * nothing saves no registers for it. What poll returns. */
fathom_status_t fathom_line_send(fathom_line_t *line);

/* fathom_line_kind_t.scan of a line for requests. */
void fathom_line_scan_responses(fathom_line_t *line, bool over);

/* Is a response of this unit waited for? */
bool fathom_line_expects_unit(const fathom_line_t *line, uint8_t address);

/*
 * A whole frame: is it taken? By the transaction on the wire as its response; or, from a quarantined unit, by a
 * transaction that waits for a retry. A response with nothing but whole frames before it shows that there is no echo.
 */
bool fathom_line_deliver(fathom_line_t *line);

/* The attempt on the wire is over: it has failed, but for a broadcast. */
void fathom_line_end_attempt(fathom_line_t *line);

/* What has come shows whether there is an echo. */
void fathom_line_learn(fathom_line_t *line, uint8_t echo);

#endif
