/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_LINE_H
#define FATHOM_LINE_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The one owner of a UART: a request is handed to it as a transaction, what only listens is registered as its listener,
 * and nothing else reads the port. Silence before a request, time-outs, damaged, late and foreign responses, echo, line
 * settings, retries, broadcasts and counters are kept here, once, for every protocol.
 *
 * An image holds what a program names: fathom_line_init_listening makes a line without queue, transactions and
 * quarantine; the search for an echo, the port's marks and time stamps, and the counters are named by the config.
 *
 * It never waits, never allocates and keeps no state but in the structs below, which the caller owns. One
 * context only: no function of a line may be called from an interrupt, or from two tasks at once.
 *
 * What it does with what comes in:
 *  - A response is complete by its length, at once; noise before it is dropped byte by byte.
 *  - A damaged response ends the attempt at the first gap after it.
 *  - A unit that did not respond in time is quarantined (line_turns.h), also one whose response was damaged or whose
 *    transaction was cancelled; other units are served meanwhile. A late response is counted and never taken for
 *    another's; it does serve a retry of the same transaction.
 *  - A transaction that has failed with retries left stays in the queue; other units come first.
 *  - Local echo: many RS-485 adapters hand back what they send. The config says whether this one does, or names
 *    find_echo: then the first transaction whose response cannot equal its request, a read, shows it. Until then a
 *    single copy of a write whose response equals its request (Modbus function 06, 55 AA 03) acknowledges nothing:
 *    FATHOM_ERR_ECHO. Where there is echo, such a write needs two copies. With a wrong config reads still succeed.
 *  - Among frames that a device sends by itself, requests leave in the silence right behind a frame. Once four bytes or
 *    more have come that belong to no transaction (those of a late response too), they leave only there: neither behind
 *    a response, for which the device may have delayed a frame, nor later in a silence, where they would meet the next
 *    frame. 65 ms of silence end that. So an HPS-167S that sends every 18.5 ms at 19200 8E1 can be read where bytes
 *    come in at once and silence_us is 2006: 7.4 ms of frame, 2 ms, 4.6 ms of request. Poll the line for 65 ms before
 *    the first request, and it has heard such a device.
 *
 * The echo of a broadcast belongs to no transaction, and goes where such bytes go.
 *
 * What cannot be told apart on a wire, and so is taken for the response: one that comes later than twice the
 * time-out; an unasked frame of exactly the shape that is waited for. Choose time-outs accordingly.
 */

/* Zero-valued members of fathom_line_config_t mean these. */
#define FATHOM_LINE_DEFAULT_SILENCE_US 4011 /* 3.5 characters of 11 bits at 9600 baud */
#define FATHOM_LINE_DEFAULT_GAP_US     5000

/* A port that refuses a request or the end of a break, or does not finish sending, for so long counts as broken. */
#define FATHOM_LINE_SEND_US 1000000u

/*
 * The silence that ends a frame, t3.5 (MODBUS over Serial Line V1.02, 2.5.1.1; HPS-167S 2.2.3): 3.5
 * characters up to 19200 baud, 1750 us above. `bits` of a character, start, parity and stop bits included:
 * 10 for 8N1, 11 for 8E1, 8O1 and 8N2. Constant when its arguments are.
 */
#define FATHOM_T3_5_US(baud, bits)                                                                           \
    ((uint16_t)((baud) > 19200 ? 1750 : ((bits)*3500000uL + (baud)-1uL) / (baud)))

typedef struct fathom_transaction fathom_transaction_t;
typedef struct fathom_line fathom_line_t;

/* Whether a line sends requests or only listens (line_turns.h). */
typedef struct fathom_line_kind fathom_line_kind_t;

/*
 * What the line has to know of a protocol: pure functions. `transaction` is one
 * that names this protocol, `frame` the line's memory (frame_size bytes), `have` >= 1 how many received bytes stand at
 * its front. None changes a received byte. The table is const and outlives every line that has used it.
 */
