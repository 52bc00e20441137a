/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MODBUS_CLIENT_H
#define FATHOM_MODBUS_CLIENT_H

#include "fathom/engine/line.h"
#include "fathom/engine/modbus.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Sends Modbus RTU requests over a line, for a program or for the Modbus drivers.
 *
 * The client has no state of its own: everything is in the line and in the requests. The client never waits. line.h has
 * the rules for a noisy wire, and states what cannot be distinguished there. include/COST.md has the size of a line
 * with a client in its first table.
 *
 * @code
 * fathom_modbus_request_t request = {.transaction = {.timeout_us = 100000, .retries = 1}};
 * fathom_modbus_read_holding_registers(&request.message, 1, 0x0100, 1, &value);
 * fathom_modbus_client_submit(&line, &request);
 * while (request.transaction.status == FATHOM_PENDING) fathom_line_poll(&line);
 * @endcode
 *
 * **Broadcast.** A write to unit 0 is a broadcast: all units execute it, and none responds. It ends with FATHOM_OK
 * `timeout_us` after it has left. This is the turnaround delay, for which the standard advises 100 to 200 ms.
 */

/**
 * @brief Puts a request into the queue of the line. As `submit` of fathom_modbus_t (modbus.h).
 *
 * @param line     The line.
 * @param request  The request. The line uses it until its status differs from FATHOM_PENDING.
 * @retval FATHOM_PENDING          The request is queued. Call fathom_line_poll() until its status changes.
 * @retval FATHOM_ERR_UNSUPPORTED  A read of unit 0. Use fathom_modbus_client_submit_with_zero().
 * @return All other errors: as `submit` of fathom_modbus_t. Nothing was sent.
 */
fathom_status_t fathom_modbus_client_submit(fathom_line_t *line, fathom_modbus_request_t *request);

/**
 * @brief Ends a request with FATHOM_ERR_CANCELLED. After the call its memory belongs to the caller again.
 *
 * If the request is not queued, nothing happens. As fathom_line_cancel().
 *
 * @param line     The line.
 * @param request  The request.
 */
void fathom_modbus_client_cancel(fathom_line_t *line, fathom_modbus_request_t *request);

/**
 * @brief Returns the transport for Modbus drivers on an initialised line.
 *
 * Keep the transport as long as the drivers, because they point to it. The line must stay valid as long.
 *
 * @param line  The line, initialised. If the line is not initialised, each driver refuses the transport with
 *              FATHOM_ERR_ARGUMENT.
 */
fathom_modbus_t fathom_modbus_client(fathom_line_t *line);

/**
 * @brief Puts a request into the queue of a line on which a unit may have the address 0.
 *
 * Such a unit responds to a read of unit 0, and to a read of any unit (255). The line searches for frames of unit 0
 * only while such a read is in progress, because noise often consists of zeros.
 *
 * @param line     The line.
 * @param request  The request. The line uses it until its status differs from FATHOM_PENDING.
 * @return As fathom_modbus_client_submit(), but a read of unit 0 is allowed.
 */
fathom_status_t fathom_modbus_client_submit_with_zero(fathom_line_t *line, fathom_modbus_request_t *request);

/**
 * @brief Returns the transport for drivers on a line on which a unit may have the address 0.
 *
 * Needed for `address_zero` of fathom_modbus_config_t. Keep it as the result of fathom_modbus_client().
 *
 * @param line  The line, initialised.
 */
fathom_modbus_t fathom_modbus_client_with_zero(fathom_line_t *line);

#ifdef __cplusplus
}
#endif

#endif
