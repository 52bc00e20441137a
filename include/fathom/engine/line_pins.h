/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_LINE_PINS_H
#define FATHOM_LINE_PINS_H

#include "fathom/engine/contact.h"
#include "fathom/engine/line.h"
#include "fathom/engine/output.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Uses the pins of a line for a second purpose: TX as a trigger or select, RX as the level of a switch.
 *
 * The functions make an output (output.h) or a guard (contact.h) from a line. They keep no state and never wait. The
 * line must stay valid as long as the result is used.
 *
 * @code
 * const fathom_output_t trigger = fathom_output_line_break(&line);
 * fathom_a16_controlled_init(&a16, &line, &trigger, NULL);
 *
 * static fathom_contact_guard_t guard;                      // must stay valid as long as the contact
 * guard = fathom_contact_line_guard(&line);
 * @endcode
 */

/**
 * @brief The member `set` of an output that is a break of a line.
 *
 * @param ctx    The fathom_line_t.
 * @param level  FATHOM_OUTPUT_...
 * @return As fathom_line_break(). FATHOM_OUTPUT_REST only checks that the port has `set_break`.
 */
fathom_status_t fathom_output_set_line_break(const void *ctx, uint8_t level);

/** @brief Returns the output that holds the TX of `line` low by a break. While TX is low, the line sends nothing. */
static inline fathom_output_t fathom_output_line_break(fathom_line_t *line)
{
    fathom_output_t output;
    output.set = fathom_output_set_line_break;
    output.ctx = line;
    return output;
}

/** @brief A byte that triggers a module whose RX is the TX of a line. */
typedef struct {
    fathom_line_t *line; /**< The line, initialised. It must be able to send: its port has `write` (hal.h). */
    uint8_t byte;        /**< The byte: `trigger_byte` of the model. */
} fathom_line_byte_t;

/**
 * @brief The member `set` of an output that sends a byte.
 *
 * @param ctx    The fathom_line_byte_t.
 * @param level  FATHOM_OUTPUT_... FATHOM_OUTPUT_LOW sends the byte. All other levels only check that the port has
 *               `write`.
 * @retval FATHOM_OK               The port has accepted the byte.
 * @retval FATHOM_PENDING          The port is busy. Nothing was sent: call again.
 * @retval FATHOM_ERR_BUSY         A transaction or a break uses the line. Nothing was sent: call again.
 * @retval FATHOM_ERR_PORT         The port is broken.
 * @retval FATHOM_ERR_UNSUPPORTED  The port has no `write`.
 */
fathom_status_t fathom_output_set_line_byte(const void *ctx, uint8_t level);

/**
 * @brief Returns the output that sends a byte where a pin would fall: the trigger of a model with FATHOM_STARTS_BYTE.
 *
 * The line does not count the byte as a request, so nothing else may be sent on it. `line_byte` must stay valid as long
 * as the driver.
 */
static inline fathom_output_t fathom_output_line_byte(const fathom_line_byte_t *line_byte)
{
    fathom_output_t output;
    output.set = fathom_output_set_line_byte;
    output.ctx = line_byte;
    return output;
}

/**
 * @brief Returns the guard of a contact on the RX of `line`.
 *
 * The level does not count while a transaction is in progress, nor until FATHOM_CONTACT_QUIET_US (5 ms) after the last
 * byte. The contact polls the line. Keep the guard as long as the contact.
 */
fathom_contact_guard_t fathom_contact_line_guard(fathom_line_t *line);

#ifdef __cplusplus
}
#endif

#endif
