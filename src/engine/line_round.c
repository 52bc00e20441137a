/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

/*
 * One poll of the line for all its users in a round of the main loop. Each user keeps the time of its own last call, so the
 * line does not know its users.
 *
 *  - If the clock has not moved since the last poll, every user polls: that costs time and loses nothing.
 *  - A poll of before a sleep does not count. The silence may be long over, and a request that is submitted now would
 *    leave too late in it (line_senders.c).
 *  - While the age of the bytes in the port is not known, as after an error, every user polls and receives the error.
 */
bool fathom_line_was_polled(const fathom_line_t *line, uint32_t since_us)
{
    if (line->kind == NULL) return false;
    const uint32_t now_us = clock_us(line->parts->clock);
    const uint32_t passed_us = fathom_elapsed_us(now_us, line->polled_us);
    return (line->age < AGE_OLD) && (passed_us < FATHOM_LINE_ROUND_US) &&
           (passed_us < fathom_elapsed_us(now_us, since_us));
}
