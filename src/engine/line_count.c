/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

void fathom_line_count(fathom_line_t *line, uint8_t which, uint8_t by)
{
    uint16_t *const counter = &line->config->counters[which];
    const uint16_t sum = (uint16_t)(*counter + by);
    *counter = (sum < by) ? UINT16_MAX : sum;
}
