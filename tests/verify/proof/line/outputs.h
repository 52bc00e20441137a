/* SPDX-License-Identifier: MIT */
#ifndef OUTPUTS_H
#define OUTPUTS_H

#include "any_line.h"
#include "fathom/engine/line_pins.h"

/* What may drive a module's RX pin, 0..6: a pin, a break of a UART that can and of one that cannot, a break of the
 * line, no output; a trigger may be a byte on the line, or an output to nothing, too. */
static fathom_output_t output_of(uint8_t which)
{
    static fathom_line_byte_t any_byte;
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
    case 4:
        return output;
    case 5:
        any_byte.line = &any_line;
        any_byte.byte = any_8();
        return fathom_output_line_byte(&any_byte);
    default:
        return fathom_output_none();
    }
}

#endif
