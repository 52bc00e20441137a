/* SPDX-License-Identifier: MIT */
#include "fathom/line.h"

/*
 * The state of the exchange at the head of the queue: how far it is, and what has gone wrong with its answer.
 */
enum {
    IDLE = 0,            /* nothing is on the wire */
    REFUSED = 1,         /* the port was too busy to take the request */
    SENDING = 2,         /* the port has taken it */
    LISTENING = 3,       /* it has left; the answer may come */
    PHASE = 3,           /* these two bits */
    DAMAGED = 4,         /* an answer came and was wrong from end to end */
    TORN = 8,            /* an answer seemed to begin and broke off */
    SPOILT = 12,         /* either: nothing more is to be expected than the rest of it */
    ANSWERED_WRONG = 16, /* the unit sent something else; the answer may still come */
};

enum { MAX_READS = 16, LEAST_FRAME = 8, SEND_POLL_US = 1000, LEAST_TORN = 3 };

static uint8_t phase(const fathom_line_t *line) { return line->state & PHASE; }

static uint16_t owing_bit(uint8_t unit) { return (uint16_t)(1u << (unit & 15)); }

static uint16_t silence_us(const fathom_line_t *line)
{
    const uint16_t us = line->config->silence_us;
    return us != 0 ? us : FATHOM_LINE_DEFAULT_SILENCE_US;
}

static uint16_t gap_us(const fathom_line_t *line)
{
    const uint16_t us = line->config->gap_us;
    return us != 0 ? us : FATHOM_LINE_DEFAULT_GAP_US;
}

static void count(fathom_line_t *line, uint8_t which, uint8_t by)
{
    uint16_t *const counter = &line->counters[which];
    const uint16_t sum = (uint16_t)(*counter + by);
    *counter = sum < by ? UINT16_MAX : sum;
}

static void set_silent(fathom_line_t *line, uint32_t us)
{
    line->silent_us = us > UINT16_MAX ? UINT16_MAX : (uint16_t)us;
}

/* Where the exchange is linked, or the end of the queue. */
static fathom_exchange_t **find(fathom_line_t *line, const fathom_exchange_t *exchange)
{
    fathom_exchange_t **link = &line->head;
    while (*link != NULL && *link != exchange) link = &(*link)->link.next;
    return link;
}

/* *link leaves the queue; if it was on the wire, the wire is free. */
static void finish(fathom_line_t *line, fathom_exchange_t **link, int8_t status)
{
    fathom_exchange_t *const exchange = *link;
    if (link == &line->head) line->state = IDLE;
    *link = exchange->link.next;
    exchange->link.heard_us = fathom_line_heard_us(line);
    exchange->status = status;
}

/*
 * The exchange on the wire may still be answered: its unit is asked nothing until twice the time-out has
 * passed since the request left. What broke off may have been noise, and the answer late; what was damaged
 * from end to end hardly was, so that after it the rest of the time-out is enough.
 */
static void owe(fathom_line_t *line)
{
    const fathom_exchange_t *const exchange = line->head;
    if (exchange->receive == NULL) return;
    uint32_t longest_us = phase(line) == SENDING ? exchange->timeout_us : line->left_us;
    if ((line->state & DAMAGED) == 0) longest_us += exchange->timeout_us;
    if (line->owed_us < longest_us) line->owed_us = longest_us;
    line->owing |= owing_bit(exchange->unit);
}

/* The attempt on the wire has failed. */
static void fail(fathom_line_t *line)
{
    uint8_t error = -FATHOM_ERR_NO_ANSWER;
    if ((line->state & SPOILT) != 0)
        error = -FATHOM_ERR_CHECKSUM;
    else if ((line->state & ANSWERED_WRONG) != 0)
        error = -FATHOM_ERR_MALFORMED;
    count(line, error, 1);
    owe(line);
    line->state = IDLE;
    if (line->head->attempts > line->head->retries) finish(line, &line->head, (int8_t)-error);
}

