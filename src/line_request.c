/* SPDX-License-Identifier: MIT */
#include "fathom/line.h"

#include "line_inside.h"

/* The queue, when an exchange of it may leave, and which of them an answer ends. */

fathom_exchange_t **fathom_line_find(fathom_line_t *line, const fathom_exchange_t *exchange)
{
    fathom_exchange_t **link = &line->head;
    while (*link != NULL && *link != exchange) link = &(*link)->link.next;
    return link;
}

void fathom_line_finish(fathom_line_t *line, fathom_exchange_t **link, fathom_status_t status)
{
    fathom_exchange_t *const exchange = *link;
    if (link == &line->head && line->state >= REFUSED) {
        line->state = IDLE;
        line->sent = 0;
    }
    *link = exchange->link.next;
    exchange->link.heard_us = fathom_line_heard_us(line);
    exchange->status = (int8_t)status;
}

/*
 * The exchange on the wire may still be answered: its unit is asked nothing until twice the time-out has passed since
 * the request left. What broke off may have been noise, and the answer late; what was damaged from end to end hardly
 * was, so that after it the rest of the time-out is enough.
 */
static void owe(fathom_line_t *line)
{
    const fathom_exchange_t *const exchange = line->head;
    if (!is_asking(line)) return;
    uint32_t longest_us = phase(line) == SENDING ? exchange->timeout_us : line->left_us;
    if ((line->state & DAMAGED) == 0) longest_us += exchange->timeout_us;
    if (line->owing == 0 || line->owed_us < longest_us) line->owed_us = longest_us;
    line->owing |= owing_bits(exchange->unit);
}

void fathom_line_end_attempt(fathom_line_t *line)
{
    fathom_status_t error = FATHOM_ERR_NO_ANSWER;
    if (!is_asking(line)) {
        fathom_line_finish(line, &line->head, FATHOM_READY);
        return;
    }
    if ((line->state & SPOILT) != 0)
        error = FATHOM_ERR_CHECKSUM;
    else if ((line->state & ANSWERED_WRONG) != 0)
        error = FATHOM_ERR_MALFORMED;
    count(line, (uint8_t)-error, 1);
    owe(line);
    if ((line->state & (ECHOED | SPOILT | ANSWERED_WRONG)) == ECHOED && (line->known & ECHO) == 0)
        error = FATHOM_ERR_ECHO;
    line->state = IDLE;
    line->sent = 0;
    if (line->head->attempts > line->head->retries) fathom_line_finish(line, &line->head, error);
}

/* ---- what comes in ---- */

/* Does a frame of `unit` concern the exchange? */
static bool is_of(const fathom_exchange_t *exchange, uint8_t unit)
{
    return exchange->unit == unit || exchange->unit == FATHOM_LINE_ANY_UNIT;
}

bool fathom_line_is_asked(const fathom_line_t *line, uint8_t unit)
{
    return is_asking(line) && is_of(line->head, unit);
}

bool fathom_line_deliver(fathom_line_t *line)
{
    const fathom_protocol_t *const protocol = line->protocol;
    const uint8_t *const frame = line->config->frame;
    const uint8_t unit = frame[protocol->unit_at];
    uint8_t before = NOISY;
    if (fathom_line_is_asked(line, unit)) {
        if (line->head->unit == FATHOM_LINE_ANY_UNIT) owe(line);
        before = line->state & (uint8_t) ~(PHASE | ANSWERED_WRONG);
        line->state |= ANSWERED_WRONG;
    } else {
        const uint16_t owing = line->owing & (uint16_t)~owing_bits(unit);
        const bool is_owed = owing != line->owing && (line->known & ECHO_DUE) == 0;
        line->known &= (uint8_t)~ECHO_DUE;
        count(line, is_owed ? FATHOM_LINE_LATE_ANSWERS : FATHOM_LINE_STRAYS, 1);
        if (!is_owed) return false;
        line->owing = owing;
    }
    for (fathom_exchange_t **link = &line->head, *x; (x = *link) != NULL; link = &x->link.next) {
        if (x->attempts == 0 || !is_of(x, unit) || x->protocol->answer != protocol->answer) continue;
        const fathom_status_t status = protocol->answer(x, frame);
        if (status != FATHOM_READY && status != FATHOM_ERR_EXCEPTION) continue;
        count(line, status > 0 ? FATHOM_LINE_ANSWERS : FATHOM_LINE_EXCEPTIONS, 1);
        fathom_line_finish(line, link, status);
        if (before == 0) fathom_line_learn(line, FATHOM_LINE_ECHO_OFF);
        return true;
    }
    return false;
}

