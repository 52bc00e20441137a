/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_LINE_H
#define FATHOM_LINE_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/silence.h"
#include "fathom/engine/transaction.h"
#include "fathom/hal.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Owns one UART: sends requests one at a time and matches each response to its request.
 *
 * A line carries the requests of any number of sensors, units and protocols over one UART. The line passes all bytes
 * that belong to no request to a listener. The line never waits, never allocates memory, and keeps no state outside the
 * structs that the caller passes to it. include/COST.md has its size and its time.
 *
 * @code
 * static uint8_t frame[32];                                 // must stay valid as long as the line is used
 * static const fathom_line_parts_t parts = {.uart = &uart, .clock = &clock,
 *                                             .frame = frame, .frame_size = sizeof frame,
 *                                             .echo = FATHOM_LINE_ECHO_OFF,
 *                                             .silence_us = FATHOM_T3_5_US(9600, 10)};
 * fathom_line_init(&line, &parts);
 * fathom_modbus_client_submit(&line, &request);             // modbus_client.h: puts the request in the queue
 * while (request.transaction.status == FATHOM_PENDING) fathom_line_poll(&line);
 * @endcode
 *
 * @note Call all functions of one line from one context: never from an interrupt, never from two tasks at once.
 *
 * Words: an **attempt** is the wait for silence, one request on the wire and the wait for its response. A **complete
 * frame** has the length that its protocol gives it and a right checksum; all other bytes are **noise**. A **unit** is
 * what has an address.
 *
 * When a request leaves:
 *
 * 1. **Order.** The line sends one request at a time: the first in the queue whose unit is not in quarantine (rule 6). A
 *    policy of line_turns.h can choose another one.
 *
 * 2. **Silence.** The request leaves after `silence_us` without a byte in either direction. The first silence counts from
 *    fathom_line_init(). While the caller holds TX low (fathom_line_break()), nothing leaves.
 *
 * 3. **Busy line.** A transaction waits for this silence at most `busy_us`; each retry waits again. After that, if only
 *    noise was heard, a request that its protocol allows to (`may_collide`: a Modbus read without a side effect) leaves
 *    without silence. In all other cases the transaction ends with FATHOM_ERR_LINE_BUSY, whatever retries are left, and
 *    this attempt was not sent. An attempt that left without a measured silence and failed has the same error, and is
 *    retried. `attempts` is the number of attempts that were sent: if it is 0, no unit has received the request.
 *
 * What happens to a response:
 *
 * 4. **Response.** The line accepts a response as soon as its last byte arrives, without waiting for a gap. If noise
 *    precedes the response, the line discards the noise byte by byte and still finds the response.
 *
 * 5. **Time-out and damage.** A response must begin within `timeout_us` after the end of the request. A response that has
 *    begun may finish within FATHOM_LINE_FINISH_US after that. If a frame with the address of the unit is damaged or
 *    breaks off, the attempt ends at the first gap after it, without waiting for the time-out. One or two bytes are noise:
 *    they end nothing.
 *
 * 6. **Quarantine.** After each attempt without an accepted response, and after a cancelled one, the response may still
 *    arrive. The line sends that unit nothing until a frame of the unit has arrived, or until twice the time-out has
 *    passed since the end of the request. The line serves other units in the meantime. One deadline, the latest, serves
 *    all quarantined units. A broadcast causes none.
 *
 * 7. **Late response.** A response that arrives during the quarantine is counted. If the transaction that requested it
 *    waits for a retry, the response ends that transaction with success. No other transaction gets it.
 *
 * 8. **Retries.** A failed transaction with retries left stays in the queue; its unit is in quarantine, so other units
 *    come first. The errors FATHOM_ERR_NO_RESPONSE, _CHECKSUM, _MALFORMED, _ECHO, _OTHER_MASTER, and _LINE_BUSY of an
 *    attempt that was sent, are retried. All other errors end the transaction at once.
 *
 * 9. **Echo.** Many RS-485 adapters return every byte that is sent through them. The parts state whether this adapter
 *    does, or names fathom_line_find_echo(), which learns it from the response to the first read. Reads succeed even if
 *    that statement is wrong. The response to some writes equals the request (Modbus function 06, `55 AA` command 03):
 *
 *    | `echo` in the parts | adapter echoes | such a write ends with |
 *    |---|---|---|
 *    | right | no, or yes | FATHOM_OK, if the unit acknowledges it |
 *    | OFF | yes | FATHOM_OK even without a unit: its echo is mistaken for the acknowledgement |
 *    | ON | no | FATHOM_ERR_NO_RESPONSE |
 *    | AUTO, not known yet | yes or no | FATHOM_OK after two copies, FATHOM_ERR_ECHO after one |
 *
 *    After FATHOM_ERR_ECHO the unit may have executed the write. Submit a read: its response shows what was written, and
 *    whether the adapter echoes. Give a write that must not be executed twice no retries.
 *
 * 10. **Limits.** Two kinds of frames cannot be distinguished from the response: one that arrives later than twice the
 *     time-out, and an unsolicited frame with exactly the shape of the response. Choose the time-out so that no unit can
 *     respond after twice that time.
 *
 * Who else uses the wire:
 *
 * 11. **Unsolicited frames.** If the parts name `senders`: four or more bytes that no transaction accepts show that a
 *     device sends by itself. From then on a request leaves only in the pause directly behind such a frame, after
 *     `silence_us`: not behind a response, and not later in a pause, where the next frame may begin at any time. If the
 *     program polls too seldom to measure that silence (twice `silence_us` or later), the request leaves directly behind a
 *     complete frame, a write too; it then counts as sent without a measured silence (rule 3). 65 ms without a byte end
 *     this rule. An unsolicited frame with the shape of the response is accepted
 *     as the response and counted (FATHOM_LINE_MAYBE_UNSOLICITED). Without `senders`, requests and such frames collide.
 *
 * 12. **Other masters.** If the parts name `masters`: after another master's request (Modbus RTU or `55 AA`) the line
 *     sends nothing until the unit has responded to that master, at most for the time-out of the first transaction in the
 *     queue and at most for `busy_us`. If it is unclear which frame is that response, only the time ends this. If our own
 *     request to the unit is on the wire, no frame can be assigned to it any more: the attempt ends with its time-out and
 *     FATHOM_ERR_OTHER_MASTER. A foreign request that only this line does not hear is not noticed, and without `masters`
 *     none is: then the response to another master can become ours.
 *
 * What a program can rely on:
 *
 * 13. **Bound.** If the program polls, each transaction ends, alone on its line within (`retries` + 1) x (`busy_us` + 2 x
 *     FATHOM_LINE_SEND_US + 2 x `timeout_us` + FATHOM_LINE_FINISH_US + 5 polling intervals). The two FATHOM_LINE_SEND_US
 *     are for a port that is busy and for one that does not finish sending; the second `timeout_us` is the quarantine of
 *     the attempt before. Add the bounds of the transactions that are queued, and of one of each other unit that is
 *     submitted meanwhile.
 *
 * 14. **Age.** What a poll reads may be as old as the pause since the previous poll, unless the port dates the bytes
 *     (FATHOM_RX_TIMED of hal.h). If that age exceeds the time-out of the request on the wire, or the `stale_us` of the
 *     listener, by more than FATHOM_LINE_LATE_US, the line drops and counts the bytes. After fathom_line_init() and after
 *     an error of the port, it drops all bytes until the port was seen empty. Pauses of more than 71 minutes cannot be
 *     seen: call fathom_line_flush() after them.
 *
 * 15. **Broken port.** If the port reports an error, or needs more than FATHOM_LINE_SEND_US, all queued transactions end
 *     with FATHOM_ERR_PORT, whatever retries they have left. Continue to call fathom_line_poll(): the line works again as
 *     soon as the port does.
 *
 * A program contains only the parts that it names. A line of fathom_line_init_listening() links no queue, no
 * transactions and no quarantine. Each part that the parts name by a pointer is linked only then.
 */

