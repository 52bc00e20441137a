/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

/* A line that only listens: all that comes is the listener's. */

static void scan(fathom_line_t *line, bool over)
{
    (void)over;
    if (line->have == 0u) return;
    fathom_line_leave(line, line->have);
    forget(line, AFTER_GAP);
    line->have = 0; /* `need` is that already: no frame is waited for */
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