static fathom_status_t broken(fathom_line_t *line)
{
    if (line->state > REFUSED) owe(line);
    count(line, FATHOM_LINE_PORT_ERRORS, 1);
    line->have = 0;
    while (line->head != NULL) finish(line, &line->head, FATHOM_ERR_PORT);
    return FATHOM_ERR_PORT;
}

/* The exchange that the bytes which come now may answer. */
static fathom_exchange_t *asked(const fathom_line_t *line)
{
    return line->state > REFUSED && line->head->receive != NULL ? line->head : NULL;
}

/*
 * The first `length` bytes leave the frame; those that nobody took go to the listener. After its time-out an
 * answer that has begun may end, but what begins then is another's, or noise without end: the attempt is over.
 */
static void drop(fathom_line_t *line, uint8_t length, bool taken)
{
    uint8_t *to = line->config->frame;
    fathom_listener_t *const listener = line->listener;
    if (!taken) {
        if (listener == NULL)
            count(line, FATHOM_LINE_DROPPED_BYTES, length);
        else
            listener->receive(listener, to, length, line->after_gap, fathom_line_heard_us(line));
        if (line->left_us == 0 && asked(line) != NULL) fail(line);
    }
    line->after_gap = false;
    line->need = 0;
    line->have = (uint8_t)(line->have - length);
    for (uint8_t i = line->have; i != 0; i--, to++) *to = to[length];
}

/* Does a frame of this status answer *link? Then that exchange has ended. */
static bool end_with(fathom_line_t *line, fathom_exchange_t **link, int8_t status)
{
    uint8_t which = FATHOM_LINE_ANSWERS;
    if (status != FATHOM_READY) {
        if (status != FATHOM_ERR_EXCEPTION) return false;
        which = FATHOM_LINE_EXCEPTIONS;
    }
    count(line, which, 1);
    finish(line, link, status);
    return true;
}

/* A whole frame from `unit` that is not for the exchange on the wire: was it owed, and does it answer one that
 * waits for a retry? */
static bool deliver_late(fathom_line_t *line, uint8_t unit)
{
    const uint16_t owing = line->owing & (uint16_t)~owing_bit(unit);
    const bool is_late = owing != line->owing;
    count(line, is_late ? FATHOM_LINE_LATE_ANSWERS : FATHOM_LINE_STRAYS, 1);
    line->owing = owing;
    if (!is_late) return false;
    for (fathom_exchange_t **link = &line->head, *x; (x = *link) != NULL; link = &x->link.next) {
        fathom_match_t match;
        if (x->attempts == 0 || x->unit != unit || x->receive == NULL) continue;
        x->receive(x, line->config->frame, line->have, &match);
        if (end_with(line, link, match.status)) return true;
    }
    return false;
}

/*
 * What to do with the front of what was received: how many bytes leave, and whether somebody took them.
 * `is_whole`: all of what match describes is there.
 */
static uint8_t judge(fathom_line_t *line, const fathom_match_t *match, bool is_whole, bool *taken)
{
    const fathom_exchange_t *const exchange = asked(line);
    const bool is_asked = exchange != NULL && match->length != 0 && match->unit == exchange->unit;
    if (!is_whole || match->length == 0 || match->status == FATHOM_ERR_CHECKSUM) {
        /* While the request leaves, noise is likelier than an answer. */
        if (is_asked && is_whole && phase(line) == LISTENING)
            line->state |= DAMAGED;
        else if (is_asked && (is_whole || line->have >= LEAST_TORN))
            line->state |= TORN;
        return 1;
    }
    *taken = is_asked ? end_with(line, &line->head, match->status) : deliver_late(line, match->unit);
    if (is_asked && !*taken) line->state |= ANSWERED_WRONG;
    return match->length;
}

/*
 * Takes frames from the front of what was received, and drops what cannot begin one; `over`: nothing more will
 * come to complete a frame.
 */
static void scan(fathom_line_t *line, bool over)
{
    while (line->have != 0 && (over || line->have >= line->need)) {
        fathom_exchange_t *const exchange = asked(line);
        uint8_t length = line->have;
        bool taken = false;
        if (exchange != NULL || line->owing != 0) {
            fathom_match_t match;
            line->receive(exchange, line->config->frame, length, &match);
            const bool is_whole = match.length <= length;
            if (!is_whole && !over && match.length <= line->config->frame_size) {
                line->need = match.length;
                return;
            }
            length = judge(line, &match, is_whole, &taken);
        }
        drop(line, length, taken);
    }
}

