/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_LINE_CONVERSATION_H
#define FATHOM_TESTS_LINE_CONVERSATION_H

#include "line_bench.h"

/*
 * A conversation is one test of the line: its name, the counters at its end, and its steps in their order. A counter
 * that a row does not name must be 0. A is bench.request, and B is bench.other. Times are in microseconds.
 *
 *     ROW("a_late_response_is_counted_and_not_delivered", COUNTS(.no_responses = 1, .late = 1, .dropped = 7),
 *         ASK(A, 1), WAIT(TIMEOUT_US + 200), RESPONSE(1, 754), FAILS(A, NO_RESPONSE)),
 *
 * A test with a loop or a branch is a function.
 */
typedef struct step {
    void (*play)(const struct step *step);
    uint8_t which; /* A or B, a counter, or a boolean */
    uint8_t unit;
    int32_t value; /* a status, a distance in mm, or a number of something */
    uint32_t us;
    const char *hex;
} step_t;

/* In the order of FATHOM_LINE_RESPONSES, FATHOM_LINE_DROPPED_BYTES, ... */
typedef struct {
    uint16_t responses, dropped, port_errors, no_responses, damaged, exceptions, malformed, late, strays, bad,
        old, echoes, foreign, maybe_unsolicited, unused[3], busy, other_masters;
} counts_t;

typedef struct {
    const char *name;
    counts_t counts; /* at the end */
    step_t steps[18];
} conversation_t;

#define COUNTS(...)                                                                                          \
    {                                                                                                        \
        __VA_ARGS__                                                                                          \
    }
#define ROW(its_name, its_counts, ...)                                                                       \
    {                                                                                                        \
        its_name, its_counts, { __VA_ARGS__ }                                                                \
    }

enum { A, B };

#define STEP(what, ...)                                                                                      \
    {                                                                                                        \
        .play = play_##what, __VA_ARGS__                                                                     \
    }

/* Actions. QUEUE submits a read; ASK also runs until its last bit has left. WRITE submits set_address_5 to a unit. */
#define QUEUE(x, to)               STEP(queue, .which = (x), .unit = (to), .us = TIMEOUT_US)
#define QUEUE_TWICE(x, to)         STEP(queue, .which = (x), .unit = (to), .us = TIMEOUT_US, .value = 1)
#define ASK(x, to)                 STEP(ask, .which = (x), .unit = (to), .us = TIMEOUT_US)
#define ASK_TWICE(x, to)           STEP(ask, .which = (x), .unit = (to), .us = TIMEOUT_US, .value = 1)
#define ASK_FOR(x, to, for_us)     STEP(ask, .which = (x), .unit = (to), .us = (for_us))
#define WRITE(x, to)               STEP(write, .which = (x), .unit = (to))
#define CANCEL(x)                  STEP(cancel, .which = (x))
#define WAIT(for_us)               STEP(wait, .us = (for_us))
#define POLL                       STEP(poll, .which = 0)
#define POLL_AFTER(in_us)          STEP(poll_after, .us = (in_us)) /* one poll */
#define RECEIVE(text)              STEP(receive, .hex = (text))
#define RECEIVE_WITH(flag, text)   STEP(receive, .hex = (text), .which = FATHOM_RX_##flag)
#define ARRIVE(text)               STEP(arrive, .hex = (text)) /* no poll */
#define SEND(text)                 STEP(send, .hex = (text)) /* a device, byte by byte until the last one has arrived */
#define RESPONSE(from, mm)         STEP(response, .unit = (from), .value = (mm))
#define HOLD(low)                  BREAK(low, FATHOM_OK) /* TX is low, or not any more */
#define BREAK(low, status)         STEP(break, .which = (low), .value = (status))
#define PASS(for_us)               STEP(pass, .us = (for_us)) /* no poll */
#define JAM(for_us)                STEP(jam, .us = (for_us))  /* a byte 00 in each character time */
#define ECHO(known)                STEP(echo, .value = FATHOM_LINE_ECHO_##known)
#define LISTEN(gap)                STEP(listen, .us = (gap))
#define LISTEN_FOR_NEW(gap, stale) STEP(listen, .us = (gap), .value = (stale)) /* what is older is stale */
#define FLUSH                      STEP(flush, .which = 0)
#define BREAK_PORT                 STEP(break_port, .which = 0)
#define PORT_REFUSES(on)           STEP(refuse, .which = (on))
#define NEVER_SENT(on)             STEP(never_sent, .which = (on))
#define LEAVES_IN(in_us)           STEP(leaves_in, .us = (in_us)) /* what the port says of its bytes */
#define SILENCE(new_us)            STEP(silence, .us = (new_us))  /* of the config */
#define BUSY_US(new_us)            STEP(busy_us, .us = (new_us))  /* of the config */

