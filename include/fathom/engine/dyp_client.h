/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_DYP_CLIENT_H
#define FATHOM_DYP_CLIENT_H

#include "fathom/engine/line.h"
#include "fathom/engine/modbus.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Carries the `55 AA` frames of the A05 (datasheet A05 2) on a line, behind the transport of the Modbus drivers.
 *
 * a05_dyp.h needs this file; most programs only call fathom_dyp_client(). The protocol reads the same distances as
 * Modbus, so one interface serves both: a request is a Modbus read of the register of its first probe. The client keeps
 * no state outside the line and the requests, never waits and never allocates memory. include/COST.md has the flash of
 * a driver with this client (`a05_dyp`).
 *
 * | Modbus request                    | command of the frame |
 * |-----------------------------------|----------------------|
 * | read 0x0106, 4 registers          | 01: all probes       |
 * | read 0x0106 to 0x0109, 1 register | 10 to 13: one probe  |
 *
 * The transport sends nothing else. On a bad wire the sum of 8 bits lets one in 256 of the responses pass that are
 * damaged in more than one byte. Modbus, which the same module speaks, lets one in 65536 pass.
 *
 * @code
 * const fathom_modbus_t transport = fathom_dyp_client(&line); // `line` is initialised
 * @endcode
 */

/** @brief Registers by which a request names its probes. */
enum {
    FATHOM_DYP_FIRST_REGISTER = 0x0106 /**< Register of probe 1. The next three are those of probes 2 to 4. */
};

/**
 * @brief Submits a request to the line, as fathom_modbus_t::submit.
 *
 * If the request is to FATHOM_LINE_ANY_UNIT (FF), the line accepts the first response, and `message.head[0]` is then
 * the address of the unit that sent it.
 *
 * @param line     The line, initialised.
 * @param request  The request. Must stay valid until `transaction.status` differs from FATHOM_PENDING.
 * @retval FATHOM_PENDING          The request is queued.
 * @retval FATHOM_ERR_UNSUPPORTED  There is no command for this request. Nothing changed.
 * @retval FATHOM_ERR_ARGUMENT     The address is 0, or as fathom_line_submit(). Nothing changed.
 * @retval FATHOM_ERR_CAPACITY     The frame buffer of the line has less than 13 bytes. Nothing changed.
 * @retval FATHOM_ERR_BUSY         The request is queued already. Nothing changed.
 */
fathom_status_t fathom_dyp_client_submit(fathom_line_t *line, fathom_modbus_request_t *request);

/**
 * @brief Submits command 03, which gives this address to EVERY A05 of the line (A05 2(3)5).
 *
 * The frame contains the new address and no old one, so have one A05 on the line. Set `timeout_us`, `retries` and
 * `line_settings` of `request->transaction` before the call. The response equals the request. If the line does not know
 * yet whether it echoes, the result is FATHOM_ERR_ECHO (line.h, rule 9). Next, read at the new address.
 *
 * @param line     The line, initialised.
 * @param request  The request. Must stay valid until `transaction.status` differs from FATHOM_PENDING.
 * @param address  The new address, 1 to 254.
 * @retval FATHOM_PENDING       The request is queued.
 * @retval FATHOM_ERR_ARGUMENT  The address is 0 or 255, or as fathom_line_submit(). Nothing changed.
 * @retval FATHOM_ERR_CAPACITY  The frame buffer of the line has less than 13 bytes.
 * @retval FATHOM_ERR_BUSY      The request is queued already. Nothing changed.
 */
fathom_status_t fathom_dyp_client_broadcast_address(fathom_line_t *line, fathom_modbus_request_t *request,
                                                    uint8_t address);

/**
 * @brief Returns the transport for drivers, by value. Drivers copy it.
 *
 * @param line  The line, initialised. If the line is not initialised, each driver refuses the transport with
 *              FATHOM_ERR_ARGUMENT.
 */
fathom_modbus_t fathom_dyp_client(fathom_line_t *line);

#ifdef __cplusplus
}
#endif

#endif
