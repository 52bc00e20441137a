/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_LINE_INTERNAL_H
#define FATHOM_LINE_INTERNAL_H

#include "../common.h"
#include "fathom/engine/line_turns.h"

/*
 * What the sources of the line share. Programs do not include this file. src/engine/README.md lists the sources and
 * what each of them calls.
 */

/* The worst fault of what the unit has sent in an attempt, in increasing order. */
enum fault {
    FAULT_NONE = 0,
    FAULT_UNEXPECTED =
        1, /* A frame with a right checksum that is not the response. The response may still arrive. */
    FAULT_TRUNCATED = 2, /* A response seemed to begin and broke off. It may have been noise. */
    FAULT_CORRUPT = 3,   /* A response was complete, but its checksum was wrong. */
    FAULT_LOST = 4,      /* Bytes were dropped, and another master's request may have been among them. */
    FAULT_CLAIMED =
        5 /* Another master has sent the unit a request. From FAULT_LOST on no frame can be assigned. */
};

/* What has arrived of the echo of the newest request. */
enum copy {
    COPY_DUE = 0,      /* Neither the echo nor anything else has arrived. */
    COPY_HIDDEN = 1,   /* Bytes arrived that belong to no frame. The echo may be among them. */
    COPY_PAST = 2,     /* The echo has arrived, or it is known that there is none. */
    COPY_CANCELLED = 3 /* No request is on the wire, but the echo of a cancelled one may still arrive. */
};

/* Whether the bytes in the port may be too old, and what the listener knows of dropped bytes. */
enum age {
    AGE_KNOWN = 0, /* The bytes are not older than the pause between two polls. */
    AGE_LOST = 1,  /* Bytes were dropped, and the listener has not been notified yet. */
    AGE_OLD = 2,   /* All bytes are dropped until the port was seen empty. Added to one of the two above. */
    AGE_DROPPED = AGE_OLD + AGE_LOST
};

/* The silence before the next request, or before the request on the wire. */
enum wait {
    WAIT_NONE = 0,   /* No transaction waits, or the request on the wire was sent in a measured silence. */
    WAIT_NOISE = 1,  /* A transaction waits for silence, and no complete frame was heard since. */
    WAIT_FRAMES = 2, /* A transaction waits for silence, and a complete frame was heard since. */
    WAIT_SKIPPED = 3 /* The request on the wire was sent without a measured silence. */
};

/* Where in the present silence the line is. Only line_senders.c looks at this. */
enum slot {
    SLOT_OPEN = 0,         /* Nothing was sent in this silence. */
    SLOT_BEHIND_FRAME = 1, /* The last byte of this poll completed a frame, so a silence has begun. */
    SLOT_OVER = 2 /* A request could have been sent in this silence. Another device may start at any time. */
};

/* Whether a device sends by itself, and whether the program polls often enough to measure the silence behind it. */
enum sender {
    SENDER_NONE = 0,   /* No such device is known. */
    SENDER_QUICK = 1,  /* The program measures the silence. */
    SENDER_SLOW = 2,   /* The program polls too seldom to measure the silence. */
    SENDER_LOST_1 = 3, /* The same, and the last request behind a frame was lost. */
    SENDER_LOST_2 = 4  /* The same, and the last two or more requests behind a frame were lost. */
};

/* What the part for devices that send by themselves is notified of. */
enum sender_event {
    SENDER_BYTES,    /* `amount` bytes that belong to no transaction arrived. */
    SENDER_FRAME,    /* A complete frame that belongs to no transaction arrived, and no byte after it. */
    SENDER_ECHO,     /* The echo of our request arrived. */
    SENDER_RESPONSE, /* A transaction has accepted a frame. */
    SENDER_LOSS,     /* A request that was sent without a measured silence was not answered. */
    SENDER_PAUSE     /* This poll comes `amount` us after the previous one. */
};

/* The part for devices that send by themselves (line_senders.c). */
struct fathom_line_senders {
    void (*note)(fathom_line_t *line, uint8_t event, uint32_t amount);

    /* Returns the time until a request may leave if no byte arrives, counted from the last poll. */
    uint32_t (*slot_in_us)(const fathom_line_t *line);

    /* Uses up the slot of this silence. Returns false if `transaction`, which may be NULL, shall not use it. */
    bool (*take_slot)(fathom_line_t *line, const fathom_transaction_t *transaction);
};

