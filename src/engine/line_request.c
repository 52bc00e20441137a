/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

/* The queue, when a transaction of it may leave, and which of them a response ends. */

fathom_transaction_t **fathom_line_find(fathom_line_t *line, const fathom_transaction_t *transaction)
{
    fathom_transaction_t **link = &line->head;
    while ((*link != NULL) && (*link != transaction)) link = &(*link)->link.next;
    return link;
}

void fathom_line_finish(fathom_line_t *line, fathom_transaction_t **link, fathom_status_t status)
{
    fathom_transaction_t *const transaction = *link;
    if ((link == &line->head) && (line->state >= REFUSED)) {
        line->state = IDLE;
        line->sent = 0;
    }
    *link = transaction->link.next;
    transaction->link.heard_us = fathom_line_heard_us(line);
    transaction->status = (int8_t)status;
}

/*
 * A response to the transaction on the wire may still come (fathom_line_is_quarantined). What broke off may have been
 * noise, and the response late; what was damaged from end to end hardly was, so that after it the rest of the time-out
 * is enough.
 */
static void quarantine(fathom_line_t *line)
{
    const fathom_transaction_t *const transaction = line->head;
    if (!expects_response(line)) return;
    uint32_t longest_us = (phase(line) == SENDING) ? transaction->timeout_us : line->left_us;
    if ((line->state & RESPONSE_CORRUPT) == 0) longest_us += transaction->timeout_us;
    if ((line->quarantined == 0u) || (line->quarantine_left_us < longest_us))
        line->quarantine_left_us = longest_us;
    line->quarantined |= quarantine_bits(transaction->address);
}

void fathom_line_end_attempt(fathom_line_t *line)
{
    fathom_status_t error = FATHOM_ERR_NO_RESPONSE;
    if (!expects_response(line)) {
        fathom_line_finish(line, &line->head, FATHOM_READY);
        return;
    }
    if ((line->state & RESPONSE_BAD) != 0)
        error = FATHOM_ERR_CHECKSUM;
    else if ((line->state & RESPONSE_UNEXPECTED) != 0)
        error = FATHOM_ERR_MALFORMED;
    count(line, (uint8_t)-error, 1);
    quarantine(line);
    if (((line->state & (ECHOED | RESPONSE_BAD | RESPONSE_UNEXPECTED)) == ECHOED) &&
        ((line->known & ECHO) == 0))
        error = FATHOM_ERR_ECHO;
    line->state = IDLE;
    line->sent = 0;
    if (line->head->attempts > line->head->retries) fathom_line_finish(line, &line->head, error);
}

/* ---- what comes in ---- */

/* Does a frame from this address concern the transaction? */
static bool is_of(const fathom_transaction_t *transaction, uint8_t address)
{
    return (transaction->address == address) || (transaction->address == FATHOM_LINE_ANY_UNIT);
}

bool fathom_line_expects_unit(const fathom_line_t *line, uint8_t address)
{
    return expects_response(line) && is_of(line->head, address);
}

bool fathom_line_deliver(fathom_line_t *line)
{
    const fathom_protocol_t *const protocol = line->protocol;
    const uint8_t *const frame = line->config->frame;
    const uint8_t address = frame[protocol->address_at];
    uint8_t before = NOISY;
    if (fathom_line_expects_unit(line, address)) {
        if (line->head->address == FATHOM_LINE_ANY_UNIT) quarantine(line);
        before = line->state & (uint8_t) ~(unsigned)(PHASE | RESPONSE_UNEXPECTED);
        line->state |= RESPONSE_UNEXPECTED;
    } else {
        const uint16_t quarantined = line->quarantined & (uint16_t)~quarantine_bits(address);
        const bool is_outstanding = (quarantined != line->quarantined) && ((line->known & ECHO_DUE) == 0);
        forget(line, ECHO_DUE);
        count(line, is_outstanding ? FATHOM_LINE_LATE_RESPONSES : FATHOM_LINE_STRAYS, 1);
        if (!is_outstanding) return false;
        line->quarantined = quarantined;
    }
    for (fathom_transaction_t **link = &line->head; *link != NULL; link = &(*link)->link.next) {
        fathom_transaction_t *const x = *link;
        if ((x->attempts == 0u) || !is_of(x, address) ||
            (x->protocol->parse_response != protocol->parse_response))
            continue;
        const fathom_status_t status = protocol->parse_response(x, frame);
        if ((status != FATHOM_READY) && (status != FATHOM_ERR_EXCEPTION)) continue;
        count(line, (status > 0) ? FATHOM_LINE_RESPONSES : FATHOM_LINE_EXCEPTIONS, 1);
        fathom_line_finish(line, link, status);
        if (before == 0u) fathom_line_learn(line, FATHOM_LINE_ECHO_OFF);
        return true;
    }
    return false;
}