/** @brief Default of fathom_line_parts_t::silence_us: 3.5 characters of 11 bits at 9600 baud, in microseconds. */
#define FATHOM_LINE_DEFAULT_SILENCE_US 4011

/** @brief Default of fathom_line_parts_t::gap_us, in microseconds. */
#define FATHOM_LINE_DEFAULT_GAP_US 5000

/** @brief Value of fathom_line_parts_t::gap_us: no silence ends a response before its time-out. */
#define FATHOM_LINE_NO_GAP 65535u

/** @brief Default of fathom_line_parts_t::busy_us, in microseconds. */
#define FATHOM_LINE_DEFAULT_BUSY_US 1000000u

/**
 * @brief Time in microseconds after which a port that does not respond counts as broken.
 *
 * The limit applies to a port that refuses a request, that does not finish sending, or that does not end a break.
 */
#define FATHOM_LINE_SEND_US 1000000u

/**
 * @brief Time in microseconds for which a response that has begun may go on after the time-out (rule 5).
 *
 * The longest frame, 255 characters of 11 bits, takes 292 ms at 9600 baud.
 */
#define FATHOM_LINE_FINISH_US 300000u

/** @brief Time in microseconds after which a poll no longer serves the other users of the line. */
#define FATHOM_LINE_ROUND_US 1000u

