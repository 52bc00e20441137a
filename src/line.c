/* SPDX-License-Identifier: MIT */
#include "fathom/line.h"

#include "line_inside.h"

enum { MAX_READS = 16, LEAST_FRAME = 8, SEND_POLL_US = 1000 };

static uint16_t silence_us(const fathom_line_t *line)
{
    const uint16_t us = line->config->silence_us;
    return us != 0 ? us : FATHOM_LINE_DEFAULT_SILENCE_US;
}

/* Where the exchange is linked, or the end of the queue. */
static fathom_exchange_t **find(fathom_line_t *line, const fathom_exchange_t *exchange)
{
    fathom_exchange_t **link = &line->head;
    while (*link != NULL && *link != exchange) link = &(*link)->link.next;
    return link;
}

uint16_t fathom_line_owing_bits(uint8_t unit)
{
    return (uint16_t)(unit == FATHOM_LINE_ANY_UNIT ? UINT16_MAX : 1u << (unit & 15));
}

void fathom_line_count(fathom_line_t *line, uint8_t which, uint8_t by)
{
    uint16_t *const counter = &line->counters[which];
    const uint16_t sum = (uint16_t)(*counter + by);
    *counter = sum < by ? UINT16_MAX : sum;
}

void fathom_line_finish(fathom_line_t *line, fathom_exchange_t **link, int8_t status)
{
    fathom_exchange_t *const exchange = *link;
    if (link == &line->head) line->state = IDLE;
    *link = exchange->link.next;
    exchange->link.heard_us = fathom_line_heard_us(line);
    exchange->status = status;
}

void fathom_line_owe(fathom_line_t *line)
{
    const fathom_exchange_t *const exchange = line->head;
    if (!is_answered(exchange)) return;
    uint32_t longest_us = phase(line) == SENDING ? exchange->timeout_us : line->left_us;
    if ((line->state & DAMAGED) == 0) longest_us += exchange->timeout_us;
    if (line->owing == 0 || line->owed_us < longest_us) line->owed_us = longest_us;
    line->owing |= fathom_line_owing_bits(exchange->unit);
}

void fathom_line_fail(fathom_line_t *line)
{
    uint8_t error = -FATHOM_ERR_NO_ANSWER;
    if ((line->state & SPOILT) != 0)
        error = -FATHOM_ERR_CHECKSUM;
    else if ((line->state & ANSWERED_WRONG) != 0)
        error = -FATHOM_ERR_MALFORMED;
    fathom_line_count(line, error, 1);
    fathom_line_owe(line);
    if ((line->state & (ECHOED | SPOILT | ANSWERED_WRONG)) == ECHOED &&
        fathom_line_echo(line) == FATHOM_LINE_ECHO_AUTO)
        error = -FATHOM_ERR_ECHO;
    line->state = IDLE;
    if (line->head->attempts > line->head->retries) fathom_line_finish(line, &line->head, (int8_t)-error);
}

static fathom_status_t broken(fathom_line_t *line)
{
    if (line->state > REFUSED) fathom_line_owe(line);
    fathom_line_count(line, FATHOM_LINE_PORT_ERRORS, 1);
    line->have = 0;
    line->need = 0;
    line->known &= IN_BREAK; /* perhaps it comes back as another one; but not lower than it was */
    while (line->head != NULL) fathom_line_finish(line, &line->head, FATHOM_ERR_PORT);
    return FATHOM_ERR_PORT;
}

/* Reads what has come and looks at it; false: the port is broken. */
static bool receive(fathom_line_t *line, uint32_t passed_us)
{
    uint8_t reads = MAX_READS;
    for (; reads != 0; reads--) {
        int came = fathom_line_read(line);
        if (came <= 0) {
            set_silent(line, line->silent_us + passed_us);
            if (came < 0) return false;
            break;
        }
        if (came > COUNT_READ) {
            const uint8_t had = line->have;
            fathom_line_scan(line, true);
            came = fathom_line_lose(line, had, came);
        }
        passed_us = 0;
        line->have = (uint8_t)(line->have + came);
        fathom_line_scan(line, false);
    }
    if (reads == 0) line->silent_us = 0; /* the port may hold more, whatever a stamp says of what it gave */
    /* Asked here, since most polls find nothing: on an AVR that is a quarter of such a poll. */
    if (line->have != 0 && line->silent_us >= gap_us(line)) fathom_line_scan(line, true);
    return true;
}

