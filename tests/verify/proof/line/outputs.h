/* SPDX-License-Identifier: MIT */
#ifndef OUTPUTS_H
#define OUTPUTS_H

#include "any_line.h"
#include "fathom/engine/line_pins.h"

/* What may drive a module's RX pin, 0..4: a pin, a break of a UART that can and of one that cannot, a break of the
 * line, nothing. */
static fathom_output_t output_of(uint8_t which)
{
    fathom_output_t output;
    output.set = NULL;
    output.ctx = NULL;
    switch (which) {
    case 0:
        return fathom_output_pin(&assumed_output);
    case 1:
        return fathom_output_break(&assumed_uart);
    case 2:
        return fathom_output_break(&assumed_bare_uart);
    case 3:
        return fathom_output_line_break(&any_line);
    default:
        return output;
    }
}

#endif
