/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

/*
 * A line that sends requests: when a request may leave, how it leaves, and the public functions of such a line.
 *
 *                  port accepts the request          last bit has left
 *       +------+ ---------------------------> SENDING ---------------> WAITING
 *       | IDLE |                               ^   |                      |
 *       |      | --port is busy--> PORT_BUSY --+   | cancel               | response, time-out,
 *       |      |                       |           v                      | damage and gap, cancel
 *       |      | <-----cancel----------+        DRAINING                  |
 *       |      | <--------------last bit has left--+                      |
 *       |      | <--------------------------------------------------------+
 *       |      |
 *       |      | --set break--> IN_BREAK --release, port is not ready--> ENDING_BREAK
 *       +------+ <---TX released---+-------------------TX released------------+
 *
 * src/engine/README.md has all transitions.
 */

/* ---- When a request may leave ---- */

/*
 * Returns the transaction that is sent next: the first in the queue whose unit is not in quarantine, or NULL.
 *
 * Retry policy: other units first. A failed transaction with retries left stays at the head of the queue, and its unit
 * is in quarantine, so this function skips it until the quarantine is over. To retry at once, return here the head of
 * the queue if its `attempts` are not 0. A policy of line_turns.h replaces this function.
 */
static fathom_transaction_t *next(const fathom_line_t *line)
{
    fathom_transaction_t *transaction = line->head;
    while ((transaction != NULL) && fathom_line_is_quarantined(line, transaction->address))
        transaction = transaction->link.next;
    return transaction;
}

/* Returns the time until the silence before a request is kept if no byte arrives, counted from the last poll. */
static uint32_t silence_in_us(const fathom_line_t *line)
{
    if (is_in_break(line) || holds_bytes(line))
        return FATHOM_NO_DEADLINE; /* Wait for the end of the frame. */
    if (line->awaited_left_us != 0u)
        return line->awaited_left_us - 1u; /* It ends at 1, with a poll (line.c). */
    if (line->parts->senders != NULL) return line->parts->senders->slot_in_us(line);
    return fathom_line_silence_left_us(line);
}

/* Returns true if `transaction` may leave in this silence. Without a transaction the slot passes unused. */
static bool take_slot(fathom_line_t *line, const fathom_transaction_t *transaction)
{
    const fathom_line_senders_t *const senders = line->parts->senders;
    if (silence_in_us(line) != 0u) return false;
    return (senders == NULL) || senders->take_slot(line, transaction);
}

/* Returns the time until the next request may leave, or until its wait is over. The queue is not empty, and no request
 * is on the wire. */
static uint32_t due_us(const fathom_line_t *line)
{
    if (next(line) == NULL) return line->quarantine_left_us;
    const uint32_t left_us = silence_in_us(line);
    if (is_waiting(line)) return least_us(left_us, line->phase_left_us);
    return is_in_break(line) ? 0u : left_us; /* The next poll begins the wait for the end of the break. */
}

/*
 * The wait for silence is bounded, so that every transaction ends.
 *
 *     bytes    ###  ## #  ###  #  ####   # #   never `silence_us` without one
 *     wait     |<------------- busy_us ------------->|
 *              | a transaction may be sent           | a read, and no complete frame was heard: it leaves all the same
 *                                                    | else: FATHOM_ERR_LINE_BUSY, and it was not sent
 *
 *  - Noise without frames comes from a cable without bias or from a motor. It may leave enough of a read and of its
 *    response intact, and a damaged read changes nothing.
 *  - A write stays away from noise: with an 8-bit sum, a damaged write can become another command.
 *  - Complete frames come from other devices, and a request would damage them.
 *  - While the caller holds TX low, nothing leaves, and the wait goes on. While the port does not accept a request, or
 *    does not release TX, `phase_left_us` is the time that the port has, and the wait ends with it.
 *  - The wait begins when a transaction may be sent, and begins anew after each attempt. Only the transaction that
 *    would be sent next ends; the next one begins a wait of its own.
 */
static bool is_ports_time(const fathom_line_t *line)
{
    return (line->phase == FATHOM_LINE_PORT_BUSY) || (line->phase == FATHOM_LINE_ENDING_BREAK);
}

static void begin_wait(fathom_line_t *line)
{
    line->wait = (line->awaited_left_us != 0u) ? WAIT_FRAMES : WAIT_NOISE;
    line->phase_left_us = busy_us(line);
}

/* The wait is over. Returns true if the transaction leaves without silence; else ends it. */
static bool leaves_into_noise(fathom_line_t *line, fathom_transaction_t *transaction)
{
    if ((line->wait != WAIT_FRAMES) && !is_in_break(line) && may_collide(transaction)) return true;
    fathom_line_add(line, FATHOM_LINE_BUSY_ATTEMPTS, 1);
    line->wait = WAIT_NONE;
    fathom_line_finish(line, fathom_line_find(line, transaction), FATHOM_ERR_LINE_BUSY);
    return false;
}

