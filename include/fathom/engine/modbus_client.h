/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MODBUS_CLIENT_H
#define FATHOM_MODBUS_CLIENT_H

#include "fathom/engine/line.h"
#include "fathom/engine/modbus.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A Modbus RTU client on a line. It has no state of its own: everything is in the line and in the requests.
 * What it can be trusted with on a bad wire, and what cannot be told apart there, stands in line.h.
 *
 *   fathom_modbus_request_t request = {.transaction = {.timeout_us = 100000, .retries = 1}};
 *   fathom_modbus_read_holding_registers(&request.message, 1, 0x0100, 1, &value);
 *   fathom_modbus_client_submit(&line, &request);
 *   while (request.transaction.status == FATHOM_PENDING) fathom_line_poll(&line);
 */

/* As submit and cancel of fathom_modbus_t. A write to unit 0 is a broadcast: no unit responds, and it is OK
 * transaction.timeout_us (the turnaround; the specification advises 100 to 200 ms) after it left. A read of
 * unit 0: FATHOM_ERR_UNSUPPORTED; fathom_modbus_client_with_zero() has that. */
fathom_status_t fathom_modbus_client_submit(fathom_line_t *line, fathom_modbus_request_t *request);
void fathom_modbus_client_cancel(fathom_line_t *line, fathom_modbus_request_t *request);

/* The transport for drivers over a line that is ready, by value: keep it as long as the drivers that point to it. */
fathom_modbus_t fathom_modbus_client(fathom_line_t *line);

/* Both where a unit may have the address 0: it responds to a read of unit 0, and to one of any unit (255). Only while
 * such a read is under way are its frames looked for: zeros are what noise is made of. */
fathom_status_t fathom_modbus_client_submit_with_zero(fathom_line_t *line, fathom_modbus_request_t *request);
fathom_modbus_t fathom_modbus_client_with_zero(fathom_line_t *line);

#ifdef __cplusplus
}
#endif

#endif