typedef struct {
    /* Writes the request to `frame`; returns its length, 1..255. */
    uint8_t (*encode)(const fathom_transaction_t *transaction, uint8_t *frame);
    /* The length of the frame that begins here, 0: none does. More than `have`: so many bytes are needed to know. */
    uint8_t (*length)(const uint8_t *frame, uint8_t have);
    /* 0: the checksum of the `length` bytes, a whole frame or as many as the request has, is right. */
    uint16_t (*check)(const uint8_t *frame, uint8_t length);
    /* Do these bytes begin like the request, as a line with local echo brings it back? Where as many have come as the
     * request has, the checksum decides. */
    bool (*is_request)(const fathom_transaction_t *transaction, const uint8_t *frame, uint8_t have);
    /* A whole frame with a right checksum, from the unit of the request: FATHOM_READY or FATHOM_ERR_EXCEPTION, it is
     * the response, and the results are written; else it is not, and nothing is. */
    fathom_status_t (*parse_response)(fathom_transaction_t *transaction, const uint8_t *frame);
    uint8_t address_at; /* offset of the unit's address in a frame */
    bool zero_answers;  /* unit 0 is a unit like the others, and not all of them */
} fathom_protocol_t;

/* Addresses with a meaning of their own. */
enum {
    FATHOM_LINE_ALL_UNITS = 0, /* a broadcast: no unit responds */
    /* the first response is taken, whichever unit it is from; then all units are quarantined, as after a time-out */
    FATHOM_LINE_ANY_UNIT = 255
};

/*
 * One request and the response to it, in the caller's memory. Set the first five members and submit it; then
 * leave it alone until its status is no longer FATHOM_PENDING. It may be submitted again at once.
 */
struct fathom_transaction {
    const fathom_protocol_t *protocol;
    /* Set before the request leaves; NULL: as they are. On a line where one transaction names them, all have to. */
    const fathom_line_settings_t *line_settings;
    /* From the end of the request to the first byte of the response. To all units: the turnaround, which they need
     * before the next request; then it is READY. Up to 2^31 - 1, 35 minutes: a quarantine lasts twice that. */
    uint32_t timeout_us;
    /* Of the unit. Units whose addresses are equal modulo 16 share a quarantine: they may delay, never confuse, each
     * other. */
    uint8_t address;
    uint8_t retries; /* further attempts after a failed one; 0..254 */

    uint8_t attempts; /* the line's: how often it was sent */
    /*
     * The line's: FATHOM_PENDING while it is queued, then FATHOM_READY, or
     * FATHOM_ERR_NO_RESPONSE  nothing that could be the response came in time
     * FATHOM_ERR_CHECKSUM     a response from the unit was damaged or broke off
     * FATHOM_ERR_MALFORMED    the unit sent something else with a right checksum
     * FATHOM_ERR_EXCEPTION    the unit refused; the number is in the request
     * FATHOM_ERR_ECHO         one copy of the request came, and echo is not known yet; counts as NO_RESPONSE
     * FATHOM_ERR_CANCELLED    by fathom_line_cancel
     * FATHOM_ERR_UNSUPPORTED  the port cannot do line_settings; nothing was sent
     * FATHOM_ERR_PORT         the HAL reported an error or did not send
     */
    int8_t status;
    union {
        fathom_transaction_t *next; /* the line's, while it is queued */
        uint32_t heard_us;          /* when it has ended with a response: the clock when the last byte came */
    } link;
};

/* Takes the bytes that belong to no transaction. A node in the caller's memory. */
typedef struct fathom_listener fathom_listener_t;
struct fathom_listener {
    /*
     * `count` bytes in the order in which they came; 0: the port reports that bytes were lost here. after_gap: what
     * came before the first of them has ended, since the line was seen to be silent for at least gap_us, or a response
     * to a transaction, or the echo of its request, stood there. time_us: the clock when the last of them came, as
     * exact as the port or the polling; of bytes that were held back, because they could have begun a response, when
     * the last byte of all came. Called within fathom_line_poll; it may not call the line.
     */
    void (*receive)(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                    uint32_t time_us);
    uint16_t gap_us; /* the silence that it needs to see; fathom_line_due_us() reckons with it */
};

/* Counters; each stops at 65535, and the user may set it to 0. A failed attempt counts at -status; a retry is an
 * attempt of its own. */
