/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

enum { MAX_READS = 16, LEAST_FRAME = 8, SEND_POLL_US = 1000 };

fathom_status_t fathom_line_begin(fathom_line_t *line, const fathom_line_config_t *config,
                                  const fathom_line_kind_t *kind)
{
    if ((config->uart == NULL) || (config->clock == NULL) || (config->frame == NULL) ||
        (config->frame_size < LEAST_FRAME))
        return FATHOM_ERR_ARGUMENT;
    /* volatile: or compilers make it a call of memset, which costs more than all of this. */
    for (volatile uint8_t *byte = (uint8_t *)line; byte != (uint8_t *)(line + 1); byte++) *byte = 0;
    line->config = config;
    line->kind = kind;
    line->known = config->echo;
    line->polled_us = clock_us(config->clock);
    return FATHOM_READY;
}

void fathom_line_listen(fathom_line_t *line, fathom_listener_t *listener) { line->listener = listener; }

static inline uint32_t look(fathom_line_t *line)
{
    const uint32_t now_us = clock_us(line->config->clock);
    const uint32_t passed_us = fathom_elapsed_us(now_us, line->polled_us);
    line->polled_us = now_us;
    /* It lasts from the end of the request. */
    if ((line->quarantined != 0u) && (line->state != LEAVING) &&
        fathom_count_down(&line->quarantine_left_us, passed_us))
        line->quarantined = 0;
    (void)fathom_count_down(&line->left_us, passed_us);
    return passed_us;
}

uint32_t fathom_line_look(fathom_line_t *line) { return look(line); }

/* Has the line been silent for the listener's gap? */
static bool is_listeners_gap(const fathom_line_t *line)
{
    return (line->listener != NULL) && (line->silent_us >= line->listener->gap_us);
}

void fathom_line_leave(fathom_line_t *line, uint8_t length)
{
    fathom_listener_t *const listener = line->listener;
    if (listener != NULL)
        listener->receive(listener, line->config->frame, length, (line->known & AFTER_GAP) != 0,
                          fathom_line_heard_us(line));
    else
        count(line, FATHOM_LINE_DROPPED_BYTES, length);
}

void fathom_line_drop(fathom_line_t *line, uint8_t length)
{
    uint8_t *to = line->config->frame;
    line->need = 0;
    line->have = (uint8_t)(line->have - length);
    for (uint8_t i = line->have; i != 0u; i--) {
        *to = to[length];
        to++;
    }
}

fathom_status_t fathom_line_broken(fathom_line_t *line)
{
    count(line, FATHOM_LINE_PORT_ERRORS, 1);
    line->have = 0;
    line->need = 0;
    line->known = line->config->echo;                  /* it may come back as another port */
    if (line->state == ENDING) line->state = IN_BREAK; /* the port gets its second again */
    if (line->kind->give_up != NULL) line->kind->give_up(line);
    return FATHOM_ERR_PORT;
}

fathom_status_t fathom_line_poll(fathom_line_t *line)
{
    const fathom_line_config_t *const config = line->config;
    const fathom_uart_t *const uart = config->uart;
    uint8_t reads = MAX_READS;
    uint8_t came = 0;
    fathom_rx_t rx;
    for (;;) {
        /* The clock is read before each read of the port, and after one with bytes, which may be newer than it. */
        uint32_t silent_us = look(line) + line->silent_us;
        if (came != 0u) {
            line->silent_us = 0;
            if (config->marks != NULL) came = config->marks(line, &rx, came);
            line->have = (uint8_t)(line->have + came);
            if (line->have >= line->need) line->kind->scan(line, false);
            silent_us = line->silent_us;
            if (--reads == 0u) { /* the port may hold newer bytes than those of the stamp */
                line->silent_us = 0;
                break;
            }
        }
        rx.last_us = 0;
        rx.flags = 0;
        const uint8_t had = line->have;
        const int n = uart->read(uart->ctx, &config->frame[had], (size_t)(config->frame_size - had), &rx);
        if (n <= 0) {
            set_silent(line, silent_us);
            if (n < 0) return fathom_line_broken(line);
            break;
        }
        if ((had == 0u) && is_listeners_gap(line)) line->known |= AFTER_GAP;
        forget(line, LATE);
        came = (uint8_t)n;
    }
    if ((line->have != 0u) && (line->silent_us >= gap_us(line))) line->kind->scan(line, true);
    return line->kind->go_on(line);
}

bool fathom_line_is_idle(const fathom_line_t *line)
{
    return !is_busy(line) && (line->state != LEAVING) && (line->have == 0u);
}

fathom_status_t fathom_line_break(fathom_line_t *line, bool on)
{
    const fathom_uart_t *const uart = line->config->uart;
    if (uart->set_break == NULL) return FATHOM_ERR_UNSUPPORTED;
    if (is_busy(line)) return on ? FATHOM_ERR_BUSY : FATHOM_READY; /* what is sent is no break */
    const int is_set = uart->set_break(uart->ctx, on);
    (void)fathom_line_look(line);
    if (is_set <= 0) {
        /* A port that does not end a break gets as much time as one that does not take a request. */
        if (!on && ((line->state == IN_BREAK) || (line->state == ENDING))) {
            if (line->state == IN_BREAK) line->left_us = FATHOM_LINE_SEND_US;
            line->state = ENDING;
            if ((is_set < 0) || (line->left_us == 0u)) return fathom_line_broken(line);
        }
        return (is_set < 0) ? FATHOM_ERR_PORT : FATHOM_PENDING;
    }
    line->state = IN_BREAK;
    if (!on) {
        line->state = IDLE; /* a port that refused a request gets its time anew */
        /* the silence before a request begins here; the listener's has gone on */
        if ((line->have == 0u) && is_listeners_gap(line)) line->known |= AFTER_GAP;
        line->silent_us = 0;
    }
    return FATHOM_READY;
}

uint32_t fathom_line_heard_us(const fathom_line_t *line) { return line->polled_us - line->silent_us; }

/* How long from the last poll until the port may have sent the request, or may take it. The port counts from now on. */
static uint32_t port_due_us(const fathom_line_t *line, uint32_t passed_us)
{
    const fathom_uart_t *const uart = line->config->uart;
    const uint32_t us = (uart->leaves_in_us != NULL) ? uart->leaves_in_us(uart->ctx) : 0u;
    if (us == 0u) return SEND_POLL_US;
    return us + passed_us;
}

uint32_t fathom_line_due_us(const fathom_line_t *line)
{
    const uint32_t passed_us = fathom_elapsed_us(clock_us(line->config->clock), line->polled_us);
    uint32_t due_us;
    if ((uint8_t)(phase(line) - LEAVING) <= (SENDING - LEAVING)) {
        due_us = port_due_us(line, passed_us);
    } else {
        /* With part of a frame there neither a time-out nor the next request comes before the end of it. */
        due_us = FATHOM_NO_DEADLINE;
        if ((line->have == 0u) && is_busy(line))
            due_us = line->left_us;
        else if ((line->have == 0u) && (line->state == IDLE) && (line->head != NULL))
            due_us = line->kind->due_us(line);
    }
    if ((line->have != 0u) || ((line->state & RESPONSE_BAD) != 0))
        due_us = least_us(due_us, rest_us(gap_us(line), line->silent_us));
    if ((line->listener != NULL) && (line->silent_us < line->listener->gap_us))
        due_us = least_us(due_us, rest_us(line->listener->gap_us, line->silent_us));
    return (due_us == FATHOM_NO_DEADLINE) ? due_us : rest_us(due_us, passed_us);
}
