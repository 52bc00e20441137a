/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

/*
 * The part for a port that knows when no response will arrive, such as a Modbus TCP gateway whose unit is silent.
 */

uint8_t fathom_line_refusals(fathom_line_t *line, const fathom_rx_t *rx, uint8_t new_count)
{
    if ((rx->flags & FATHOM_RX_NO_RESPONSE) == 0) return new_count;
    if (is_busy(line) && expects_response(line)) {
        const uint16_t units = line->quarantined_units;
        const uint32_t left_us = line->quarantine_left_us;
        fathom_line_end_attempt(line);
        line->quarantined_units = units; /* No late response can arrive. */
        line->quarantine_left_us = left_us;
    }
    return 0;
}