static bool is_spoilt(const fathom_line_t *line) { return (line->state & SPOILT) != 0; }

/* Time has passed for the exchange on the wire. */
static fathom_status_t pass(fathom_line_t *line)
{
    fathom_exchange_t *const exchange = line->head;
    const bool over = line->left_us == 0;
    if (phase(line) == SENDING) {
        const fathom_uart_t *const uart = line->config->uart;
        line->silent_us = 0;
        if (uart->sent(uart->ctx)) {
            line->state |= LISTENING;
            line->left_us = exchange->timeout_us;
        } else if (over) {
            return broken(line);
        }
    } else if (line->have == 0 && (over || (is_spoilt(line) && line->silent_us >= gap_us(line)))) {
        if (is_answered(exchange))
            fathom_line_fail(line);
        else
            fathom_line_finish(line, &line->head, FATHOM_READY);
    }
    return FATHOM_PENDING;
}

static bool is_late(const fathom_line_t *line)
{
    return (line->known & (COMPANY | LATE)) == (COMPANY | LATE);
}

/* Gives the request to the port, which may have to change its settings for it: > 0 when it has all of it, 0
 * when it is busy, FATHOM_ERR_UNSUPPORTED when it cannot do the settings, else < 0: it is broken. */
static int hand_over(fathom_line_t *line, fathom_exchange_t *exchange)
{
    const fathom_uart_t *const uart = line->config->uart;
    uint8_t *const frame = line->config->frame;
    if (exchange->settings != NULL) {
        const int is_set =
            uart->set_line != NULL ? uart->set_line(uart->ctx, exchange->settings) : FATHOM_ERR_UNSUPPORTED;
        if (is_set <= 0) return is_set < 0 ? FATHOM_ERR_UNSUPPORTED : 0;
    }
    fathom_match_t request;
    exchange->protocol(exchange, frame, 0, &request);
    const int n = uart->write(uart->ctx, frame, request.length);
    return n == 0 || n == (int)request.length ? n : FATHOM_ERR_PORT;
}

/* Has the line been silent for long enough? A device that sends by itself leaves room for a request behind each of its
 * frames and nowhere else: not behind an answer, which one of its frames may have waited for, nor later in a silence. */
static bool has_room(fathom_line_t *line)
{
    if (line->have != 0 || line->silent_us < silence_us(line) || (line->known & IN_BREAK) != 0) return false;
    if (line->silent_us == QUIET_US) line->known &= (uint8_t)~COMPANY;
    if (is_late(line)) return false;
    line->known |= LATE;
    return true;
}

/*
 * The first in the queue whose unit owes nothing goes to the front and out. A port that takes nothing is asked again by
 * the next poll, for so long and no longer.
 */