/* ---- when one may leave ---- */

/* The first in the queue whose unit is not quarantined. */
static fathom_transaction_t *next(const fathom_line_t *line)
{
    fathom_transaction_t *x = line->head;
    while ((x != NULL) && ((line->quarantined & quarantine_bits(x->address)) != 0u)) x = x->link.next;
    return x;
}

static uint32_t due_us(const fathom_line_t *line)
{
    if (next(line) == NULL) return line->quarantine_left_us;
    return rest_us(is_late(line) ? QUIET_US : silence_us(line), line->silent_us);
}

/* Has the line been silent for long enough? Among frames that a device sends by itself a request fits right behind a
 * frame and nowhere else: not behind a response, which a frame may have waited for, nor later in a silence. */
static bool may_send(fathom_line_t *line)
{
    if (line->silent_us < silence_us(line)) return false;
    if (line->silent_us == QUIET_US) forget(line, UNASKED | OTHERS_SEND);
    if (is_late(line)) return false;
    line->known |= LATE;
    return true;
}

static fathom_status_t go_on(fathom_line_t *line)
{
    if ((phase(line) == SENDING) || (line->state == LEAVING)) {
        const fathom_uart_t *const uart = line->config->uart;
        line->silent_us = 0;
        if (uart->sent(uart->ctx)) {
            if (line->state == LEAVING) {
                line->state = IDLE;
            } else {
                line->state |= LISTENING;
                line->left_us = line->head->timeout_us;
            }
        } else if (line->left_us == 0u) {
            return fathom_line_broken(line);
        }
        return FATHOM_PENDING;
    }
    if (line->have != 0u) return FATHOM_PENDING;
    if (is_busy(line)) {
        if ((line->left_us != 0u) &&
            (((line->state & RESPONSE_BAD) == 0) || (line->silent_us < gap_us(line))))
            return FATHOM_PENDING;
        fathom_line_end_attempt(line);
    }
    if ((line->state == IN_BREAK) || (line->state == ENDING) || !may_send(line)) return FATHOM_PENDING;
    return fathom_line_send(line);
}

static void give_up(fathom_line_t *line)
{
    if (is_busy(line)) {
        quarantine(line);
        line->silent_us = 0;
    }
    while (line->head != NULL) fathom_line_finish(line, &line->head, FATHOM_ERR_PORT);
}

static const fathom_line_kind_t requesting = {fathom_line_scan_responses, go_on, next, due_us, give_up};

/* ---- the queue ---- */

fathom_status_t fathom_line_init(fathom_line_t *line, const fathom_line_config_t *config)
{
    if ((config->echo == FATHOM_LINE_ECHO_AUTO) && (config->find_echo == NULL)) return FATHOM_ERR_ARGUMENT;
    return fathom_line_begin(line, config, &requesting);
}

fathom_status_t fathom_line_submit(fathom_line_t *line, fathom_transaction_t *transaction)
{
    fathom_transaction_t **const link = fathom_line_find(line, transaction);
    if (*link != NULL) return FATHOM_ERR_BUSY;
    if (transaction->timeout_us > (UINT32_MAX / 2u)) return FATHOM_ERR_ARGUMENT;
    if (line->kind->give_up == NULL) return FATHOM_ERR_UNSUPPORTED;
    *link = transaction;
    transaction->link.next = NULL;
    transaction->attempts = 0;
    transaction->status = FATHOM_PENDING;
    return FATHOM_PENDING;
}

void fathom_line_cancel(fathom_line_t *line, fathom_transaction_t *transaction)
{
    fathom_transaction_t **const link = fathom_line_find(line, transaction);
    if (*link == NULL) return;
    if ((link == &line->head) && is_busy(line)) {
        quarantine(line);
        if ((line->state & ECHOED) == 0) line->known |= ECHO_DUE;
        if (phase(line) == SENDING) {
            line->state = LEAVING;
            line->sent = 0;
        }
    }
    fathom_line_finish(line, link, FATHOM_ERR_CANCELLED);
}

void fathom_line_cancel_unit(fathom_line_t *line, uint8_t address)
{
    fathom_transaction_t *x = line->head;
    while (x != NULL) {
        fathom_transaction_t *const after = x->link.next;
        if (x->address == address) fathom_line_cancel(line, x);
        x = after;
    }
}

bool fathom_line_has(const fathom_line_t *line, const fathom_transaction_t *transaction)
{
    const fathom_transaction_t *x = line->head;
    while ((x != NULL) && (x != transaction)) x = x->link.next;
    return x != NULL;
}

uint8_t fathom_line_echo(const fathom_line_t *line) { return line->known & ECHO; }