/* Returns the transaction that leaves now, or NULL. */
static fathom_transaction_t *choose(fathom_line_t *line)
{
    fathom_transaction_t *const transaction = line->kind->next(line);
    if (take_slot(line, transaction) && (transaction != NULL)) return transaction;

    if (transaction == NULL) { /* The queue is empty, all its units are in quarantine, or the policy waits. */
        line->wait = WAIT_NONE;
        if (line->phase == FATHOM_LINE_PORT_BUSY) line->phase = FATHOM_LINE_IDLE;
        return NULL;
    }
    if (!is_ports_time(line) && !is_waiting(line)) begin_wait(line);
    if (line->phase_left_us != 0u) return NULL;
    return leaves_into_noise(line, transaction) ? transaction : NULL;
}

/* ---- Sending ---- */

static void move_to_front(fathom_line_t *line, fathom_transaction_t *transaction)
{
    *fathom_line_find(line, transaction) = transaction->link.next;
    transaction->link.next = line->head;
    line->head = transaction;
}

/* The port has accepted the request of the transaction at the head of the queue. */
static void begin_attempt(fathom_line_t *line, uint8_t length)
{
    fathom_transaction_t *const transaction = line->head;
    const fathom_protocol_t *const protocol = transaction->protocol;
    const bool is_broadcast =
        (transaction->address == FATHOM_LINE_ALL_UNITS) && !protocol->is_unit_0_ordinary;
    transaction->attempts++;
    line->protocol = protocol;
    line->attempt.request_length = is_broadcast ? 0u : length;
    line->attempt.copy = (line->echo == FATHOM_LINE_ECHO_OFF) ? COPY_PAST : COPY_DUE;
    line->wait = (fathom_line_silence_left_us(line) == 0u) ? WAIT_NONE : WAIT_SKIPPED;
    line->phase = FATHOM_LINE_SENDING;
    line->phase_left_us = FATHOM_LINE_SEND_US;
}

/* The port accepts no request now, perhaps because of the settings. Each poll tries again for FATHOM_LINE_SEND_US. */
static fathom_status_t wait_for_port(fathom_line_t *line)
{
    if (line->phase == FATHOM_LINE_PORT_BUSY)
        return (line->phase_left_us != 0u) ? FATHOM_PENDING : fathom_line_broken(line);
    line->phase = FATHOM_LINE_PORT_BUSY;
    line->phase_left_us = FATHOM_LINE_SEND_US;
    return FATHOM_PENDING;
}

/* Sets the line settings of a transaction. Returns > 0: they are in force; 0: try again; < 0: not possible (hal.h). */
static int apply_settings(const fathom_line_t *line, const fathom_transaction_t *transaction)
{
    const fathom_uart_t *const uart = line->parts->uart;
    const fathom_line_settings_t *settings = transaction->line_settings;
    if (settings == NULL) settings = line->parts->line_settings;
    if (settings == NULL) return 1;
    if (uart->set_line == NULL) return -1;
    return uart->set_line(uart->ctx, settings);
}

/* Sends the request of the next transaction, if one may leave now. */
static fathom_status_t send_next(fathom_line_t *line)
{
    const fathom_uart_t *const uart = line->parts->uart;
    fathom_transaction_t *const transaction = choose(line);
    if (transaction == NULL) return FATHOM_PENDING;
    line->kind->scan(line, true); /* The request needs the frame buffer. */
    move_to_front(line, transaction);

    const int settings = apply_settings(line, transaction);
    if (settings == 0) return wait_for_port(line);
    if (settings < 0) {
        fathom_line_finish(line, &line->head, FATHOM_ERR_UNSUPPORTED);
        return FATHOM_PENDING;
    }
    const uint8_t length = transaction->protocol->encode(transaction, line->parts->frame);
    const int accepted = uart->write(uart->ctx, line->parts->frame, length);
    if (accepted == 0) return wait_for_port(line);
    if (accepted != (int)length) return fathom_line_broken(line);
    begin_attempt(line, length);
    return FATHOM_PENDING;
}

/* Follows a request that leaves the port until its last bit has left. */
static fathom_status_t follow_request(fathom_line_t *line)
{
    const fathom_uart_t *const uart = line->parts->uart;
    line->silent_us = 0;
    if (!uart->sent(uart->ctx))
        return (line->phase_left_us != 0u) ? FATHOM_PENDING : fathom_line_broken(line);
    if (line->phase == FATHOM_LINE_DRAINING) {
        line->phase = FATHOM_LINE_IDLE;
    } else {
        line->phase = FATHOM_LINE_WAITING;
        line->phase_left_us = line->head->timeout_us + FATHOM_LINE_FINISH_US;
    }
    return FATHOM_PENDING;
}

