/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

void fathom_line_find_echo(fathom_line_t *line, uint8_t echo)
{
    if (line->config->echo == FATHOM_LINE_ECHO_AUTO)
        line->known = (uint8_t)((line->known & ~(unsigned)ECHO) | echo);
}