/** @brief How much later than fathom_line_due_us() a program may poll and loses nothing, in microseconds (rule 14). */
#define FATHOM_LINE_LATE_US 500000u

/** @brief A line (struct fathom_line). */
typedef struct fathom_line fathom_line_t;

/** @brief The functions in which a line that sends requests and a line that only listens differ (line_turns.h). */
typedef struct fathom_line_kind fathom_line_kind_t;

/** @brief The part of a line for devices that send by themselves (rule 11). */
typedef struct fathom_line_senders fathom_line_senders_t;

/** @brief The part of a line for other masters (rule 12). */
typedef struct fathom_line_masters fathom_line_masters_t;

/** @brief Name it in fathom_line_parts_t::senders. */
extern const fathom_line_senders_t fathom_line_senders;

/** @brief Name it in fathom_line_parts_t::masters. */
extern const fathom_line_masters_t fathom_line_masters;

/** @brief A listener (struct fathom_listener). */
typedef struct fathom_listener fathom_listener_t;

/** @brief Receives the bytes that belong to no transaction. In the caller's memory. */
struct fathom_listener {
    /**
     * @brief Called by fathom_line_poll() with received bytes. Must not call the line.
     *
     * @param listener   This listener.
     * @param bytes      The received bytes in order of arrival. Valid only during the call.
     * @param count      Number of bytes. 0 if the port reports that bytes were lost at this point; `time_us` is then
     *                   the clock, and `after_gap` is false.
     * @param after_gap  True if the bytes before `bytes[0]` belong to another frame. This is so if the line saw at
     *                   least the listener's `gap_us` of silence there, or if a response or the echo of a request
     *                   stood there.
     * @param time_us    Clock at the arrival of `bytes[count - 1]`, in microseconds, as exact as the port's time stamps
     *                   or the polling. If the line held the bytes back because they could have begun a response, this
     *                   is the clock at the arrival of the newest byte.
     */
    void (*receive)(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                    uint32_t time_us);

    /** @brief Silence in microseconds that separates two frames for this listener. fathom_line_due_us() includes it. */
    uint16_t gap_us;

    /** @brief Greatest age of a byte in microseconds, at most 2^31 - 1 (rule 14). 0: any age. */
    uint32_t stale_us;
};

/**
 * @brief Indices of the counters in fathom_line_parts_t::counters.
 *
 * Each counter stops at 65535. The caller may set a counter to 0. A failed attempt increments the counter with the index
 * `-status`. Each retry is an attempt of its own.
 */
enum {
    FATHOM_LINE_RESPONSES = 0,       /**< Accepted responses. */
    FATHOM_LINE_DROPPED_BYTES = 1,   /**< Bytes that belonged to no frame while no listener was set. */
    FATHOM_LINE_PORT_ERRORS = 2,     /**< Errors of the port. */
    FATHOM_LINE_NO_RESPONSES = 3,    /**< Attempts without a response. */
    FATHOM_LINE_CHECKSUM_ERRORS = 4, /**< Attempts with a damaged or incomplete response. */
    FATHOM_LINE_EXCEPTIONS = 5,      /**< Requests that a unit refused. */
    FATHOM_LINE_MALFORMED = 6,       /**< Attempts in which the unit sent a frame that is not the response. */
    FATHOM_LINE_LATE_RESPONSES = 7,  /**< Frames from a unit in quarantine. */
    FATHOM_LINE_STRAYS = 8,          /**< Complete frames that belong to no transaction. */
    FATHOM_LINE_BAD_BYTES = 9,  /**< Bytes with a parity or framing error. An overrun counts as one byte. */
    FATHOM_LINE_OLD_BYTES = 10, /**< Bytes that were dropped because they may be too old (rule 14). */
    FATHOM_LINE_ECHOES = 11,    /**< Attempts of which only one copy of a write arrived (rule 9). */
    FATHOM_LINE_FOREIGN_REQUESTS = 12, /**< Requests of other masters (rule 12). */
    FATHOM_LINE_MAYBE_UNSOLICITED =
        13, /**< Those of the accepted responses that may be unsolicited (rule 11). */
    FATHOM_LINE_BUSY_ATTEMPTS =
        17, /**< Attempts that ended with FATHOM_ERR_LINE_BUSY, sent or not (rule 3). */
    FATHOM_LINE_OTHER_MASTERS = 18, /**< Attempts that ended with FATHOM_ERR_OTHER_MASTER (rule 12). */
    FATHOM_LINE_COUNTERS = 19       /**< Number of counters. 14 to 16 are unused. */
};

