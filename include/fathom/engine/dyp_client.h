/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_DYP_CLIENT_H
#define FATHOM_DYP_CLIENT_H

#include "fathom/engine/line.h"
#include "fathom/engine/modbus.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The 55 AA frames of the A05 (A05 2, dyp_55aa.h) on a line, behind the same transport as Modbus: both read the
 * same distances, and so the same driver serves both. A request is described as for Modbus, by the register
 * of its first probe:
 *
 *   read 0x0106, 4 registers             command 01, all probes
 *   read 0x0106..0x0109, 1 register      command 10..13, one probe
 *
 * Nothing else is sent through the transport. On a bad wire one in 256 of the responses that are damaged in
 * more than one byte passes the 8-bit sum; of Modbus, which the same sensors have, one in 65536.
 */
enum { FATHOM_DYP_FIRST_REGISTER = 0x0106 };

/* As submit of fathom_modbus_t. FATHOM_ERR_UNSUPPORTED: no command for this request; nothing happened.
 * FATHOM_ERR_CAPACITY: the line's frame buffer has less than 13 bytes. To unit FATHOM_LINE_ANY_UNIT (FF) the first
 * response is taken, and message.head[0] is then the address that it came from. */
fathom_status_t fathom_dyp_client_submit(fathom_line_t *line, fathom_modbus_request_t *request);

/*
 * Command 03: gives this address, 1..254, to EVERY A05 that hears it, since the frame carries the new address and
 * no old one. Have one unit on the line. transaction.timeout_us, retries and line_settings are set by the caller.
 * FATHOM_PENDING; FATHOM_ERR_ARGUMENT: 0 or 255; FATHOM_ERR_BUSY. The response equals the request: where the line
 * does not know yet whether it echoes, the outcome is FATHOM_ERR_ECHO. Confirm it by a read at the new address.
 */
fathom_status_t fathom_dyp_client_broadcast_address(fathom_line_t *line, fathom_modbus_request_t *request,
                                                    uint8_t address);

/* The transport for drivers over a line that is ready, by value: keep it as long as the drivers that point to it. */
fathom_modbus_t fathom_dyp_client(fathom_line_t *line);

#ifdef __cplusplus
}
#endif

#endif
