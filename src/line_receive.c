/* SPDX-License-Identifier: MIT */
#include "fathom/line.h"

#include "line_inside.h"

enum { LEAST_TORN = 3 };

/* The exchange that the bytes which come now may answer. */
static fathom_exchange_t *asked(const fathom_line_t *line)
{
    return line->state > REFUSED && is_answered(line->head) ? line->head : NULL;
}

static void add_company(fathom_line_t *line, uint8_t length)
{
    if (length >= LEAST_COMPANY - line->unasked)
        line->known |= COMPANY;
    else
        line->unasked = (uint8_t)(line->unasked + length);
}

/*
 * The first `length` bytes leave the frame; those that nobody took go to the listener. After its time-out an
 * answer that has begun may end, but what begins then is another's, or noise without end: the attempt is over.
 */
static void drop(fathom_line_t *line, uint8_t length, bool taken)
{
    uint8_t *to = line->config->frame;
    fathom_listener_t *const listener = line->listener;
    if (taken) {
        line->unasked = 0;
        line->known |= LATE;
    } else {
        if (asked(line) == NULL) add_company(line, length); /* else it may be what is left of its answer */
        if (listener == NULL)
            fathom_line_count(line, FATHOM_LINE_DROPPED_BYTES, length);
        else
            listener->receive(listener, to, length, (line->known & AFTER_GAP) != 0,
                              fathom_line_heard_us(line));
        if (asked(line) != NULL) {
            if (length == 1) line->state |= NOISY; /* a whole frame, which is longer, hides no echo */
            if (line->left_us == 0 && phase(line) == LISTENING) fathom_line_fail(line);
        }
    }
    line->known &= (uint8_t)~AFTER_GAP;
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
    fathom_line_count(line, which, 1);
    fathom_line_finish(line, link, status);
    return true;
}

/* A whole frame from `unit` that is not for the exchange on the wire: was it owed, and does it answer one that
 * waits for a retry? */
static bool deliver_late(fathom_line_t *line, uint8_t unit)
{
    const uint16_t owing = line->owing & (uint16_t)~fathom_line_owing_bits(unit);
    const bool is_late = owing != line->owing && (line->known & ECHO_DUE) == 0;
    line->known &= (uint8_t)~ECHO_DUE;
    fathom_line_count(line, is_late ? FATHOM_LINE_LATE_ANSWERS : FATHOM_LINE_STRAYS, 1);
    if (!is_late) return false;
    line->owing = owing;
    for (fathom_exchange_t **link = &line->head, *x; (x = *link) != NULL; link = &x->link.next) {
        fathom_match_t match;
        if (x->attempts == 0 || (x->unit != unit && x->unit != FATHOM_LINE_ANY_UNIT)) continue;
        x->protocol(x, line->config->frame, line->have, &match);
        if (end_with(line, link, match.status)) return true;
    }
    return false;
}

static void learn(fathom_line_t *line, uint8_t echo)
{
    line->known = (uint8_t)((line->known & ~ECHO_KNOWN) | echo << ECHO_SHIFT);
}

/*
 * The request came back as a frame that answers it. That is the answer if there is no echo, or if the echo has
 * come before; else it counts as the echo, and the answer is still to come.
 */
static bool is_echo(const fathom_line_t *line)
{
    return (line->state & ECHOED) == 0 && fathom_line_echo(line) != FATHOM_LINE_ECHO_OFF;
}

/* A whole frame of the unit that was asked: is it taken? An answer that is not preceded by anything but whole frames
 * shows that there is no echo. */
static bool take(fathom_line_t *line, const fathom_match_t *match)
{
    const bool is_request = match->request == match->length;
    const bool is_first = !is_request && (line->state & (uint8_t) ~(PHASE | ANSWERED_WRONG)) == 0;
    if (is_request && is_echo(line)) {
        line->state |= ECHOED;
        return true;
    }
    if (line->head->unit == FATHOM_LINE_ANY_UNIT) fathom_line_owe(line);
    if (!end_with(line, &line->head, match->status)) {
        line->state |= ANSWERED_WRONG;
        return false;
    }
    if (is_first) learn(line, FATHOM_LINE_ECHO_OFF);
    return true;
}

