/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_OUTPUT_H
#define FATHOM_OUTPUT_H

#include <stdint.h>

#include "fathom/hal.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief An output that drives the RX pin of a module: its trigger or its mode select.
 *
 * The output is a pin, an inverted pin, a break on the TX of a UART that has no other use, a break of a line or a byte on
 * it (line_pins.h), or none. An output has no state, so it may be copied, and drivers do so. No function waits. A program
 * links only the kind of output that it names.
 *
 * @code
 * const fathom_output_t trigger = fathom_output_pin(&pin);
 * fathom_a16_controlled_init(&a16, &line, &trigger, NULL);
 * static const fathom_a16_auto_config_t config = {.select = {fathom_output_set_pin, &pin}};
 * @endcode
 */

/** @brief What an output is set to. */
enum {
    FATHOM_OUTPUT_HIGH = 0, /**< High. A break ends. */
    FATHOM_OUTPUT_LOW = 1,  /**< Low. A break begins. */
    /** High, at initialisation. A pin is driven high. A TX is high without a break, so the function only checks that
     * the port has `set_break`. */
    FATHOM_OUTPUT_REST = 2,
    FATHOM_OUTPUT_FREE = 3 /**< A break ends. A pin keeps its level. */
};

/** @brief An output. */
typedef struct {
    /**
     * Sets the level, FATHOM_OUTPUT_..., and returns at once. NULL: there is no output.
     *
     * - FATHOM_OK: the level is set. A pin always returns this.
     * - FATHOM_PENDING: the port still sends bytes. Call it again. This may last for ever, so the caller needs a limit;
     *   fathom_trigger_drive() has one.
     * - FATHOM_ERR_PORT: the port is broken.
     * - FATHOM_ERR_UNSUPPORTED: the UART has no `set_break`, or the pin has no `set`.
     * - Of a line: what fathom_line_break() returns.
     */
    fathom_status_t (*set)(const void *ctx, uint8_t level);
    const void *ctx; /**< Passed to `set`; must stay valid as long as the driver. */
} fathom_output_t;

/**
 * @brief The member `set` of an output that is a pin.
 *
 * @param ctx    The fathom_pin_t.
 * @param level  FATHOM_OUTPUT_...
 * @retval FATHOM_OK               The pin has the level.
 * @retval FATHOM_ERR_UNSUPPORTED  `ctx` is NULL, or the pin has no `set`.
 */
fathom_status_t fathom_output_set_pin(const void *ctx, uint8_t level);

/**
 * @brief The member `set` of an output that is an inverted pin: low drives the pin high.
 *
 * @param ctx    The fathom_pin_t.
 * @param level  FATHOM_OUTPUT_...
 * @retval FATHOM_OK               The pin has the level.
 * @retval FATHOM_ERR_UNSUPPORTED  `ctx` is NULL, or the pin has no `set`.
 */
fathom_status_t fathom_output_set_inverted_pin(const void *ctx, uint8_t level);

/**
 * @brief The member `set` of an output to nothing.
 *
 * @param ctx    Not used.
 * @param level  Not used.
 * @retval FATHOM_OK  Always.
 */
fathom_status_t fathom_output_set_none(const void *ctx, uint8_t level);

/**
 * @brief The member `set` of an output that is a break on the TX of a UART that has no other use.
 *
 * @param ctx    The fathom_uart_t.
 * @param level  FATHOM_OUTPUT_...
 * @retval FATHOM_OK               TX has the level.
 * @retval FATHOM_PENDING          The port still sends bytes. Call again.
 * @retval FATHOM_ERR_PORT         The port is broken.
 * @retval FATHOM_ERR_UNSUPPORTED  `ctx` is NULL, or the UART has no `set_break`.
 */
fathom_status_t fathom_output_set_break(const void *ctx, uint8_t level);

/** @brief Returns the output that drives `pin`, which must stay valid. */
static inline fathom_output_t fathom_output_pin(const fathom_pin_t *pin)
{
    fathom_output_t output;
    output.set = fathom_output_set_pin;
    output.ctx = pin;
    return output;
}

/**
 * @brief Returns the output that drives `pin`, which must stay valid, with the opposite level.
 *
 * The trigger of a driver then makes high pulses, as JSN-SR04T and HC-SR04 require (FATHOM_STARTS_HIGH_PULSE), and the
 * pin is low between them.
 */
static inline fathom_output_t fathom_output_inverted_pin(const fathom_pin_t *pin)
{
    fathom_output_t output;
    output.set = fathom_output_set_inverted_pin;
    output.ctx = pin;
    return output;
}

/** @brief Returns the output to a module that has no trigger: one that sends pulses at its own pace. */
static inline fathom_output_t fathom_output_none(void)
{
    fathom_output_t output;
    output.set = fathom_output_set_none;
    output.ctx = NULL;
    return output;
}

/** @brief Returns the output that holds the TX of `uart` low by a break. `uart` must stay valid. */
static inline fathom_output_t fathom_output_break(const fathom_uart_t *uart)
{
    fathom_output_t output;
    output.set = fathom_output_set_break;
    output.ctx = uart;
    return output;
}

/**
 * @brief Sets the level of an output.
 *
 * @param output  The output.
 * @param level   FATHOM_OUTPUT_...
 * @return The result of `output->set`, or FATHOM_ERR_UNSUPPORTED if that is NULL.
 */
static inline fathom_status_t fathom_output_set(const fathom_output_t *output, uint8_t level)
{
    return (output->set != NULL) ? output->set(output->ctx, level) : FATHOM_ERR_UNSUPPORTED;
}

#ifdef __cplusplus
}
#endif

#endif
