/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_LINE_INSIDE_H
#define FATHOM_LINE_INSIDE_H

#include "fathom/line.h"

/* What the two halves of a line share: line.c has the queue, what goes out and what time brings about;
 * line_receive.c what comes in. For nobody else. */

/*
 * The state of the exchange at the head of the queue: how far it is, and what has gone wrong with its answer.
 */
enum {
    IDLE = 0,            /* nothing is on the wire */
    REFUSED = 1,         /* the port was too busy to take the request */
    SENDING = 2,         /* the port has taken it */
    LISTENING = 3,       /* it has left; the answer may come */
    PHASE = 3,           /* these two bits */
    DAMAGED = 4,         /* an answer came and was wrong from end to end */
    TORN = 8,            /* an answer seemed to begin and broke off */
    SPOILT = 12,         /* either: nothing more is to be expected than the rest of it */
    ANSWERED_WRONG = 16, /* the unit sent something else; the answer may still come */
    NOISY = 32,          /* bytes came that nobody took */
    ECHOED = 64          /* the request came back */
};

/* fathom_line_t.known */
enum {
    AFTER_GAP = 1,  /* of the listener's; before the first byte in the frame */
    ECHO_SHIFT = 1, /* fathom_line_echo() */
    ECHO_KNOWN = 6,
    ECHO_DUE = 8,  /* the request that was cancelled may still come back */
    IN_BREAK = 16, /* the host holds the line low */
    ENDING = 32,   /* no longer, but for the port, which has left_us to let it go */
    COMPANY = 64,  /* others send here too, unasked; forgotten after a silence of QUIET_US */
    LATE = 128     /* since they did, there has been time for a request: the next one may come any time */
};

/* So many unasked bytes are no glitch: the shortest frame of all protocols here, FF .. SUM. And as much
 * as silent_us can tell. */
enum { LEAST_COMPANY = 4, QUIET_US = UINT16_MAX };

static inline uint8_t phase(const fathom_line_t *line) { return line->state & PHASE; }

static inline bool is_answered(const fathom_exchange_t *exchange)
{
    return exchange->unit != FATHOM_LINE_ALL_UNITS;
}

static inline uint16_t gap_us(const fathom_line_t *line)
{
    const uint16_t us = line->config->gap_us;
    return us != 0 ? us : FATHOM_LINE_DEFAULT_GAP_US;
}

static inline void set_silent(fathom_line_t *line, uint32_t us)
{
    line->silent_us = us > UINT16_MAX ? UINT16_MAX : (uint16_t)us;
}

/* Has the line been silent for as long as the listener wants to know of? */
static inline bool is_listeners_gap(const fathom_line_t *line)
{
    return line->listener != NULL && line->silent_us >= line->listener->gap_us;
}

/* Looks at the clock and lets the time since the look before pass; returns how long that was. Inline, since most polls
 * do little else. */
static inline uint32_t look(fathom_line_t *line)
{
    const fathom_clock_t *const clock = line->config->clock;
    const uint32_t now_us = clock->now_us(clock->ctx);
    const uint32_t passed_us = fathom_elapsed_us(now_us, line->polled_us);
    line->polled_us = now_us;
    if (line->owing != 0 && fathom_run_down(&line->owed_us, passed_us)) line->owing = 0;
    fathom_run_down(&line->left_us, passed_us);
    return passed_us;
}

void fathom_line_look(fathom_line_t *line);

/* The bits of `owing` for a unit; all of them for any unit. */
uint16_t fathom_line_owing_bits(uint8_t unit);

/* *link leaves the queue; if it was on the wire, the wire is free. */
void fathom_line_finish(fathom_line_t *line, fathom_exchange_t **link, int8_t status);

/*
 * The exchange on the wire may still be answered: its unit is asked nothing until twice the time-out has
 * passed since the request left. What broke off may have been noise, and the answer late; what was damaged
 * from end to end hardly was, so that after it the rest of the time-out is enough.
 */
void fathom_line_owe(fathom_line_t *line);

/* The attempt on the wire has failed. */
void fathom_line_fail(fathom_line_t *line);

/* Adds to a counter. */
void fathom_line_count(fathom_line_t *line, uint8_t which, uint8_t by);

/*
 * One read of the port, to the end of the frame: how many bytes, with LOST where some were lost before them and BAD
 * where they are wrong; 0, or < 0 when the port is broken. A silence is known only where a read found nothing: then it
 * is the caller's to count. What a read brings may have come at any time since the one before.
 */
enum { COUNT_READ = 0x0FF, LOST = 0x100, BAD = 0x200 };
int fathom_line_read(fathom_line_t *line);

/*
 * Takes frames from the front of what was received, and drops what cannot begin one; `over`: nothing more will
 * come to complete a frame.
 */
void fathom_line_scan(fathom_line_t *line, bool over);

/* After a read that was marked LOST or BAD, and after what had come before it, `had` bytes, was scanned as over: how
 * many of the bytes are to be kept, which now stand at the front. */
uint8_t fathom_line_lose(fathom_line_t *line, uint8_t had, int came);

#endif
