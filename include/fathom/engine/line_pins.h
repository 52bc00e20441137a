/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_LINE_PINS_H
#define FATHOM_LINE_PINS_H

#include "fathom/engine/contact.h"
#include "fathom/engine/line.h"
#include "fathom/engine/output.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A line whose pins serve for something else too. What they return points to the line, which outlives it. */

/* Its TX triggers or selects, by a break: `set` is fathom_line_break, with its return values. */
fathom_status_t fathom_output_set_line_break(const void *ctx, uint8_t level);

static inline fathom_output_t fathom_output_line_break(fathom_line_t *line)
{
    fathom_output_t output;
    output.set = fathom_output_set_line_break;
    output.ctx = line;
    return output;
}

/* A contact on its RX: the level is not read while a transaction is on the line, nor until 5 ms after the last byte.
 * The contact polls the line too. For `guard`:
 *
 *   static fathom_contact_guard_t guard;
 *   guard = fathom_contact_line_guard(&line);
 */
fathom_contact_guard_t fathom_contact_line_guard(fathom_line_t *line);

#ifdef __cplusplus
}
#endif

#endif
