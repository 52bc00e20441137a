/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

/*
 * The optional parts of a line. fathom_line_parts_t names each of them by a function pointer, and the linker drops
 * those that no line names.
 */

/* ---- fathom_line_parts_t.count ---- */

void fathom_line_count(fathom_line_t *line, uint8_t which, uint8_t by)
{
    uint16_t *const counter = &line->parts->counters[which];
    const uint32_t sum = (uint32_t)*counter + by;
    *counter = (sum > UINT16_MAX) ? UINT16_MAX : (uint16_t)sum;
}

/* ---- fathom_line_parts_t.find_echo ---- */

void fathom_line_find_echo(fathom_line_t *line, uint8_t echo)
{
    if (line->parts->echo == FATHOM_LINE_ECHO_AUTO) line->echo = echo;
}

/* ---- fathom_line_parts_t.marks ---- */

enum {
    BAD_BYTES = FATHOM_RX_PARITY | FATHOM_RX_FRAMING, /* The new bytes themselves are damaged. */
    MARKED = FATHOM_RX_PARITY | FATHOM_RX_FRAMING |
             FATHOM_RX_OVERRUN /* A frame cannot continue across the new bytes. */
};

/* Ends the frame before the new bytes, and reports to the listener that bytes were lost here. */
static void interrupt_frame(fathom_line_t *line)
{
    line->kind->scan(line, true);
    if (line->attempt.copy == COPY_DUE)
        line->attempt.copy = COPY_HIDDEN; /* The echo may be among the lost bytes. */
    line->is_after_gap = false;
    fathom_line_pass(line, 0, 0);
}

uint8_t fathom_line_marks(fathom_line_t *line, const fathom_rx_t *rx, uint8_t new_count)
{
    uint8_t *const frame = line->parts->frame;
    const uint8_t *const new_bytes = &frame[line->received_count];
    if (((rx->flags & FATHOM_RX_SILENCE) != 0) && !holds_bytes(line)) line->is_after_gap = true;
    if ((rx->flags & MARKED) == 0) return new_count;

    interrupt_frame(line); /* The frame buffer is empty now. */
    if ((rx->flags & BAD_BYTES) != 0) {
        fathom_line_add(line, FATHOM_LINE_BAD_BYTES, new_count);
        return 0;
    }
    fathom_line_add(line, FATHOM_LINE_BAD_BYTES, 1);
    for (uint8_t i = 0; i != new_count; i++) frame[i] = new_bytes[i];
    return new_count;
}
