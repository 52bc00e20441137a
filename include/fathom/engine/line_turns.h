/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_LINE_TURNS_H
#define FATHOM_LINE_TURNS_H

#include "fathom/engine/line.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a line does with what comes, and when: named by its init, so that only a line for requests links what sends. */
struct fathom_line_kind {
    /* Takes frames from the front of what was received, and drops what cannot begin one; `over`: the frame will not
     * be completed. */
    void (*scan)(fathom_line_t *line, bool over);
    /* Time has passed, and what has come was scanned; returns what poll returns. */
    fathom_status_t (*go_on)(fathom_line_t *line);
    /* Of the queue, which transaction goes next; NULL: none yet. */
    fathom_transaction_t *(*next)(const fathom_line_t *line);
    /* Where nothing is on the wire and something is queued: how long until it may leave. */
    uint32_t (*due_us)(const fathom_line_t *line);
    /* The port is broken: every transaction ends with that. NULL: there are none, this line only listens. */
    void (*give_up)(fathom_line_t *line);
};

/*
 * Who goes next on a line where several wait. A line by itself takes the first in the queue whose unit is not
 * quarantined; here that is left to a policy: fair_share.h is one, and a program may write its own. What a policy sees
 * of the queue is line->head and each link.next; line->polled_us is the time.
 */
typedef struct fathom_line_turns fathom_line_turns_t;
struct fathom_line_turns {
    fathom_line_kind_t kind; /* the line's, and first, so that one pointer is both */
    /*
     * Nothing is on the wire: which of the queue goes next? One whose unit is not quarantined; or NULL, none yet, and
     * wait_us is how long until that may change if nothing is submitted and nothing comes: line->quarantine_left_us
     * where all are. Called by poll and due_us, once or more often for one turn; it calls nothing else of the line but
     * fathom_line_is_quarantined.
     */
    fathom_transaction_t *(*next)(fathom_line_turns_t *turns, const fathom_line_t *line);
    /* A request of this unit was submitted at that time, while none of it (modulo 16) was in the queue. */
    void (*asked)(fathom_line_turns_t *turns, uint8_t address, uint32_t at_us);
    /* The attempt that was on the wire, of this unit, has ended by that time. */
    void (*ended)(fathom_line_turns_t *turns, uint8_t address, uint32_t at_us);
    uint32_t wait_us;

    /* the line's */
    const fathom_line_kind_t *plain;
    uint32_t polled_us; /* the time of the last poll */
    uint16_t waiting;   /* bit unit % 16: is in the queue */
    uint8_t address;    /* of the unit on the wire, if is_busy */
    bool is_busy;
};

/* From here on *turns, in the caller's memory and with `next`, `asked` and `ended` set, says who goes next. After
 * fathom_line_init, once; `turns` serves one line and outlives it. */
void fathom_line_take_turns(fathom_line_t *line, fathom_line_turns_t *turns);

/*
 * Is this unit quarantined? It is while a response of it may still come, which could be taken for the next one's; no
 * request is sent to it meanwhile. That ends with the response, or when twice the time-out has passed since the request
 * left. After a response that was damaged, but whole, it is what is left of the time-out. One deadline, the latest,
 * serves all units; those whose addresses are equal modulo 16 share a quarantine.
 */
bool fathom_line_is_quarantined(const fathom_line_t *line, uint8_t address);

#ifdef __cplusplus
}
#endif

#endif
