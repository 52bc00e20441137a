/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_OUTPUT_H
#define FATHOM_OUTPUT_H

#include <stddef.h>
#include <stdint.h>

#include "fathom/hal.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * What drives the RX pin of a module, its trigger or its mode select: a pin, a break on the TX of a UART that is used
 * for nothing else, or a break of a line (line_pins.h). A driver takes it by value:
 *
 *   config.trigger = fathom_output_pin(&pin);
 *   static const fathom_a16_auto_config_t config = {.line = &line, .select = {fathom_output_set_pin, &pin}};
 */
enum {
    FATHOM_OUTPUT_HIGH = 0,
    FATHOM_OUTPUT_LOW = 1,
    /* High, before anything was low: a pin is set. Of a TX, which is
     * high where no break holds it, it is only checked that it can be held low. */
    FATHOM_OUTPUT_REST = 2,
    FATHOM_OUTPUT_FREE = 3 /* a break ends; a pin stays as it is */
};

typedef struct {
    /*
     * Sets the level, FATHOM_OUTPUT_... FATHOM_READY: it is so now, always where it is a pin. FATHOM_PENDING: the port
     * still sends, call again. FATHOM_ERR_UNSUPPORTED: the port has no set_break. FATHOM_ERR_PORT: it is broken. Of a
     * line: what fathom_line_break returns. NULL: there is no output.
     */
    fathom_status_t (*set)(const void *ctx, uint8_t level);
    const void *ctx; /* outlives the driver */
} fathom_output_t;

/* `set` of a fathom_pin_t and of a fathom_uart_t. */
fathom_status_t fathom_output_set_pin(const void *ctx, uint8_t level);
fathom_status_t fathom_output_set_break(const void *ctx, uint8_t level);

static inline fathom_output_t fathom_output_pin(const fathom_pin_t *pin)
{
    fathom_output_t output;
    output.set = fathom_output_set_pin;
    output.ctx = pin;
    return output;
}

static inline fathom_output_t fathom_output_break(const fathom_uart_t *uart)
{
    fathom_output_t output;
    output.set = fathom_output_set_break;
    output.ctx = uart;
    return output;
}

/* As output->set; FATHOM_ERR_UNSUPPORTED where there is no output. */
static inline fathom_status_t fathom_output_set(const fathom_output_t *output, uint8_t level)
{
    return (output->set != NULL) ? output->set(output->ctx, level) : FATHOM_ERR_UNSUPPORTED;
}

#ifdef __cplusplus
}
#endif

#endif