enum {
    FATHOM_LINE_RESPONSES = 0,
    FATHOM_LINE_DROPPED_BYTES = 1, /* belonged to no frame, and no listener was there */
    FATHOM_LINE_PORT_ERRORS = 2,
    FATHOM_LINE_NO_RESPONSES = 3,
    FATHOM_LINE_CHECKSUM_ERRORS = 4,
    FATHOM_LINE_EXCEPTIONS = 5,
    FATHOM_LINE_MALFORMED = 6,
    FATHOM_LINE_LATE_RESPONSES = 7, /* from a quarantined unit */
    FATHOM_LINE_STRAYS = 8,         /* whole frames that are no transaction's: another client's traffic */
    /* dropped because the port had marked them: parity, framing. An overrun, whose bytes cannot be counted, is one */
    FATHOM_LINE_BAD_BYTES = 9,
    FATHOM_LINE_COUNTERS = 10
};

/* Whether the line hands back what is sent on it. */
enum {
    FATHOM_LINE_ECHO_AUTO = 0, /* not known */
    FATHOM_LINE_ECHO_OFF = 1,
    FATHOM_LINE_ECHO_ON = 2
};

/*
 * Const and the caller's; read at every call, so it outlives the line. The members from find_echo on name what a line
 * can do besides, NULL: it does not, and the image does not hold it.
 */
typedef struct {
    const fathom_uart_t *uart;
    const fathom_clock_t *clock;
    uint8_t *frame; /* where requests are built and responses gathered; the line's alone */
    /* 8..255 bytes: the longest frame on this line. 13 for A16, A05 and HPS-167S distances; 27 for HPS-167S details;
     * more lets longer foreign frames pass whole. */
    uint8_t frame_size;
    uint8_t echo; /* FATHOM_LINE_ECHO_OFF or _ON; _AUTO: find_echo finds it out. Read by init */
    /* Kept before a request: FATHOM_T3_5_US(baud, bits) of the slowest settings that are used on the line; 0: 4011. */
    uint16_t silence_us;
    /* A frame is over when nothing came for so long. At least 1.5 characters, and more than a slow sender or port
     * pauses: 25000 behind an operating system, whose USB adapters hold bytes back for 16 ms. 0: 5000. */
    uint16_t gap_us;

    /* fathom_line_find_echo: the line finds out whether it echoes. */
    void (*find_echo)(fathom_line_t *line, uint8_t echo);
    /* fathom_line_marks: what the port reports with the bytes (fathom_rx_t) is used: when they came, a silence
     * before them, wrong parity, a missing stop bit, an overrun. */
    uint8_t (*marks)(fathom_line_t *line, const fathom_rx_t *rx, uint8_t count);
    /* fathom_line_count: the line counts what happens in `counters`, FATHOM_LINE_COUNTERS of them, the caller's. */
    void (*count)(fathom_line_t *line, uint8_t which, uint8_t by);
    uint16_t *counters;
} fathom_line_config_t;

struct fathom_line {
    uint8_t state;
    uint8_t have;         /* bytes in the frame */
    uint8_t need;         /* with fewer there is nothing to find */
    uint8_t known;        /* of gaps, echo and frames of other senders, bit by bit */
    uint8_t sent;         /* bytes of the request on the wire that a unit responds to; 0: there is none */
    uint16_t quarantined; /* bit address % 16 (line_turns.h) */
    uint16_t silent_us;   /* known silence since the last byte either way; stops at 65535 */
    const fathom_line_config_t *config;
    fathom_transaction_t *head; /* the queue; the one on the wire is first */
    fathom_listener_t *listener;
    const fathom_protocol_t *protocol; /* last used */
    const fathom_line_kind_t *kind;
    uint32_t polled_us;          /* the clock at the last poll */
    uint32_t left_us;            /* of the present time-out */
    uint32_t quarantine_left_us; /* until all quarantines end, where there are any */
};

/* What a config may name. They are the line's to call. */
void fathom_line_find_echo(fathom_line_t *line, uint8_t echo);
uint8_t fathom_line_marks(fathom_line_t *line, const fathom_rx_t *rx, uint8_t count);
void fathom_line_count(fathom_line_t *line, uint8_t which, uint8_t by);

/*
 * Makes a line ready. FATHOM_READY, or FATHOM_ERR_ARGUMENT: uart, clock or frame is NULL, or frame_size under 8. The
 * first request waits for one silence.
 *
 * init: a line for requests. The config says whether it echoes, or names find_echo, else FATHOM_ERR_ARGUMENT.
 * init_listening: a line that only listens: echo does not matter, and nothing that sends is linked.
 */