/*
 * Reads what has come and looks at it; false: the port is broken. A silence is known only where a read found
 * nothing: what a read brings may have come at any time since the one before.
 */
static bool receive(fathom_line_t *line, uint32_t passed_us)
{
    const fathom_line_config_t *const config = line->config;
    const fathom_uart_t *const uart = config->uart;
    for (uint8_t reads = MAX_READS; reads != 0; reads--) {
        fathom_rx_t rx = {0, 0};
        const int n =
            uart->read(uart->ctx, config->frame + line->have, (size_t)(config->frame_size - line->have), &rx);
        if (n < 0) return false;
        if (n == 0) {
            set_silent(line, line->silent_us + passed_us);
            break;
        }
        const bool is_silent = (rx.flags & FATHOM_RX_SILENCE) != 0 ||
                               (line->listener != NULL && line->silent_us >= line->listener->gap_us);
        passed_us = 0;
        set_silent(line,
                   (rx.flags & FATHOM_RX_TIMED) != 0 ? fathom_elapsed_us(line->polled_us, rx.last_us) : 0);
        if ((rx.flags & (FATHOM_RX_PARITY | FATHOM_RX_FRAMING)) != 0) {
            count(line, FATHOM_LINE_BAD_BYTES, (uint8_t)n);
            continue;
        }
        if (line->have == 0) line->after_gap = is_silent;
        line->have = (uint8_t)(line->have + n);
        scan(line, false);
    }
    scan(line, line->silent_us >= gap_us(line));
    return true;
}

static bool is_spoilt(const fathom_line_t *line) { return (line->state & SPOILT) != 0; }

/* Time has passed for the exchange on the wire. */
static fathom_status_t pass(fathom_line_t *line)
{
    const fathom_uart_t *const uart = line->config->uart;
    fathom_exchange_t *const exchange = line->head;
    const bool over = line->left_us == 0;
    if (phase(line) == SENDING) {
        line->silent_us = 0;
        if (uart->sent(uart->ctx)) {
            line->state |= LISTENING;
            line->left_us = exchange->timeout_us;
        } else if (over) {
            return broken(line);
        }
    } else if (line->have == 0 && (over || (is_spoilt(line) && line->silent_us >= gap_us(line)))) {
        if (exchange->receive == NULL)
            finish(line, &line->head, FATHOM_READY);
        else
            fail(line);
    }
    return FATHOM_PENDING;
}

/*
 * After a silence the first in the queue whose unit owes nothing goes to the front and out. A port that takes
 * nothing is asked again by the next poll, for so long and no longer.
 */
static fathom_status_t send(fathom_line_t *line)
{
    const fathom_line_config_t *const config = line->config;
    if (line->have != 0 || line->silent_us < silence_us(line)) return FATHOM_PENDING;
    for (fathom_exchange_t **link = &line->head, *x; (x = *link) != NULL; link = &x->link.next) {
        if ((line->owing & owing_bit(x->unit)) != 0) continue;
        *link = x->link.next;
        x->link.next = line->head;
        line->head = x;
        const uint8_t length = x->encode(x, config->frame);
        const int n = config->uart->write(config->uart->ctx, config->frame, length);
        if (n == (int)length) {
            x->attempts++;
            if (x->receive != NULL) line->receive = x->receive;
            line->state = SENDING;
        } else if (n == 0 && line->state == IDLE) {
            line->state = REFUSED;
        } else if (n != 0 || line->left_us == 0) {
            return broken(line);
        } else {
            break;
        }
        line->left_us = FATHOM_LINE_SEND_US;
        break;
    }
    return FATHOM_PENDING;
}