/** @brief What is known about local echo: whether the adapter returns the bytes that are sent. */
enum {
    FATHOM_LINE_ECHO_AUTO = 0, /**< Not known. In the parts: fathom_line_find_echo() finds out. */
    FATHOM_LINE_ECHO_OFF = 1,  /**< The adapter does not echo. */
    FATHOM_LINE_ECHO_ON = 2    /**< The adapter echoes. */
};

/**
 * @brief What a line is made of: its UART, clock, buffer, timing and optional parts. In the caller's memory.
 *
 * The line uses its parts at every call, so this struct and everything it points to must stay valid as long as the
 * line. A local variable of a set-up function is a mistake; a build with FATHOM_ASSERT (status.h) stops at it. Only
 * `silence_us` and `gap_us` may be changed while the line is used, for example after a change of the baud rate. A member whose comment names a default takes it if the member is 0. The members from `find_echo` on, except for `counters` and `busy_us`,
 * name optional parts: a part that is NULL is not linked.
 */
typedef struct {
    /** @brief The UART that the line owns. Nothing else may read it or write to it. Needs `read`, `write`, `sent`. */
    const fathom_uart_t *uart;

    /** @brief The clock of the line. */
    const fathom_clock_t *clock;

    /** @brief Buffer for requests and responses, `frame_size` bytes. Only the line may use it. It must stay valid as
     * long as the line is used. */
    uint8_t *frame;

    /**
     * @brief Size of `frame` in bytes, 8 to 255: the longest frame on this line.
     *
     * 13 bytes suffice for the distances of A16, A05 and HPS-167S. 27 bytes suffice for the details of an HPS-167S. A
     * larger buffer lets longer foreign frames pass undivided.
     */
    uint8_t frame_size;

    /** @brief FATHOM_LINE_ECHO_OFF or _ON, or _AUTO together with `find_echo`. Read by fathom_line_init() and after an
     * error of the port. */
    uint8_t echo;

    /**
     * @brief Silence before a request, in microseconds, 1 to 65534. 0 selects FATHOM_LINE_DEFAULT_SILENCE_US.
     *
     * Use fathom_silence_us() or FATHOM_T3_5_US(). From the first transaction on whose line settings have less than 19200
     * baud, the silence is at least FATHOM_LINE_DEFAULT_SILENCE_US, which 9600 baud need.
     */
    uint16_t silence_us;

    /**
     * @brief Silence that ends an incomplete frame, in microseconds, 100 to 65534, or FATHOM_LINE_NO_GAP. 0 selects
     * FATHOM_LINE_DEFAULT_GAP_US.
     *
     * Choose at least 1.5 characters, and more than the pauses of a slow sender or port. Behind an operating system
     * choose 25000, because USB adapters hold bytes back for 16 ms.
     *
     * Through a network or another program, a response may arrive in pieces with any pauses. FATHOM_LINE_NO_GAP
     * accepts them; a damaged response then ends the attempt at the time-out.
     */
    uint16_t gap_us;

    /** @brief Line settings of all transactions that name none; NULL: those leave the settings unchanged. Must stay valid. */
    const fathom_line_settings_t *line_settings;

    /** @brief fathom_line_find_echo to find out whether the adapter echoes; else NULL. */
    void (*find_echo)(fathom_line_t *line, uint8_t echo);

    /**
     * @brief fathom_line_marks to use what the port reports about the bytes (fathom_rx_t); else NULL.
     *
     * The port can report silence, parity errors, framing errors and overruns. The line uses its time stamps in any
     * case. Behind a gateway, name fathom_line_refusals.
     */
    uint8_t (*marks)(fathom_line_t *line, const fathom_rx_t *rx, uint8_t count);

    /** @brief fathom_line_count to count events in `counters`; else NULL. */
    void (*count)(fathom_line_t *line, uint8_t which, uint8_t by);

    /** @brief Array of FATHOM_LINE_COUNTERS counters in the caller's memory. Needed if `count` is set. */
    uint16_t *counters;

    /**
     * @brief The longest wait for silence before an attempt, in microseconds (rule 3): more than `silence_us`, at most
     * 2^31 - 1. 0 selects FATHOM_LINE_DEFAULT_BUSY_US.
     */
    uint32_t busy_us;

    /** @brief &fathom_line_senders if a device on this line may send by itself (rule 11); else NULL. */
    const fathom_line_senders_t *senders;

    /** @brief &fathom_line_masters if another master may use this line (rule 12); else NULL. */
    const fathom_line_masters_t *masters;
} fathom_line_parts_t;