/* Expectations. SENT: no request leaves for `after`, and one leaves within `within` after that. */
#define FAILS(x, status)    STEP(fails, .which = (x), .value = FATHOM_ERR_##status)
#define PENDS(x)            STEP(fails, .which = (x), .value = FATHOM_PENDING)
#define ENDS(x, status)     STEP(ends, .which = (x), .value = (status)) /* of a write */
#define ATTEMPTS(x, n)      STEP(attempts, .which = (x), .value = (n))
#define READS(x, mm)        STEP(reads, .which = (x), .value = (mm))
#define WRITTEN(n)          STEP(written, .value = (n))
#define REQUEST_TO(n, id)   STEP(request_to, .value = (n), .unit = (id)) /* the n-th request, from 0 on */
#define SENT(after, within) STEP(sent, .us = (after), .value = (within))
#define DUE(in_us)          STEP(due, .us = (in_us))
#define IN_BREAK(is_so)     STEP(in_break, .which = (is_so))
#define IDLE(is_idle)       STEP(idle, .which = (is_idle))
#define ECHO_IS(known)      STEP(echo_is, .value = FATHOM_LINE_ECHO_##known)
#define COUNT(counter, n)   STEP(count, .which = FATHOM_LINE_##counter, .value = (n))
#define HEARD(text, pauses) STEP(heard, .hex = (text), .which = (pauses)) /* by the listener, with gaps */
#define GAP_AT(n)           STEP(gap_at, .value = (n))                    /* the last gap, behind n bytes */
#define LOST_AT(n, times)   STEP(lost_at, .value = (n), .which = (times))

typedef void play_step_t(const step_t *step);
play_step_t play_queue, play_ask, play_write, play_cancel, play_wait, play_poll_after, play_receive,
    play_break, play_pass, play_in_break, play_arrive, play_send, play_gap_at, play_lost_at, play_response,
    play_jam, play_echo, play_listen, play_flush, play_break_port, play_refuse, play_never_sent, play_fails,
    play_ends, play_reads, play_written, play_request_to, play_sent, play_due, play_idle, play_count,
    play_heard, play_poll, play_leaves_in, play_silence, play_busy_us, play_attempts, play_echo_is;

fathom_modbus_request_t *request_of(const step_t *step);

/* Plays the row in *state on a line that `begin` sets up, such as set_up. */
void play_conversation(void **state, int (*begin)(void **state));

/* Registers each row of a table as a test of its own. */
#define CONVERSATIONS(begin, table)                                                                          \
    static void play_##table(void **state) { play_conversation(state, begin); }                              \
    __attribute__((constructor)) static void add_##table(void)                                               \
    {                                                                                                        \
        static const suite_t of_rows;                                                                        \
        static suite_test_t nodes[COUNT_OF(table)];                                                          \
        for (size_t i = 0; i != COUNT_OF(table); i++)                                                        \
            suite_add(&nodes[i], &of_rows, __FILE__, table[i].name, play_##table, &table[i]);                \
    }

#endif
