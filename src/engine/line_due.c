/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

/* The next deadline of a line, for programs that sleep. */

enum { SEND_POLL_US = 1000 };

/*
 * Returns when the port may have sent the request, or may accept it, in microseconds after the last poll. The port
 * counts from now, which is `passed_us` after the last poll.
 */
static uint32_t port_due_us(const fathom_line_t *line, uint32_t passed_us)
{
    const fathom_uart_t *const uart = line->parts->uart;
    const uint32_t us = (uart->leaves_in_us != NULL) ? uart->leaves_in_us(uart->ctx) : 0u;
    if (us == 0u) return SEND_POLL_US;
    return us + passed_us;
}

/* Returns true if the attempt ends at the next gap, because the response is damaged. */
static bool ends_at_gap(const fathom_line_t *line)
{
    return (line->attempt.fault == FAULT_TRUNCATED) || (line->attempt.fault == FAULT_CORRUPT);
}

uint32_t fathom_line_attempt_left_us(const fathom_line_t *line)
{
    if (line->received_count != 0u) return line->phase_left_us;
    if (!ends_at_gap(line)) return response_left_us(line);
    return least_us(response_left_us(line), fathom_line_gap_left_us(line));
}

/* Returns when the present phase may end, in microseconds after the last poll. */
static uint32_t phase_due_us(const fathom_line_t *line, uint32_t passed_us)
{
    switch (line->phase) {
    case FATHOM_LINE_DRAINING:
    case FATHOM_LINE_PORT_BUSY:
    case FATHOM_LINE_SENDING:
        return port_due_us(line, passed_us);
    case FATHOM_LINE_WAITING:
        return fathom_line_attempt_left_us(line);
    default: /* IDLE, IN_BREAK, ENDING_BREAK */
        if (line->head == NULL) return FATHOM_NO_DEADLINE;
        return (line->phase == FATHOM_LINE_ENDING_BREAK) ? line->phase_left_us : line->kind->due_us(line);
    }
}

uint32_t fathom_line_due_us(const fathom_line_t *line)
{
    if (!is_initialised(line)) return FATHOM_NO_DEADLINE;
    const uint32_t passed_us = time_since_us(clock_us(line->parts->clock), line->polled_us);
    uint32_t due_us = least_us(phase_due_us(line, passed_us), fathom_line_frame_over_us(line));
    if ((line->listener != NULL) && (line->silent_us < line->listener->gap_us))
        due_us = least_us(due_us, (uint32_t)(line->listener->gap_us - line->silent_us));
    return (due_us == FATHOM_NO_DEADLINE) ? due_us : rest_us(due_us, passed_us);
}