/**
 * @brief A phase of a line. A line is in exactly one phase at a time.
 *
 * src/engine/README.md has the transitions. Phases from FATHOM_LINE_PORT_BUSY on use the transaction at the head of the
 * queue. Phases from FATHOM_LINE_SENDING on have that transaction on the wire.
 */
typedef enum {
    FATHOM_LINE_IDLE = 0,         /**< No request is in progress. */
    FATHOM_LINE_IN_BREAK = 1,     /**< The caller holds TX low. */
    FATHOM_LINE_ENDING_BREAK = 2, /**< The break has ended, but the port has not released TX yet. */
    FATHOM_LINE_DRAINING = 3,     /**< A cancelled request is still leaving the port. */
    FATHOM_LINE_PORT_BUSY = 4, /**< The port was too busy to accept the request; the next poll tries again. */
    FATHOM_LINE_SENDING = 5,   /**< The port has accepted the request and is sending it. */
    FATHOM_LINE_WAITING = 6,   /**< The request has left; the response may arrive. */
    FATHOM_LINE_FINISHING = 7 /**< The time-out has passed, but a frame had begun that may be the response. */
} fathom_line_phase_t;

/**
 * @brief A line, in the caller's memory.
 *
 * All members are private. The one exception is a policy of line_turns.h, which may read `head`, `polled_us` and
 * `quarantine_left_us`.
 */
struct fathom_line {
    /* private: */

    uint8_t phase;          /**< A fathom_line_phase_t. */
    uint8_t received_count; /**< Number of received bytes at the beginning of the frame buffer. */
    uint8_t passed_count;   /**< Number of these bytes that the listener has received already. */

    /** @brief The attempt on the wire. Invariant: `request_length` and `fault` are 0 unless SENDING or WAITING. */
    struct {
        uint8_t
            request_length; /**< Length of the request in bytes. 0 if no unit responds to it (a broadcast). */
        uint8_t fault;      /**< The worst fault of what the unit has sent: enum fault of line_internal.h. */
        uint8_t copy;       /**< What has arrived of the echo: enum copy of line_internal.h. */
    } attempt;

    /**
     * @brief The silence before the next request, or before the request on the wire: enum wait of line_internal.h.
     *
     * Invariant: while a transaction waits in IDLE or IN_BREAK, `phase_left_us` is the rest of its wait.
     */
    uint8_t wait;

    uint8_t echo;      /**< FATHOM_LINE_ECHO_AUTO, _OFF or _ON: what is known about local echo. */
    bool is_after_gap; /**< For the listener: true if the next byte that it receives begins a new frame. */
    uint8_t age;       /**< Whether the port may hold old bytes: enum age of line_internal.h. */

    bool
        is_slow; /**< True if a transaction has named less than 19200 baud: the silence is that of 9600 then. */
    uint8_t slot;              /**< Where in the present silence the line is: enum slot of line_internal.h. */
    uint8_t sender;            /**< Whether a device sends by itself: enum sender of line_internal.h. */
    uint8_t unsolicited_count; /**< Bytes since the last response that belong to no transaction, 0 to 4. */

    /** @brief The unit that has to respond to another master; FATHOM_LINE_ANY_UNIT: only the time ends this. Meaningless if
     * `awaited_left_us` is 0. */
    uint8_t awaited_unit;
    bool is_answered;          /**< True if a frame arrived since the newest request of another master. */
    uint8_t unrequested_count; /**< Frames in a row that no master had requested, 0 to 2. */

    uint16_t quarantined_units; /**< Set of units in quarantine: bit (address modulo 16). */
    uint16_t parts_sum;         /**< A sum over the parts, for FATHOM_ASSERT; else not used. */
    uint16_t silent_us; /**< Silence since the last byte in either direction, in us; stops at 65535. */