static fathom_status_t send(fathom_line_t *line)
{
    if (!has_room(line)) return FATHOM_PENDING;
    for (fathom_exchange_t **link = &line->head, *x; (x = *link) != NULL; link = &x->link.next) {
        if ((line->owing & fathom_line_owing_bits(x->unit)) != 0) continue;
        *link = x->link.next;
        x->link.next = line->head;
        line->head = x;
        const int n = hand_over(line, x);
        if (n > 0) {
            x->attempts++;
            line->protocol = x->protocol;
            line->known &= (uint8_t)~ECHO_DUE;
            line->state = SENDING;
        } else if (n == FATHOM_ERR_UNSUPPORTED) {
            fathom_line_finish(line, &line->head, FATHOM_ERR_UNSUPPORTED);
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
    line->known = 0;
    line->unasked = 0;
    line->owing = 0;
    line->silent_us = 0;
    line->config = config;
    line->head = NULL;
    line->listener = NULL;
    line->protocol = NULL;
    line->polled_us = config->clock->now_us(config->clock->ctx);
    line->left_us = 0;
    /* volatile: or compilers make it a call of memset, which costs more than all of this. */
    for (volatile uint16_t *c = line->counters; c != line->counters + FATHOM_LINE_COUNTERS; c++) *c = 0;
    return FATHOM_READY;
}

fathom_status_t fathom_line_submit(fathom_line_t *line, fathom_exchange_t *exchange)
{
    fathom_exchange_t **const link = find(line, exchange);
    if (*link != NULL) return FATHOM_ERR_BUSY;
    if (exchange->timeout_us > INT32_MAX) return FATHOM_ERR_ARGUMENT;
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
    if (link == &line->head && line->state > REFUSED) {
        fathom_line_owe(line);
        if ((line->state & ECHOED) == 0 && fathom_line_echo(line) != FATHOM_LINE_ECHO_OFF)
            line->known |= ECHO_DUE;
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

bool fathom_line_is_idle(const fathom_line_t *line) { return line->state <= REFUSED && line->have == 0; }

void fathom_line_listen(fathom_line_t *line, fathom_listener_t *listener) { line->listener = listener; }

/* A port that does not end a break is given as much time as one that does not take a request. */
static fathom_status_t refused_break(fathom_line_t *line, bool on, int is_set)
{
    if (!on && (line->known & IN_BREAK) != 0) {
        if ((line->known & ENDING) == 0) {
            line->known |= ENDING;
            line->left_us = FATHOM_LINE_SEND_US;
        }
        if (is_set < 0 || line->left_us == 0) return broken(line);
    }
    return is_set < 0 ? FATHOM_ERR_PORT : FATHOM_PENDING;
}

fathom_status_t fathom_line_break(fathom_line_t *line, bool on)
{
    const fathom_uart_t *const uart = line->config->uart;
    if (uart->set_break == NULL) return FATHOM_ERR_UNSUPPORTED;
    if (line->state > REFUSED) return on ? FATHOM_ERR_BUSY : FATHOM_READY; /* what is sent is no break */
    const int is_set = uart->set_break(uart->ctx, on);
    fathom_line_look(line);
    if (is_set <= 0) return refused_break(line, on, is_set);
    line->state = IDLE; /* a port that refused a request is given its time anew */
    if (on) {
        line->known |= IN_BREAK;
    } else {
        /* the silence before a request begins here; that of what comes in has been as long as it has */
        if (line->have == 0 && is_listeners_gap(line)) line->known |= AFTER_GAP;
        line->known &= (uint8_t)~IN_BREAK;
        line->silent_us = 0;
    }
    line->known &= (uint8_t)~ENDING;
    return FATHOM_READY;
}

fathom_status_t fathom_line_poll(fathom_line_t *line)
{
    fathom_status_t status = FATHOM_PENDING;
    if (!receive(line, look(line))) return broken(line);
    if (line->state > REFUSED) status = pass(line);
    if (line->state <= REFUSED && status == FATHOM_PENDING) status = send(line);
    return status;
}

uint8_t fathom_line_echo(const fathom_line_t *line)
{
    const uint8_t told = line->config->echo;
    if (told != FATHOM_LINE_ECHO_AUTO) return told;
    return (uint8_t)((line->known & ECHO_KNOWN) >> ECHO_SHIFT);
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
    if ((line->known & IN_BREAK) != 0) return FATHOM_NO_DEADLINE;
    for (const fathom_exchange_t *x = line->head; x != NULL; x = x->link.next)
        if ((line->owing & fathom_line_owing_bits(x->unit)) == 0)
            return still_to_be_silent(line, is_late(line) ? QUIET_US : silence_us(line));
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
    if (line->have != 0 || is_spoilt(line)) {
        /* With part of a frame there neither a time-out nor the next request comes before the end of it. */
        const bool is_held = line->have != 0 && (line->state == IDLE || phase(line) == LISTENING);
        const uint32_t rest_us = still_to_be_silent(line, gap_us(line));
        due_us = is_held ? rest_us : least(due_us, rest_us);
    }
    if (line->listener != NULL && line->silent_us < line->listener->gap_us)
        due_us = least(due_us, still_to_be_silent(line, line->listener->gap_us));
    if (due_us == FATHOM_NO_DEADLINE) return due_us;
    return due_us > passed_us ? due_us - passed_us : 0;
}
