/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

/*
 * A line that only listens: the listener receives all bytes at once. A program that uses only this kind of line links
 * nothing of line_request.c.
 */

static void scan(fathom_line_t *line, bool is_over)
{
    (void)is_over;
    if (line->received_count == 0u) return;
    fathom_line_pass(line, 0, line->received_count);
    line->received_count = 0;
}

static fathom_status_t advance(fathom_line_t *line)
{
    (void)line;
    return FATHOM_PENDING;
}

static const fathom_line_kind_t listening = {scan, advance, NULL, NULL, NULL};

fathom_status_t fathom_line_init_listening(fathom_line_t *line, const fathom_line_parts_t *parts)
{
    return fathom_line_begin(line, parts, &listening);
}
