/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

/* A line that only listens: all that comes is the listener's. */

static void scan(fathom_line_t *line, bool over)
{
    const uint8_t have = line->have;
    (void)over;
    if (have == 0u) return;
    fathom_line_leave(line, have);
    fathom_line_drop(line, have);
}

static fathom_status_t go_on(fathom_line_t *line)
{
    (void)line;
    return FATHOM_PENDING;
}

static const fathom_line_kind_t listening = {scan, go_on, NULL, NULL, NULL};

fathom_status_t fathom_line_init_listening(fathom_line_t *line, const fathom_line_config_t *config)
{
    return fathom_line_begin(line, config, &listening);
}