    const fathom_line_parts_t *parts; /**< NULL until the line is initialised. */
    fathom_transaction_t *head;       /**< The queue. Invariant: the transaction on the wire is the first. */
    fathom_listener_t *listener;      /**< The listener, or NULL. */
    const fathom_protocol_t
        *protocol; /**< Of the newest request. Invariant: not NULL if a response can arrive. */
    const fathom_line_kind_t *kind; /**< NULL until the line is initialised. */
    uint32_t polled_us;             /**< The clock at the last poll. */

    /** @brief Time left in the present phase, in us: the time-out, the time that the port has, or the wait. */
    uint32_t phase_left_us;
    /** @brief Time until all quarantines end, in us. */
    uint32_t quarantine_left_us;
    /** @brief Time until no unit has to respond to another master, in us. */
    uint32_t awaited_left_us;
};

/**
 * @brief Finds out whether the adapter echoes. Name it in fathom_line_parts_t::find_echo; only the line calls it.
 *
 * @param line  The line.
 * @param echo  FATHOM_LINE_ECHO_OFF or FATHOM_LINE_ECHO_ON, as the received bytes show.
 */
void fathom_line_find_echo(fathom_line_t *line, uint8_t echo);

/**
 * @brief Applies what the port reports with received bytes. Name it in fathom_line_parts_t::marks; only the line
 * calls it.
 *
 * @param line   The line.
 * @param rx     The port's report on these bytes.
 * @param count  Number of new bytes, which stand behind the bytes in the frame buffer.
 * @return Number of the new bytes that remain; 0 if the port marked the bytes as bad.
 */
uint8_t fathom_line_marks(fathom_line_t *line, const fathom_rx_t *rx, uint8_t count);

/**
 * @brief Ends an attempt when the port reports FATHOM_RX_NO_RESPONSE. Name it in `marks`; only the line calls it.
 *
 * The attempt ends as after its time-out. Its unit is not quarantined, so a retry leaves at once.
 *
 * @param line   The line.
 * @param rx     The port's report on these bytes. Only FATHOM_RX_NO_RESPONSE is used.
 * @param count  Number of new bytes.
 * @return `count`, or 0 if the flag is set: the line drops the bytes.
 */
uint8_t fathom_line_refusals(fathom_line_t *line, const fathom_rx_t *rx, uint8_t count);

/**
 * @brief Counts an event. Name it in fathom_line_parts_t::count; only the line calls it.
 *
 * @param line   The line.
 * @param which  Index of the counter, 0 to FATHOM_LINE_COUNTERS - 1.
 * @param by     Amount that is added. The counter stops at 65535.
 */
void fathom_line_count(fathom_line_t *line, uint8_t which, uint8_t by);

/**
 * @brief Initialises a line that sends requests.
 *
 * Any contents of `*line` are overwritten. Before a second call, end its transactions with fathom_line_cancel().
 *
 * @param line    The line. Must stay valid until its last use.
 * @param parts   What the line is made of. Must stay valid as long as the line.
 * @retval FATHOM_OK         The line can be used.
 * @retval FATHOM_ERR_ARGUMENT  A member of `*parts` or of its `uart` is outside its range, or `echo` is
 *                              FATHOM_LINE_ECHO_AUTO and `find_echo` is NULL. Correct it. Until then every
 *                              function of this line returns FATHOM_ERR_ARGUMENT, false or FATHOM_NO_DEADLINE.
 */
fathom_status_t fathom_line_init(fathom_line_t *line, const fathom_line_parts_t *parts);

/**
 * @brief Initialises a line that only listens: the listener receives all bytes.
 *
 * The program links nothing that sends. The member `echo` of the parts has no effect.
 *
 * @param line    The line. Must stay valid until its last use.
 * @param parts   What the line is made of. Must stay valid as long as the line.
 * @retval FATHOM_OK         The line can be used. Next, call fathom_line_listen().
 * @retval FATHOM_ERR_ARGUMENT  A member of `*parts` is outside its range. Correct it.
 */
fathom_status_t fathom_line_init_listening(fathom_line_t *line, const fathom_line_parts_t *parts);

