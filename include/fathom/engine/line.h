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
 * The one owner of a UART: what is to be asked on the wire is handed to it as a transaction, what only listens is
 * registered as its listener, and nothing else reads the port. Silence before a request, time-outs, damaged, late and
 * foreign responses, echo, line settings, retries, broadcasts and counters are kept here, once, for every protocol.
 *
 * An image holds what a program names. fathom_line_init_listening makes a line without queue, transaction and quarantine;
 * of a line that asks the config names the search for an echo, the marks and time stamps of the port, and the counters.
 *
 * It never waits, never allocates and keeps no state but in the structs below, which the caller owns. One
 * context only: no function of a line may be called from an interrupt, or from two tasks at once.
 *
 * What it does with what comes in:
 *  - A response is complete by its length, at once; noise before it is dropped byte by byte.
 *  - A damaged response ends the attempt at the first gap after it.
 *  - A unit that did not answer in time owes a response. Until that came (it is counted as late and never
 *    taken for another's), or until twice the time-out has passed since the request, that unit is asked
 *    nothing; other units are asked meanwhile. A late response does serve a retry of the same transaction. After
 *    a response that was damaged the unit owes as well, for what is left of the time-out, or for twice the
 *    time-out if it broke off. One deadline, the latest, serves all units that owe.
 *  - A transaction that has failed with retries left goes on waiting in the queue; other units come first.
 *  - Local echo: many RS-485 adapters hand back what they send. A line that asks is told of it in its config, or finds
 *    out with find_echo: the first transaction whose response cannot equal its request, a read, shows the echo or shows that
 *    there is none. Until then a write whose response equals its request (Modbus function 06, 55 AA 03) is not taken as
 *    acknowledged by a single copy: FATHOM_ERR_ECHO. Where there is echo, a write needs two copies. Of a line that is
 *    told wrongly reads are answered all the same.
 *  - A device that sends by itself leaves room for requests: where its frame ends the silence begins, and a request
 *    that is waiting then leaves behind it. Once four bytes or more have come that belong to no transaction (those of a
 *    late response are such), requests leave only so: neither behind a response, for which the device may have put a frame
 *    off, nor later in a silence, where they would meet the next frame. After 65 ms of silence that is over. An HPS-167S
 *    that sends every 18.5 ms at 19200 8E1 is asked in this way, where bytes come in at once and the silence is 2006 us:
 *    7.4 ms of frame, 2 ms, 4.6 ms of request. What it has sent before the first request is known where the line was
 *    polled before that, for 65 ms say.
 *
 * The echo of a request to all units belongs to no transaction, and goes where such bytes go.
 *
 * What cannot be told apart on a wire, and so is taken for the response: one that comes later than twice the
 * time-out; an unasked frame of the very shape that is being waited for. Choose time-outs accordingly.
 */

/* Zero-valued members of fathom_line_config_t mean these. */
#define FATHOM_LINE_DEFAULT_SILENCE_US 4011 /* 3.5 characters of 11 bits at 9600 baud */
#define FATHOM_LINE_DEFAULT_GAP_US     5000

/* How long a port may refuse a request or the end of a break, or take to send a request, before it counts as broken. */
#define FATHOM_LINE_SEND_US 1000000u

/*
 * The silence that ends a frame, t3.5 (MODBUS over Serial Line V1.02, 2.5.1.1; HPS-167S 2.2.3): 3.5
 * characters up to 19200 baud, 1750 us above. `bits` of a character, start, parity and stop bits included:
 * 10 for 8N1, 11 for 8E1, 8O1 and 8N2. Constant when its arguments are.
 */
#define FATHOM_T3_5_US(baud, bits)                                                                           \
    ((uint16_t)((baud) > 19200 ? 1750 : ((bits)*3500000ul + (baud)-1ul) / (baud)))

typedef struct fathom_transaction fathom_transaction_t;
typedef struct fathom_line fathom_line_t;

/* Whether a line asks or only listens (line_turns.h). */
typedef struct fathom_line_kind fathom_line_kind_t;

/*
 * What the line has to know of a protocol: plain functions that need nothing but their arguments. `transaction` is one
 * that names this protocol, `frame` the line's memory (frame_size bytes), `have` >= 1 how many received bytes stand at
 * its front. None changes a received byte. The table is const and outlives every line that has spoken it.
 */
typedef struct {
    /* Writes the request to `frame`; returns its length, 1..255. */
    uint8_t (*encode)(const fathom_transaction_t *transaction, uint8_t *frame);
    /* The length of the frame that begins here, 0: none does. More than `have`: so many bytes are needed to tell. */
    uint8_t (*length)(const uint8_t *frame, uint8_t have);
    /* 0: the checksum of the `length` bytes, a whole frame or as many as the request has, is right. */
    uint16_t (*check)(const uint8_t *frame, uint8_t length);
    /* Do these bytes begin like the request, as a line with local echo brings it back? Where as many have come as the
     * request has, the checksum decides. */
    bool (*is_request)(const fathom_transaction_t *transaction, const uint8_t *frame, uint8_t have);
    /* Of a whole frame with a right checksum, from a unit that was asked: FATHOM_READY or FATHOM_ERR_EXCEPTION, it
     * answers the transaction, whose results are written; else it does not, and nothing is. */
    fathom_status_t (*parse_response)(fathom_transaction_t *transaction, const uint8_t *frame);
    uint8_t address_at; /* where the unit stands in a frame */
    bool zero_answers;  /* unit 0 is a unit like the others, and not all of them */
} fathom_protocol_t;

/* Units with a meaning of their own. */
enum {
    FATHOM_LINE_ALL_UNITS = 0, /* all are told, none answers */
    FATHOM_LINE_ANY_UNIT =
        255 /* all are asked, and the first response is taken, whosever it is; the others owe
                                  theirs as if it were late */
};

/*
 * One request and the response to it, in the caller's memory. Set the first five members and submit it; then
 * leave it alone until its status is no longer FATHOM_PENDING. It may be submitted again at once.
 */
struct fathom_transaction {
    const fathom_protocol_t *protocol;
    /* Set before the request leaves; NULL: as they are. On a line where one transaction names them, all have to. */
    const fathom_line_settings_t *line_settings;
    uint32_t timeout_us; /* from the end of the request to the first byte of the response; to all units: the
                            time that they need before the next request, after which it is READY. Up to
                            2^31 - 1, 35 minutes: twice that is what a unit may owe */
    uint8_t address;     /* who is asked; units that are equal modulo 16 may delay, never confuse, each
                            other after a time-out */
    uint8_t retries;     /* further attempts after a failed one; 0..254 */

    uint8_t attempts; /* the line's: how often it was sent */
    int8_t status;    /* the line's: FATHOM_PENDING while it is queued, then how it ended:
                         FATHOM_READY, or
                         FATHOM_ERR_NO_RESPONSE   nothing that could be the response came in time
                         FATHOM_ERR_CHECKSUM    a response from the unit was damaged or broke off
                         FATHOM_ERR_MALFORMED   the unit sent something else with a right checksum
                         FATHOM_ERR_EXCEPTION   the unit refused; the number is in the request
                         FATHOM_ERR_ECHO        one copy of the request came, and the line does not know yet
                                                whether it echoes; counts as NO_RESPONSE
                         FATHOM_ERR_CANCELLED   by fathom_line_cancel
                         FATHOM_ERR_UNSUPPORTED the port cannot do `settings`; nothing was sent
                         FATHOM_ERR_PORT        the HAL reported an error or did not send */
    union {
        fathom_transaction_t *next; /* the line's, while it is queued */
        uint32_t heard_us;          /* when it has ended with a response: the clock when the last byte came */
    } link;
};

/* Whoever takes the bytes that belong to no transaction. A node in the caller's memory. */
typedef struct fathom_listener fathom_listener_t;
struct fathom_listener {
    /*
     * `count` bytes in the order in which they came; 0: here bytes were lost, as the port has said. after_gap:
     * the line was seen to be silent for at least gap_us before the first of them. time_us: the clock when the
     * last of them came, as well as the port or the polling can tell; of bytes that were held back, since they could
     * have been the beginning of a response, when the last byte of all came. Called within fathom_line_poll; it may not
     * call the line.
     */
    void (*receive)(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                    uint32_t time_us);
    uint16_t gap_us; /* the silence it wants to know of: fathom_line_due_us() makes room to see it */
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
    FATHOM_LINE_LATE_RESPONSES = 7, /* from a unit that owed one */
    FATHOM_LINE_STRAYS = 8,    /* whole frames that no transaction had asked for: another master's traffic */
    FATHOM_LINE_BAD_BYTES = 9, /* dropped because the port had marked them: parity, framing. An overrun,
                                     whose bytes cannot be counted, is one */
    FATHOM_LINE_COUNTERS = 10
};

/* Whether the line hands back what is sent on it. */
enum {
    FATHOM_LINE_ECHO_AUTO = 0, /* not told */
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
    uint8_t *frame;      /* where requests are built and responses gathered; the line's alone */
    uint8_t frame_size;  /* 8..255 bytes: the longest frame on this line. 13 for A16, A05 and HPS-167S
                            distances; 27 for HPS-167S details; more lets longer foreign frames pass whole */
    uint8_t echo;        /* FATHOM_LINE_ECHO_OFF or _ON: told; read by init. Else find_echo finds it out */
    uint16_t silence_us; /* kept before a request: FATHOM_T3_5_US(baud, bits), of the slowest settings that
                            are used on the line; 0: 4011 */
    uint16_t gap_us;     /* a frame is over when nothing came for so long. At least 1.5 characters; more
                            than a slow sender or a slow port pauses: 25000 behind an operating system, whose
                            USB adapters hold bytes back for 16 ms. 0: 5000 */

    /* fathom_line_find_echo: the line finds out whether it echoes. */
    void (*find_echo)(fathom_line_t *line, uint8_t echo);
    /* fathom_line_marks: what the port says of the bytes that it gives (fathom_rx_t) counts: when they came, a silence
     * before them, wrong parity, a missing stop bit, an overrun. */
    uint8_t (*marks)(fathom_line_t *line, const fathom_rx_t *rx, uint8_t count);
    /* fathom_line_count: the line counts what happens in `counters`, FATHOM_LINE_COUNTERS of them, the caller's. */
    void (*count)(fathom_line_t *line, uint8_t which, uint8_t by);
    uint16_t *counters;
} fathom_line_config_t;

struct fathom_line {
    uint8_t state;
    uint8_t have;         /* bytes in the frame */
    uint8_t need;         /* below so many there is nothing new to say */
    uint8_t known;        /* of gaps, echo and company, bit by bit */
    uint8_t sent;         /* bytes of the request that is answered on the wire; 0: there is none */
    uint16_t quarantined; /* bit unit % 16: may still answer */
    uint16_t silent_us;   /* known silence since the last byte either way; stops at 65535 */
    const fathom_line_config_t *config;
    fathom_transaction_t *head; /* the queue; the one on the wire is first */
    fathom_listener_t *listener;
    const fathom_protocol_t *protocol; /* last spoken */
    const fathom_line_kind_t *kind;
    uint32_t polled_us;          /* the clock at the last poll */
    uint32_t left_us;            /* of the present time-out */
    uint32_t quarantine_left_us; /* until `quarantined` is forgotten, where it is not 0 */
};

/* What a config may name. They are the line's to call. */
void fathom_line_find_echo(fathom_line_t *line, uint8_t echo);
uint8_t fathom_line_marks(fathom_line_t *line, const fathom_rx_t *rx, uint8_t count);
void fathom_line_count(fathom_line_t *line, uint8_t which, uint8_t by);

/*
 * Makes a line ready. FATHOM_READY, or FATHOM_ERR_ARGUMENT: a pointer that a line cannot do without is NULL, or the
 * frame is under 8 bytes. The first request waits for one silence.
 *
 * init: a line that asks. The config says whether it echoes, or names what finds that out, else FATHOM_ERR_ARGUMENT.
 * init_listening: a line that only listens: nothing needs to be said of echo, and nothing of what asks is linked.
 */
fathom_status_t fathom_line_init(fathom_line_t *line, const fathom_line_config_t *config);
fathom_status_t fathom_line_init_listening(fathom_line_t *line, const fathom_line_config_t *config);

/*
 * Puts a transaction at the end of the queue. FATHOM_PENDING: it is queued, and transaction->status tells the
 * rest. Nothing changed: FATHOM_ERR_BUSY, it is queued already; FATHOM_ERR_ARGUMENT, its time-out is too long;
 * FATHOM_ERR_UNSUPPORTED, this line only listens.
 */
fathom_status_t fathom_line_submit(fathom_line_t *line, fathom_transaction_t *transaction);

/*
 * Takes a transaction out of the queue: it ends with FATHOM_ERR_CANCELLED, and its memory is the caller's
 * again. In flight too: the unit then owes a response, which no later transaction takes for its own. Does
 * nothing to one that is not queued.
 */
void fathom_line_cancel(fathom_line_t *line, fathom_transaction_t *transaction);

/* The same for every transaction with this unit. */
void fathom_line_cancel_unit(fathom_line_t *line, uint8_t unit);

/* Is it queued or in flight? */
bool fathom_line_has(const fathom_line_t *line, const fathom_transaction_t *transaction);

/* Was nothing on the wire at the last poll: no request leaving, no response to come in its time, no part of a frame?
 * What is queued does not count. */
bool fathom_line_is_idle(const fathom_line_t *line);

/* Registers who takes the bytes that belong to no transaction, instead of the one before; NULL for nobody. */
void fathom_line_listen(fathom_line_t *line, fathom_listener_t *listener);

/*
 * Holds TX low (true), or lets it go high again: the trigger, or the mode select, of a module whose input is our TX.
 * While it is low nothing is sent and transactions wait in the queue; after it the silence before a request is kept. It is
 * low until its end is FATHOM_READY, whatever fails meanwhile: also where a poll has said FATHOM_ERR_PORT and the port
 * works again, perhaps as another one whose TX is high.
 * FATHOM_READY: it is so now, also where it was.
 * FATHOM_PENDING: bytes of the port are still leaving; ask again, 1 ms later say: no due_us reckons with it.
 * FATHOM_ERR_BUSY: it cannot begin, a transaction is on the wire.
 * FATHOM_ERR_UNSUPPORTED: the port has no set_break.
 * FATHOM_ERR_PORT: it is broken, or it has refused to end the break for FATHOM_LINE_SEND_US. Where a break does not end
 * that is an error of the line: every queued transaction has ended with it. Ask again all the same, or TX stays low.
 * After all but READY it is as it was.
 */
fathom_status_t fathom_line_break(fathom_line_t *line, bool on);

/*
 * Does all that can be done without waiting: reads what has come (at most 16 reads of the port), ends and
 * begins transactions. Call it often; at the latest every 71 minutes. Several users of one line may each call it.
 * Where a device sends by itself, sleep by due_us, and look when bytes come: a loop that comes round more slowly than
 * the room behind a frame is long sends into the next one; and one in step with the device, whose every call comes right
 * after a frame, sees no silence at all and sends nothing.
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

/* What is known of local echo of a line that asks: what the config says or what was found out last;
 * FATHOM_LINE_ECHO_AUTO as long as nothing was. */
uint8_t fathom_line_echo(const fathom_line_t *line);

/* The clock when the last byte came, as well as it is known; exact to the port's time stamps or to the
 * polling, for 65 ms after it. */
uint32_t fathom_line_heard_us(const fathom_line_t *line);

#ifdef __cplusplus
}
#endif

#endif