/* ---- when one may leave ---- */

/* The first in the queue whose unit owes nothing. */
static fathom_exchange_t *next(const fathom_line_t *line)
{
    fathom_exchange_t *x = line->head;
    while (x != NULL && (line->owing & owing_bits(x->unit)) != 0) x = x->link.next;
    return x;
}

static uint32_t due_us(const fathom_line_t *line)
{
    if (next(line) == NULL) return line->owed_us;
    return rest_us(is_late(line) ? QUIET_US : silence_us(line), line->silent_us);
}

/* Has the line been silent for long enough? A device that sends by itself leaves room for a request behind each of its
 * frames and nowhere else: not behind an answer, which one of its frames may have waited for, nor later in a silence. */
static bool has_room(fathom_line_t *line)
{
    if (line->silent_us < silence_us(line)) return false;
    if (line->silent_us == QUIET_US) line->known &= (uint8_t) ~(UNASKED | COMPANY);
    if (is_late(line)) return false;
    line->known |= LATE;
    return true;
}

static fathom_status_t go_on(fathom_line_t *line)
{
    if (phase(line) == SENDING) {
        const fathom_uart_t *const uart = line->config->uart;
        line->silent_us = 0;
        if (uart->sent(uart->ctx)) {
            line->state |= LISTENING;
            line->left_us = line->head->timeout_us;
        } else if (line->left_us == 0) {
            return fathom_line_broken(line);
        }
        return FATHOM_PENDING;
    }
    if (line->have != 0) return FATHOM_PENDING;
    if (is_busy(line)) {
        if (line->left_us != 0 && ((line->state & SPOILT) == 0 || line->silent_us < gap_us(line)))
            return FATHOM_PENDING;
        fathom_line_end_attempt(line);
    }
    if (line->state == IN_BREAK || line->state == ENDING || !has_room(line)) return FATHOM_PENDING;
    return fathom_line_send(line);
}

static void give_up(fathom_line_t *line)
{
    if (is_busy(line)) owe(line);
    while (line->head != NULL) fathom_line_finish(line, &line->head, FATHOM_ERR_PORT);
}

static const fathom_line_kind_t asking = {fathom_line_scan_asking, go_on, next, due_us, give_up};

/* ---- the queue ---- */

fathom_status_t fathom_line_init(fathom_line_t *line, const fathom_line_config_t *config)
{
    if (config->echo == FATHOM_LINE_ECHO_AUTO && config->find_echo == NULL) return FATHOM_ERR_ARGUMENT;
    return fathom_line_begin(line, config, &asking);
}

fathom_status_t fathom_line_submit(fathom_line_t *line, fathom_exchange_t *exchange)
{
    fathom_exchange_t **const link = fathom_line_find(line, exchange);
    if (*link != NULL) return FATHOM_ERR_BUSY;
    if (exchange->timeout_us > INT32_MAX) return FATHOM_ERR_ARGUMENT;
    if (line->kind->give_up == NULL) return FATHOM_ERR_UNSUPPORTED;
    *link = exchange;
    exchange->link.next = NULL;
    exchange->attempts = 0;
    exchange->status = FATHOM_PENDING;
    return FATHOM_PENDING;
}

void fathom_line_cancel(fathom_line_t *line, fathom_exchange_t *exchange)
{
    fathom_exchange_t **const link = fathom_line_find(line, exchange);
    if (*link == NULL) return;
    if (link == &line->head && is_busy(line)) {
        owe(line);
        if ((line->state & ECHOED) == 0) line->known |= ECHO_DUE;
    }
    fathom_line_finish(line, link, FATHOM_ERR_CANCELLED);
}

void fathom_line_cancel_unit(fathom_line_t *line, uint8_t unit)
{
    for (fathom_exchange_t *x = line->head, *next; x != NULL; x = next) {
        next = x->link.next;
        if (x->unit == unit) fathom_line_cancel(line, x);
    }
}

bool fathom_line_has(const fathom_line_t *line, const fathom_exchange_t *exchange)
{
    const fathom_exchange_t *x = line->head;
    while (x != NULL && x != exchange) x = x->link.next;
    return x != NULL;
}

uint8_t fathom_line_echo(const fathom_line_t *line) { return line->known & ECHO; }