/* The last step of each poll: ends the phase if its time has come, and sends the next request if the wire is free. */
static fathom_status_t advance(fathom_line_t *line)
{
    switch (line->phase) {
    case FATHOM_LINE_SENDING:
    case FATHOM_LINE_DRAINING:
        return follow_request(line);
    case FATHOM_LINE_WAITING:
        if (fathom_line_attempt_left_us(line) != 0u) return FATHOM_PENDING;
        line->kind->scan(line, true); /* A frame in the buffer took too long. */
        if (is_busy(line)) fathom_line_end_attempt(line);
        break;
    default: /* IDLE, IN_BREAK, ENDING_BREAK, PORT_BUSY */
        if (is_echo_due(line) && (fathom_line_gap_left_us(line) == 0u)) line->attempt.copy = COPY_PAST;
        break;
    }
    return send_next(line);
}

/* The port is broken: all transactions end. The request on the wire may have left, so its unit may still respond. */
static void fail_all(fathom_line_t *line)
{
    if (is_busy(line)) {
        fathom_line_quarantine(line);
        line->silent_us = 0;
    }
    while (line->head != NULL) fathom_line_finish(line, &line->head, FATHOM_ERR_PORT);
}

static const fathom_line_kind_t requesting = {fathom_line_scan, advance, next, due_us, fail_all};

/* ---- Public functions ---- */

static bool can_send(const fathom_line_parts_t *parts)
{
    if ((parts->uart->write == NULL) || (parts->uart->sent == NULL) || (parts->echo > FATHOM_LINE_ECHO_ON) ||
        ((parts->echo == FATHOM_LINE_ECHO_AUTO) && (parts->find_echo == NULL)))
        return false;
    if (parts->busy_us == 0u) return true;
    return (parts->busy_us > or_default(parts->silence_us, FATHOM_LINE_DEFAULT_SILENCE_US)) &&
           (parts->busy_us <= FATHOM_MAX_DURATION_US);
}

fathom_status_t fathom_line_init(fathom_line_t *line, const fathom_line_parts_t *parts)
{
    const fathom_status_t status = fathom_line_begin(line, parts, &requesting);
    if ((status != FATHOM_OK) || can_send(parts)) return status;
    line->kind = NULL;
    line->parts = NULL;
    return FATHOM_ERR_ARGUMENT;
}

fathom_status_t fathom_line_submit(fathom_line_t *line, fathom_transaction_t *transaction)
{
    fathom_transaction_t **const link = fathom_line_find(line, transaction);
    if (*link != NULL) return FATHOM_ERR_BUSY;
    if ((line->kind == NULL) || (transaction->timeout_us > FATHOM_MAX_DURATION_US) ||
        (transaction->retries == UINT8_MAX))
        return FATHOM_ERR_ARGUMENT;
    if (line->kind->fail_all == NULL) return FATHOM_ERR_UNSUPPORTED; /* This line only listens. */
    if (line->protocol == NULL)
        line->protocol = transaction->protocol; /* From now on it recognises frames. */
    /* Where units differ in their line settings, the slowest needs the longest silence before its request. */
    if ((transaction->line_settings != NULL) && (transaction->line_settings->baud < 19200u))
        line->is_slow = true;
    *link = transaction;
    transaction->link.next = NULL;
    transaction->attempts = 0;
    transaction->status = FATHOM_PENDING;
    return FATHOM_PENDING;
}

/* The transaction on the wire is cancelled: its request leaves completely, and its echo and response may still come. */
static void abandon_attempt(fathom_line_t *line)
{
    fathom_line_quarantine(line);
    if (line->attempt.copy != COPY_PAST) line->attempt.copy = COPY_CANCELLED;
    fathom_line_free_wire(line,
                          (line->phase == FATHOM_LINE_SENDING) ? FATHOM_LINE_DRAINING : FATHOM_LINE_IDLE);
}

void fathom_line_cancel(fathom_line_t *line, fathom_transaction_t *transaction)
{
    fathom_transaction_t **const link = fathom_line_find(line, transaction);
    if (*link == NULL) return;
    if ((link == &line->head) && is_busy(line)) abandon_attempt(line);
    fathom_line_finish(line, link, FATHOM_ERR_CANCELLED);
}

void fathom_line_cancel_unit(fathom_line_t *line, uint8_t address)
{
    fathom_transaction_t *transaction = line->head;
    while (transaction != NULL) {
        fathom_transaction_t *const after =
            transaction->link.next; /* fathom_line_cancel() overwrites the link. */
        if (transaction->address == address) fathom_line_cancel(line, transaction);
        transaction = after;
    }
}

bool fathom_line_is_queued(const fathom_line_t *line, const fathom_transaction_t *transaction)
{
    const fathom_transaction_t *queued = line->head;
    while ((queued != NULL) && (queued != transaction)) queued = queued->link.next;
    return queued != NULL;
}

uint8_t fathom_line_get_echo(const fathom_line_t *line) { return line->echo; }
