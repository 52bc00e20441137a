/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_STATES_WORLD_H
#define FATHOM_TESTS_STATES_WORLD_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "fathom/engine/dyp_client.h"
#include "fathom/engine/line_turns.h"
#include "fathom/engine/modbus_client.h"

/*
 * A small world: one line, two units, two transactions of each, a port, and what is known besides of who was asked what.
 * Its clock goes on by ticks of TICK_US, and silence, gap and time-outs are a few of them, so that each moment is a state of
 * its own: "exactly then", "one before" and "one after" are all there.
 */
enum { UNITS = 2, TRANSACTIONS = 4, TICKETS = 4, FRAME = 13, RX = 23, OTHERS_VALUE = 0x0666 };

/* What a world has and what may happen in it. Each is a word of the command line. */
typedef struct {
    int dyp;                   /* 55 AA; else Modbus */
    int transactions;          /* bit by bit: which there are; 0 and 1 are unit 1's, 2 and 3 unit 2's */
    int retries[TRANSACTIONS]; /* of each */
    int timeout[UNITS];        /* ticks; of each unit's transactions */
    int silence, gap;          /* ticks */
    int leave;                 /* ticks that a request takes to leave */
    int poll;                  /* the program polls at least each so many ticks */
    int over;                  /* a response may be so many ticks later than the header assumes */
    int takes;                 /* the port takes a request while another leaves; else it is busy */
    int echo; /* the adapter hands back what is sent: 1; and the line has to find it out: 2 */
    int exception, damaged, unexpected; /* what a unit may send in place of its response */
    int piece;            /* noise that begins like a response; the response itself still comes */
    int crowd;            /* other bytes may come right behind that noise */
    int halves;           /* a response may come in two pieces with time between them */
    int foreign, stream;  /* frames of a third unit; a device that sends by itself, with a listener */
    int own;              /* unit 1 sends frames by itself, of another shape than its responses */
    int noise;            /* single bytes that begin no frame */
    int asks;             /* another master asks unit 1 for what our requests ask */
    int senders, masters; /* the optional parts of the line */
    int busy;             /* ticks of busy_us; 0: the default */
    int cancel, cancel_unit;
    int read_fails, write_fails, write_busy, set_line; /* of the port */
    int watched; /* the transaction whose place in the queue is looked at; 4: none */
} options_t;

extern options_t options;

/* A request on its way, and the response to it. A response carries the ticket's number, so that it is known whose it is
 * by whom it is delivered to. */
enum { NONE, LEAVING, DUE, BEGUN, CAME };

enum {
    ENDED = 1,  /* the transaction, as it was when it asked, is over */
    CLOSED = 2, /* the attempt is */
    PIECE = 4,  /* something came that began like the response */
    SURE = 8    /* the response came in time and whole, and nothing before it: the next poll takes it */
};

typedef struct {
    uint8_t stage, transaction, flags;
    uint8_t age; /* ticks since the request had left; since then it stands still, with CAME */
} ticket_t;

/* What has come since the request on the wire; IN_TIME: before the time-out, and with nothing before it.
 * ALONE: noise, behind which there will be a gap. CLAIMED: another master has asked the unit. SKIPPED: the request left
 * without the silence before it. */
enum { BAD = 1, OTHER = 2, IN_TIME = 4, ALONE = 8, CLAIMED = 16, SKIPPED = 32 };