/*
 * What to do with the front of what was received: how many bytes leave, and whether somebody took them.
 * `is_whole`: all of what match describes is there.
 */
static uint8_t judge(fathom_line_t *line, const fathom_match_t *match, bool is_whole, bool *taken)
{
    const fathom_exchange_t *const exchange = asked(line);
    const bool is_frame = is_whole && match->length != 0 && match->status != FATHOM_ERR_CHECKSUM;
    const bool is_asked = exchange != NULL && match->unit == exchange->unit;
    if (is_frame) {
        *taken = is_asked ? take(line, match) : deliver_late(line, match->unit);
        return match->length;
    }
    if (is_asked && match->request != 0) {
        learn(line, FATHOM_LINE_ECHO_ON);
        line->state |= ECHOED;
        *taken = true;
        return match->request;
    }
    /* While the request leaves, noise is likelier than an answer. */
    if (is_asked && match->length != 0) {
        if (is_whole && phase(line) == LISTENING)
            line->state |= DAMAGED;
        else if (is_whole || line->have >= LEAST_TORN)
            line->state |= TORN;
    }
    return 1;
}

void fathom_line_scan(fathom_line_t *line, bool over)
{
    while (line->have != 0 && (over || line->have >= line->need)) {
        fathom_exchange_t *const exchange = asked(line);
        uint8_t length = line->have;
        bool taken = false;
        if (exchange != NULL || line->owing != 0) {
            fathom_match_t match;
            line->protocol(exchange, line->config->frame, length, &match);
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

void fathom_line_look(fathom_line_t *line) { (void)look(line); }

int fathom_line_read(fathom_line_t *line)
{
    const fathom_line_config_t *const config = line->config;
    const fathom_uart_t *const uart = config->uart;
    fathom_rx_t rx = {0, 0};
    int n = uart->read(uart->ctx, config->frame + line->have, (size_t)(config->frame_size - line->have), &rx);
    if (n <= 0) return n;
    line->known &= (uint8_t)~LATE;
    if (line->have == 0 && ((rx.flags & FATHOM_RX_SILENCE) != 0 || is_listeners_gap(line)))
        line->known |= AFTER_GAP;
    /* What came may be newer than the look at the clock before the read, stamped or not. */
    fathom_line_look(line);
    uint32_t silent_us =
        (rx.flags & FATHOM_RX_TIMED) != 0 ? fathom_elapsed_us(line->polled_us, rx.last_us) : 0;
    if (silent_us > INT32_MAX) silent_us = 0; /* a stamp that is ahead of the clock still */
    set_silent(line, silent_us);
    if ((rx.flags & FATHOM_RX_OVERRUN) != 0) n |= LOST;
    if ((rx.flags & (FATHOM_RX_PARITY | FATHOM_RX_FRAMING)) != 0) n |= BAD;
    return n;
}

uint8_t fathom_line_lose(fathom_line_t *line, uint8_t had, int came)
{
    uint8_t *to = line->config->frame;
    const uint8_t *from = to + had;
    fathom_listener_t *const listener = line->listener;
    const uint8_t count = (uint8_t)came;
    if (asked(line) != NULL) line->state |= NOISY;
    if (listener != NULL) listener->receive(listener, to, 0, false, fathom_line_heard_us(line));
    line->known &= (uint8_t)~AFTER_GAP;
    if ((came & BAD) != 0) {
        fathom_line_count(line, FATHOM_LINE_BAD_BYTES, count);
        return 0;
    }
    fathom_line_count(line, FATHOM_LINE_BAD_BYTES, 1);
    for (uint8_t left = count; left != 0; left--) *to++ = *from++;
    return count;
}