/* The part for other masters (line_masters.c). */
struct fathom_line_masters {
    /* Looks for another master's request at the beginning of the frame buffer. `is_response` is true if a complete
     * response with a right checksum begins there. Returns the length of the request; more than `received_count` if
     * more bytes are needed; 0 if no such request begins there. */
    uint8_t (*find_request)(fathom_line_t *line, bool is_response);

    /* Bytes were dropped, and another master's request may have been among them. */
    void (*note_lost_bytes)(fathom_line_t *line);

    /* A complete frame of a unit arrived. Returns true if it may belong to another master. */
    bool (*take_answer)(fathom_line_t *line, uint8_t address);

    /* A complete frame arrived that no master had requested. */
    void (*note_unrequested)(fathom_line_t *line);
};

/* The largest value of `silent_us`. After this silence nothing is known about devices that send by themselves. */
enum { QUIET_US = UINT16_MAX };

/* Returns true if a transaction is on the wire. */
static inline bool is_busy(const fathom_line_t *line) { return line->phase >= FATHOM_LINE_SENDING; }

/* Returns true if the caller holds TX low, or the port has not released it yet. */
static inline bool is_in_break(const fathom_line_t *line)
{
    return (line->phase == FATHOM_LINE_IN_BREAK) || (line->phase == FATHOM_LINE_ENDING_BREAK);
}

static inline bool is_initialised(const fathom_line_t *line) { return line->kind != NULL; }

#ifdef FATHOM_HAS_ASSERT
/*
 * Returns a sum over the first members of the parts of a line: uart, clock, frame, frame_size. A build with FATHOM_ASSERT
 * compares it at each poll, because the parts of a line are often a local variable of a set-up function by mistake.
 */
static inline uint16_t sum_of_parts(const fathom_line_parts_t *parts)
{
    const uint8_t *const bytes = (const uint8_t *)parts;
    uint16_t sum = 0;
    for (size_t i = 0; i != offsetof(fathom_line_parts_t, echo); i++)
        sum = (uint16_t)((uint32_t)(sum * 31u) + bytes[i]);
    return sum;
}
#endif

static inline uint16_t silence_us(const fathom_line_t *line)
{
    const uint16_t us = line->parts->silence_us;
    const bool is_default = (us == 0u) || (line->is_slow && (us < FATHOM_LINE_DEFAULT_SILENCE_US));
    return is_default ? FATHOM_LINE_DEFAULT_SILENCE_US : us;
}

static inline uint32_t busy_us(const fathom_line_t *line)
{
    return or_default(line->parts->busy_us, FATHOM_LINE_DEFAULT_BUSY_US);
}

/* Returns true if the frame buffer holds bytes that the listener has not received, because they may be a response. */
static inline bool holds_bytes(const fathom_line_t *line)
{
    return line->received_count != line->passed_count;
}

/* Returns true if a transaction waits for silence. */
static inline bool is_waiting(const fathom_line_t *line)
{
    return (line->wait == WAIT_NOISE) || (line->wait == WAIT_FRAMES);
}

/*
 * In WAITING, `phase_left_us` is the time until a response that has begun must be complete:
 *
 *     [request]|<-------- timeout_us -------->|<-- FATHOM_LINE_FINISH_US -->|
 *              | a response may begin         | it may go on                | phase_left_us is 0
 */
static inline uint32_t response_left_us(const fathom_line_t *line)
{
    return rest_us(line->phase_left_us, FATHOM_LINE_FINISH_US);
}

/* Returns true if the time-out of the request on the wire has passed. */
static inline bool is_overtime(const fathom_line_t *line)
{
    return (line->phase == FATHOM_LINE_WAITING) && (response_left_us(line) == 0u);
}

/* Returns true if the request may be sent into noise. */
static inline bool may_collide(const fathom_transaction_t *transaction)
{
    const fathom_protocol_t *const protocol = transaction->protocol;
    return (protocol->may_collide != NULL) && protocol->may_collide(transaction);
}

static inline void set_silent(fathom_line_t *line, uint32_t us)
{
    line->silent_us = (us > QUIET_US) ? QUIET_US : (uint16_t)us;
}

/* Returns true if a request is on the wire to which a unit responds. */
static inline bool expects_response(const fathom_line_t *line) { return line->attempt.request_length != 0u; }