fathom_status_t fathom_line_init(fathom_line_t *line, const fathom_line_config_t *config)
{
    if (config->uart == NULL || config->clock == NULL || config->frame == NULL ||
        config->frame_size < LEAST_FRAME)
        return FATHOM_ERR_ARGUMENT;
    line->state = IDLE;
    line->have = 0;
    line->need = 0;
    line->after_gap = false;
    line->owing = 0;
    line->silent_us = 0;
    line->config = config;
    line->head = NULL;
    line->listener = NULL;
    line->receive = NULL;
    line->polled_us = config->clock->now_us(config->clock->ctx);
    line->left_us = 0;
    line->owed_us = 0;
    /* volatile: or compilers make it a call of memset, which costs more than all of this. */
    for (volatile uint16_t *c = line->counters; c != line->counters + FATHOM_LINE_COUNTERS; c++) *c = 0;
    return FATHOM_READY;
}

fathom_status_t fathom_line_submit(fathom_line_t *line, fathom_exchange_t *exchange)
{
    fathom_exchange_t **const link = find(line, exchange);
    if (*link != NULL) return FATHOM_ERR_BUSY;
    *link = exchange;
    exchange->link.next = NULL;
    exchange->attempts = 0;
    exchange->status = FATHOM_PENDING;
    return FATHOM_PENDING;
}

void fathom_line_cancel(fathom_line_t *line, fathom_exchange_t *exchange)
{
    fathom_exchange_t **const link = find(line, exchange);
    if (*link == NULL) return;
    if (link == &line->head && line->state > REFUSED) owe(line);
    finish(line, link, FATHOM_ERR_CANCELLED);
}

void fathom_line_listen(fathom_line_t *line, fathom_listener_t *listener) { line->listener = listener; }

fathom_status_t fathom_line_poll(fathom_line_t *line)
{
    const fathom_clock_t *const clock = line->config->clock;
    const uint32_t now_us = clock->now_us(clock->ctx);
    const uint32_t passed_us = fathom_elapsed_us(now_us, line->polled_us);
    fathom_status_t status = FATHOM_PENDING;
    line->polled_us = now_us;
    if (fathom_run_down(&line->owed_us, passed_us)) line->owing = 0;
    fathom_run_down(&line->left_us, passed_us);
    if (!receive(line, passed_us)) return broken(line);
    if (line->state > REFUSED) status = pass(line);
    if (line->state <= REFUSED && status == FATHOM_PENDING) status = send(line);
    return status;
}

uint32_t fathom_line_heard_us(const fathom_line_t *line) { return line->polled_us - line->silent_us; }

/* What is left of `us` after the silence so far; 0 when it has passed. */
static uint32_t still_to_be_silent(const fathom_line_t *line, uint16_t us)
{
    return us > line->silent_us ? (uint32_t)(us - line->silent_us) : 0;
}

static uint32_t least(uint32_t a, uint32_t b) { return a < b ? a : b; }

/* When the queue can go on, with nothing on the wire. */
static uint32_t queue_due_us(const fathom_line_t *line)
{
    for (const fathom_exchange_t *x = line->head; x != NULL; x = x->link.next)
        if ((line->owing & owing_bit(x->unit)) == 0) return still_to_be_silent(line, silence_us(line));
    return line->head != NULL ? line->owed_us : FATHOM_NO_DEADLINE;
}

uint32_t fathom_line_due_us(const fathom_line_t *line)
{
    const fathom_clock_t *const clock = line->config->clock;
    const uint32_t passed_us = fathom_elapsed_us(clock->now_us(clock->ctx), line->polled_us);
    uint32_t due_us = line->left_us;
    if (line->state == IDLE)
        due_us = queue_due_us(line);
    else if (phase(line) != LISTENING)
        due_us = SEND_POLL_US;
    if (line->have != 0 || is_spoilt(line)) due_us = least(due_us, still_to_be_silent(line, gap_us(line)));
    if (line->listener != NULL && line->silent_us < line->listener->gap_us)
        due_us = least(due_us, still_to_be_silent(line, line->listener->gap_us));
    if (due_us == FATHOM_NO_DEADLINE) return due_us;
    return due_us > passed_us ? due_us - passed_us : 0;
}
