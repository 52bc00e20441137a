/* SPDX-License-Identifier: MIT */
#include "fathom/engine/output.h"

/* The kinds of output that need no line: a pin of either polarity, a break of a UART, and none. line_pins.c has those of a line. */

fathom_status_t fathom_output_set_pin(const void *ctx, uint8_t level)
{
    const fathom_pin_t *const pin = ctx;
    if ((pin == NULL) || (pin->set == NULL)) return FATHOM_ERR_UNSUPPORTED;
    if (level != FATHOM_OUTPUT_FREE) pin->set(pin->ctx, level != FATHOM_OUTPUT_LOW);
    return FATHOM_OK;
}

fathom_status_t fathom_output_set_inverted_pin(const void *ctx, uint8_t level)
{
    const fathom_pin_t *const pin = ctx;
    if ((pin == NULL) || (pin->set == NULL)) return FATHOM_ERR_UNSUPPORTED;
    if (level != FATHOM_OUTPUT_FREE) pin->set(pin->ctx, level == FATHOM_OUTPUT_LOW);
    return FATHOM_OK;
}

fathom_status_t fathom_output_set_none(const void *ctx, uint8_t level)
{
    (void)ctx;
    (void)level;
    return FATHOM_OK;
}

fathom_status_t fathom_output_set_break(const void *ctx, uint8_t level)
{
    const fathom_uart_t *const uart = ctx;
    if ((uart == NULL) || (uart->set_break == NULL)) return FATHOM_ERR_UNSUPPORTED;
    if (level == FATHOM_OUTPUT_REST) return FATHOM_OK;
    const int is_set = uart->set_break(uart->ctx, level == FATHOM_OUTPUT_LOW);
    if (is_set < 0) return FATHOM_ERR_PORT;
    return (is_set > 0) ? FATHOM_OK : FATHOM_PENDING;
}