static inline bool is_from_unit_of(const fathom_transaction_t *transaction, uint8_t address)
{
    return (transaction->address == address) || (transaction->address == FATHOM_LINE_ANY_UNIT);
}

static inline bool is_echo_due(const fathom_line_t *line) { return line->attempt.copy == COPY_CANCELLED; }

/* Returns true if the request on the wire was sent to this unit. */
static inline bool expects_unit(const fathom_line_t *line, uint8_t address)
{
    return expects_response(line) && is_from_unit_of(line->head, address);
}

/* Keeps the worst fault of an attempt. */
static inline void note_fault(fathom_line_t *line, uint8_t fault)
{
    if (line->attempt.fault < fault) line->attempt.fault = fault;
}

/* ---- line.c ---- */

/* Adds to a counter, if the parts name fathom_line_count(). */
void fathom_line_add(fathom_line_t *line, uint8_t which, uint8_t by);

/* Notifies the part for devices that send by themselves, if the parts name it: an enum sender_event. */
void fathom_line_note_sender(fathom_line_t *line, uint8_t event, uint32_t amount);

/* As find_request of the part for other masters. Returns 0 if the parts do not name it. */
uint8_t fathom_line_find_request(fathom_line_t *line, bool is_response);

/* Initialises all members that both kinds of lines share. Returns FATHOM_ERR_ARGUMENT if the parts are refused. */
fathom_status_t fathom_line_begin(fathom_line_t *line, const fathom_line_parts_t *parts,
                                  const fathom_line_kind_t *kind);

/* Passes `length` bytes to the listener, or counts them if there is none. A length of 0 reports lost bytes. */
void fathom_line_pass(fathom_line_t *line, uint8_t from, uint8_t length);

/* Returns true if a byte of this age is no reading any more. */
bool fathom_line_is_old(const fathom_line_t *line, uint32_t age_us);

/* Return the time until an incomplete frame is over, and until a request may leave, if no byte arrives. Both are counted
 * from the last poll, in microseconds. */
uint32_t fathom_line_gap_left_us(const fathom_line_t *line);
uint32_t fathom_line_silence_left_us(const fathom_line_t *line);

/*
 * Returns the time until the bytes in the frame buffer are over, counted from the last poll. Bytes that may be a
 * response end at a gap. All others end at the silence: a gap may be longer than the pause between two frames.
 */
uint32_t fathom_line_frame_over_us(const fathom_line_t *line);

/* Handles a broken port: forgets the received bytes and ends all transactions. Always returns FATHOM_ERR_PORT. */
fathom_status_t fathom_line_broken(fathom_line_t *line);

/* ---- line_attempt.c ---- */

/* Returns the link that points to the transaction. If the transaction is not queued, returns the end of the queue. */
fathom_transaction_t **fathom_line_find(fathom_line_t *line, const fathom_transaction_t *transaction);

/* Ends the attempt on the wire, or the wait for a busy port. Keeps the invariant of `attempt` (line.h). */
void fathom_line_free_wire(fathom_line_t *line, uint8_t next_phase);

/* Removes a transaction from the queue and writes its result. If the transaction uses the wire, the wire is free. */
void fathom_line_finish(fathom_line_t *line, fathom_transaction_t **link, fathom_status_t status);

/* Returns the members of `quarantined_units` for an address. FATHOM_LINE_ANY_UNIT stands for all units. */
uint16_t fathom_line_units_of(uint8_t address);

/* Keeps the unit of the request on the wire in quarantine until its late response can no longer arrive. */
void fathom_line_quarantine(fathom_line_t *line);

/* Ends an attempt without a response. */
void fathom_line_end_attempt(fathom_line_t *line);

/* ---- line_due.c ---- */

/* Returns the time until the attempt ends if no byte arrives, counted from the last poll. The phase is WAITING. */
uint32_t fathom_line_attempt_left_us(const fathom_line_t *line);

/* ---- line_echo.c ---- */

/*
 * Returns true if the received bytes are the echo, or the beginning of it. `response_length` is the length of the
 * complete response frame with a right checksum at the beginning of the buffer, or 0.
 */
bool fathom_line_is_echo(const fathom_line_t *line, uint8_t response_length);

/* ---- line_response.c ---- */

/* fathom_line_kind_t::scan of a line that sends requests. */
void fathom_line_scan(fathom_line_t *line, bool is_over);

#endif
