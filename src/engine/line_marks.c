/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

enum { BAD = FATHOM_RX_PARITY | FATHOM_RX_FRAMING, MARKED = BAD | FATHOM_RX_OVERRUN };

uint8_t fathom_line_marks(fathom_line_t *line, const fathom_rx_t *rx, uint8_t came)
{
    uint8_t *to = line->config->frame;
    const uint8_t *from = &to[line->have];
    const uint8_t flags = rx->flags;
    if (((flags & FATHOM_RX_SILENCE) != 0) && (line->have == 0u)) line->known |= AFTER_GAP;
    if ((flags & FATHOM_RX_TIMED) != 0) {
        const uint32_t silent_us = fathom_elapsed_us(line->polled_us, rx->last_us);
        set_silent(line, (silent_us <= (UINT32_MAX / 2u)) ? silent_us
                                                          : 0u); /* a stamp later than the clock is "now" */
    }
    if ((flags & MARKED) == 0) return came;
    /* What had come before is over. */
    line->kind->scan(line, true);
    if (is_busy(line)) line->state |= NOISY;
    forget(line, AFTER_GAP);
    fathom_line_leave(line, 0);
    if ((flags & BAD) != 0) {
        count(line, FATHOM_LINE_BAD_BYTES, came);
        return 0;
    }
    count(line, FATHOM_LINE_BAD_BYTES, 1);
    for (uint8_t i = 0; i != came; i++) to[i] = from[i];
    return came;
}