fathom_status_t fathom_line_init(fathom_line_t *line, const fathom_line_config_t *config);
fathom_status_t fathom_line_init_listening(fathom_line_t *line, const fathom_line_config_t *config);

/*
 * Puts a transaction at the end of the queue. FATHOM_PENDING: it is queued, and transaction->status tells the
 * rest. Nothing changed: FATHOM_ERR_BUSY, it is queued already; FATHOM_ERR_ARGUMENT, its timeout_us is over 2^31 - 1;
 * FATHOM_ERR_UNSUPPORTED, this line only listens.
 */
fathom_status_t fathom_line_submit(fathom_line_t *line, fathom_transaction_t *transaction);

/*
 * Takes a transaction out of the queue: it ends with FATHOM_ERR_CANCELLED, and its memory is the caller's
 * again. In flight too: the unit is then quarantined. Does nothing to one that is not queued.
 */
void fathom_line_cancel(fathom_line_t *line, fathom_transaction_t *transaction);

/* The same for every transaction with this unit. */
void fathom_line_cancel_unit(fathom_line_t *line, uint8_t address);

/* Is it queued or in flight? */
bool fathom_line_has(const fathom_line_t *line, const fathom_transaction_t *transaction);

/* Was nothing on the wire at the last poll: no request leaving, no response to come in its time, no part of a frame?
 * What is queued does not count. */
bool fathom_line_is_idle(const fathom_line_t *line);

/* Registers the listener, instead of the one before; NULL: none. It is the caller's, and outlives its registration. */
void fathom_line_listen(fathom_line_t *line, fathom_listener_t *listener);

/*
 * Holds TX low (true), or lets it go high again: the trigger, or the mode select, of a module whose input is our TX.
 * While it is low nothing is sent and transactions wait in the queue; after it the silence before a request is kept. It
 * is low until its end is FATHOM_READY, whatever fails meanwhile: also where a poll returned FATHOM_ERR_PORT and the
 * port works again, perhaps as another one whose TX is high.
 * FATHOM_READY: it is so now, also where it was.
 * FATHOM_PENDING: bytes of the port are still leaving; call again, 1 ms later say: no due_us reckons with it.
 * FATHOM_ERR_BUSY: it cannot begin, a transaction is on the wire.
 * FATHOM_ERR_UNSUPPORTED: the port has no set_break.
 * FATHOM_ERR_PORT: it is broken, or it has refused to end the break for FATHOM_LINE_SEND_US. Where a break does not end
 * that is an error of the line: every queued transaction has ended with it. Call again all the same, or TX stays low.
 * After all but READY it is as it was.
 */
fathom_status_t fathom_line_break(fathom_line_t *line, bool on);

/*
 * Does all that can be done without waiting: reads what has come (at most 16 reads of the port), ends and
 * begins transactions. Call it often; at the latest every 71 minutes. Several users of one line may each call it.
 * Where a device sends by itself, sleep by due_us, and poll when bytes come: a loop that is slower than the pause
 * behind a frame sends into the next frame; and one in step with the device, whose every call comes right after a
 * frame, sees no silence at all and sends nothing.
 * FATHOM_PENDING, or FATHOM_ERR_PORT: the port is broken; every queued transaction has ended with that. Go on
 * polling and it works again when the port does.
 */
fathom_status_t fathom_line_poll(fathom_line_t *line);

/*
 * How long from now until poll has something to do if no byte comes, in microseconds; FATHOM_NO_DEADLINE
 * when only a byte or a submit can bring that. While the port is sending, or takes no request, it is the port's
 * leaves_in_us (hal.h); where that is not known, 1000 after the last poll: not every port can report the end of sending
 * by an event.
 */
uint32_t fathom_line_due_us(const fathom_line_t *line);

/* What is known of local echo: what the config says or what was found out last; FATHOM_LINE_ECHO_AUTO: nothing yet. */
uint8_t fathom_line_echo(const fathom_line_t *line);

/* The clock when the last byte came, exact to the port's time stamps or to the polling, for 65 ms after it. */
uint32_t fathom_line_heard_us(const fathom_line_t *line);

#ifdef __cplusplus
}
#endif

#endif