/**
 * @brief Puts a transaction at the end of the queue.
 *
 * @param line         The line.
 * @param transaction  The transaction. The line uses it until its status differs from FATHOM_PENDING.
 * @retval FATHOM_PENDING          The transaction is queued. Call fathom_line_poll() until its status changes.
 * @retval FATHOM_ERR_BUSY         The transaction is already queued. Nothing has changed.
 * @retval FATHOM_ERR_ARGUMENT     `timeout_us` is above 2^31 - 1, `retries` is 255, or the line is not initialised.
 *                                 Nothing has changed.
 * @retval FATHOM_ERR_UNSUPPORTED  The line only listens. Nothing has changed.
 */
fathom_status_t fathom_line_submit(fathom_line_t *line, fathom_transaction_t *transaction);

/**
 * @brief Ends a transaction with FATHOM_ERR_CANCELLED and returns its memory to the caller.
 *
 * If the transaction is on the wire, the request still leaves the port completely, and the unit is quarantined because
 * its response may still arrive. If the transaction is not queued, this function does nothing.
 *
 * @param line         The line.
 * @param transaction  The transaction. The caller may reuse or free it after the call.
 */
void fathom_line_cancel(fathom_line_t *line, fathom_transaction_t *transaction);

/**
 * @brief Cancels every transaction with one unit, as fathom_line_cancel() does.
 *
 * @param line     The line.
 * @param address  The address in the transactions, 0 to 255. FATHOM_LINE_ANY_UNIT cancels only the transactions with
 *                 exactly that address.
 */
void fathom_line_cancel_unit(fathom_line_t *line, uint8_t address);

/**
 * @brief Returns whether a transaction is queued or on the wire.
 *
 * @param line         The line.
 * @param transaction  The transaction. The function compares only the pointer.
 * @retval true   The transaction is the line's: do not change or free it.
 * @retval false  The transaction is the caller's.
 */
bool fathom_line_is_queued(const fathom_line_t *line, const fathom_transaction_t *transaction);

/**
 * @brief Returns whether nothing was on the wire at the last poll.
 *
 * @param line  The line.
 * @retval true   No request was leaving, no response could arrive in time, and no part of a frame had arrived. Queued
 *                transactions do not count.
 * @retval false  At least one of these was the case. Poll again.
 */
bool fathom_line_is_idle(const fathom_line_t *line);

/**
 * @brief Sets the listener of a line that has none, or removes the listener.
 *
 * @param line      The line.
 * @param listener  The listener, or NULL to remove the listener. Must stay valid until the line has another or none.
 * @retval FATHOM_OK     The line has this listener, or none.
 * @retval FATHOM_ERR_BUSY  The line has another listener, and nothing changed. Remove that one, or call
 *                          fathom_line_replace_listener().
 */
fathom_status_t fathom_line_listen(fathom_line_t *line, fathom_listener_t *listener);

/**
 * @brief Sets the listener, whether the line has another one or not.
 *
 * @param line      The line.
 * @param listener  The listener, or NULL for none. Must stay valid until the line has another or none.
 * @return The previous listener, or NULL.
 */
fathom_listener_t *fathom_line_replace_listener(fathom_line_t *line, fathom_listener_t *listener);

/**
 * @brief Removes a listener, if it is the listener of the line. Else nothing changes.
 *
 * @param line      The line.
 * @param listener  The listener. The function compares only the pointer. The caller may reuse or free it after the call.
 */
void fathom_line_unlisten(fathom_line_t *line, const fathom_listener_t *listener);

/**
 * @brief Returns whether the line holds received bytes back from the listener.
 *
 * The line holds bytes back while they may be the beginning of a response. Then no silence stands behind the bytes that
 * the listener has received, however long ago the last of them arrived.
 *
 * @param line  The line.
 * @retval true   The frame buffer contains bytes that the listener has not received.
 * @retval false  The listener has received all bytes that are for it, up to the last poll.
 */
bool fathom_line_holds_bytes(const fathom_line_t *line);

/**
 * @brief Drops all bytes that have arrived so far, in the port and in the frame buffer.
 *
 * Call this function before the first poll after a sleep during which the clock may have wrapped or stood still.
 *
 * @param line  The line.
 */
void fathom_line_flush(fathom_line_t *line);