typedef struct {
    fathom_line_t line;
    fathom_modbus_request_t requests[TRANSACTIONS];
    uint16_t values[TRANSACTIONS];
    uint8_t frame[FRAME];
    uint8_t rx[RX];
    uint8_t rx_length;
    uint8_t leaving; /* ticks until the request has left */
    ticket_t tickets[TICKETS];
    uint8_t quiet;   /* ticks since the last byte on the wire, up to the silence */
    uint8_t came;    /* BAD, OTHER, IN_TIME */
    uint8_t due;     /* what due_us has promised, less what has passed; up to NEVER */
    uint8_t is_news; /* bytes came since the last poll */
    uint8_t passed;  /* ticks since the last poll */
    uint8_t
        others; /* requests of others since the watched transaction was queued and its unit not quarantined */
    uint8_t waited;     /* ticks for which a request has waited, up to busy_us */
    uint8_t asked;      /* the unit that has to respond to another master, 0: none */
    uint8_t asked_age;  /* ticks since that master asked */
    uint8_t has_spoken; /* another device has sent in this tick */
    uint8_t has_frame;  /* a whole frame came while a request waited */
    uint32_t now_us;
} world_t;

/* A tick: the least gap that line.h admits. A pause is longer than FATHOM_LINE_SEND_US. */
enum { NEVER = 250, TICK_US = 100, LONG_US = 1000000 + TICK_US };

extern world_t world;

/* What a step has done. */
typedef struct {
    int queue[TRANSACTIONS];     /* as it was before, first to last, then -1 */
    int sent;                    /* the transaction whose request the port took; -1 */
    bool asked_port;             /* write was called */
    bool set_port;               /* set_line was */
    int ended[TRANSACTIONS];     /* the status; PENDING: it has not */
    int delivered[TRANSACTIONS]; /* the number of the ticket */
    uint8_t counted[FATHOM_LINE_COUNTERS];
    unsigned heard; /* bytes that the listener got */
} effect_t;

extern effect_t effect;

/* What the port will do in the next poll. */
typedef enum { PORT_WORKS, READ_FAILS, WRITE_FAILS, WRITE_BUSY, SET_BUSY, SET_FAILS, STAYS } fault_t;
extern fault_t fault;

void world_begin(void);

static inline int unit_of(int transaction) { return transaction / 2; }
static inline uint8_t address_of(int transaction) { return (uint8_t)(1 + unit_of(transaction)); }
static inline int timeout_of(int transaction) { return options.timeout[unit_of(transaction)]; }
static inline bool there_is(int transaction) { return (options.transactions >> transaction & 1) != 0; }

/* Ticks after the request within which a response comes by what line.h assumes, and in this world. */
static inline int assumed(int transaction) { return 2 * timeout_of(transaction); }
static inline int latest(int transaction) { return assumed(transaction) + options.over; }

bool is_queued(int transaction);
/* Before the step. */
bool was_queued(int transaction);
fathom_status_t world_submit(int transaction);
void put(const uint8_t *bytes, uint8_t length);
uint8_t response(int ticket, uint8_t *bytes);
void fill_in(int transaction);

/* ---- packed.c: a state as bytes; what differs in them behaves differently ---- */

enum { PACKED = 96 };
void pack(uint8_t *bytes);
void unpack(const uint8_t *bytes);

/* ---- steps.c ---- */

enum {
    TICK,
    PAUSE,
    POLL,
    POLL_READ_FAILS,
    POLL_WRITE_FAILS,
    POLL_WRITE_BUSY,
    POLL_SET_BUSY,
    POLL_SET_FAILS,
    PAUSE_STAYS,
    SUBMIT = 12,
    CANCEL = 16,
    CANCEL_UNIT = 20,
    RESPOND = 24,
    EXCEPTION = 28,
    DAMAGED = 32,
    SEND_PIECE = 36,
    BEGIN = 40,
    REST = 44,
    UNEXPECTED = 48,
    FOREIGN = 52,
    STREAM,
    OWN,
    NOISE,
    ASK,
    ANSWER,
    POLL_DRAWN,
    STEPS
};

bool is_possible(int step);
/* Carries it out; which promise was broken, NULL: none. */
const char *carry_out(int step);
/* ---- described.c: one line of a way ---- */

void describe(int step, const world_t *before, FILE *out);

/* ---- rules.c ---- */

const char *judge(int step, const world_t *before);

/* Requests of others that may leave before one that could: each of them, with its retries. */
int bound_of_others(void);

#endif