/**
 * @brief Holds TX low, or releases it.
 *
 * Some modules use our TX as a trigger or mode-select input. While TX is low, the line sends nothing. Transactions wait
 * in the queue, at most for `busy_us` each (rule 3). After TX is released, the line keeps the silence before the next request. Once a break has begun,
 * it lasts until a call with `on` false returns FATHOM_OK. This holds even if fathom_line_poll() returns
 * FATHOM_ERR_PORT in between and the port returns as another device whose TX is high.
 *
 * @param line  The line.
 * @param on    True to hold TX low, false to release it.
 * @retval FATHOM_OK            TX is in the requested state.
 * @retval FATHOM_PENDING          The port is still sending. Call again, for example after 1 ms; fathom_line_due_us()
 *                                 does not include this.
 * @retval FATHOM_ERR_BUSY         A transaction is on the wire, so the break cannot begin. Call again after it.
 * @retval FATHOM_ERR_UNSUPPORTED  The port has no `set_break`.
 * @retval FATHOM_ERR_PORT         The port is broken, or it did not release TX within FATHOM_LINE_SEND_US. If TX was to
 *                                 be released, all queued transactions have ended with this error too. Continue to call
 *                                 this function, or TX stays low.
 */
fathom_status_t fathom_line_break(fathom_line_t *line, bool on);

/**
 * @brief Does all work that can be done without waiting: reads received bytes, ends and starts transactions.
 *
 * Call this function often, and at least every 71 minutes. One call reads the port at most 16 times. Several users of
 * one line may each call it, or share one poll (fathom_line_was_polled()). A program that sleeps calls it when a byte
 * arrives and after fathom_line_due_us().
 *
 * @param line  The line.
 * @retval FATHOM_PENDING   The line works. The results are in the transactions.
 * @retval FATHOM_ERR_ARGUMENT  The line is not initialised.
 * @retval FATHOM_ERR_PORT  The port is broken, and every queued transaction has ended with this error. Continue to
 *                          poll: the line works again as soon as the port does.
 */
fathom_status_t fathom_line_poll(fathom_line_t *line);

/**
 * @brief Returns whether another user has polled the line in this round, so that this user need not poll it.
 *
 * A round is one turn of the main loop. If each user of a line remembers when it last came here, one poll in each round
 * suffices, however many users the line has:
 *
 * @code
 * if (!fathom_line_was_polled(&line, called_us)) fathom_line_poll(&line);
 * called_us = now_us();
 * @endcode
 *
 *     round                 |         1         |         2         |
 *     user                  |  A     B     C    |  A     B     C    |
 *     polls the line        |  x                |  x                |
 *
 * The Modbus drivers do this, so a round of fathom_poll() reads the port once. A program need not do anything for it. The
 * program may call fathom_line_poll() itself at the beginning of each round; then no driver polls. If the program forgets
 * that in a round, the first driver polls again. A request that a driver submits leaves with the next poll of the line,
 * in the same round or in the next one.
 *
 * @param line      The line.
 * @param since_us  The clock at the previous call of this user, in microseconds.
 * @retval true   The line was polled after `since_us` and less than FATHOM_LINE_ROUND_US ago.
 * @retval false  Call fathom_line_poll(). This is the result also if the clock has not moved since the last poll, if the
 *                line is not initialised, and, after an error of the port, until the port was seen empty.
 */
bool fathom_line_was_polled(const fathom_line_t *line, uint32_t since_us);

/**
 * @brief Returns the time in microseconds until fathom_line_poll() must be called again if no byte arrives.
 *
 * While the port sends, or is too busy to accept a request, the time is the port's `leaves_in_us` (hal.h). If the port
 * does not know that time, this function returns the time until 1 ms after the last poll.
 *
 * @param line  The line.
 * @retval FATHOM_NO_DEADLINE  Only a received byte or a new transaction can change anything. Poll at least every 71
 *                             minutes all the same.
 */
uint32_t fathom_line_due_us(const fathom_line_t *line);

/**
 * @brief Returns what is known about local echo.
 *
 * @param line  The line.
 * @retval FATHOM_LINE_ECHO_AUTO  Not known yet.
 * @retval FATHOM_LINE_ECHO_OFF   The adapter does not echo: by the parts, or as received bytes showed.
 * @retval FATHOM_LINE_ECHO_ON    The adapter echoes: by the parts, or as received bytes showed.
 */
uint8_t fathom_line_get_echo(const fathom_line_t *line);

/**
 * @brief Returns the clock at the arrival of the last byte, in microseconds.
 *
 * @param line  The line.
 * @return The clock, as exact as the port's time stamps or the polling. Valid for 65 ms after that byte.
 */
uint32_t fathom_line_last_byte_us(const fathom_line_t *line);

#ifdef __cplusplus
}
#endif

#endif
