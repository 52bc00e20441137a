/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MODBUS_H
#define FATHOM_MODBUS_H

#include "fathom/codec/modbus_rtu.h"
#include "fathom/engine/line.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief The transport of the Modbus drivers: the line of a driver, and how its requests become frames on that line.
 *
 * A driver describes each request as a Modbus message and submits it through its transport. Everything else the driver
 * asks of the line itself: it polls the line, cancels its requests and reads the clock of the line.
 *
 * | transport                       | frames on the line                                            | made by         |
 * |---------------------------------|---------------------------------------------------------------|-----------------|
 * | fathom_modbus_client()          | Modbus RTU                                                    | modbus_client.h |
 * | fathom_modbus_client_with_zero()| Modbus RTU; a unit may have the address 0                     | modbus_client.h |
 * | fathom_dyp_client()             | `55 AA` of the A05: each read becomes a command               | dyp_client.h    |
 * | `modbus` of fathom_libmodbus_t  | Modbus RTU or TCP, through a connection of libmodbus          | port/libmodbus  |
 *
 * **A transport of your own.** Most programs need none. Write one if the requests of the drivers are to be changed or
 * refused before they reach the line, for example to forbid writes:
 *
 * @code
 * static fathom_status_t submit_reads(fathom_line_t *line, fathom_modbus_request_t *request)
 * {
 *     if (request->message.head[1] != FATHOM_MODBUS_READ_HOLDING_REGISTERS) return FATHOM_ERR_UNSUPPORTED;
 *     return fathom_modbus_client_submit(line, request);
 * }
 *
 * static const fathom_modbus_t transport = {.line = &line, .submit = submit_reads};
 * @endcode
 *
 * To carry Modbus over another medium, write a port of the line (hal.h), as port/libmodbus does. The queue, time-outs,
 * retries and the quarantine of the line (line.h) then serve that medium too.
 */

/**
 * @brief A Modbus request, in the caller's memory.
 *
 * Fill in `message` (modbus_rtu.h) and the members `timeout_us`, `retries` and `line_settings` of `transaction`, then
 * submit the request. Do not change the request until `transaction.status` differs from FATHOM_PENDING.
 * fathom_transaction_t lists the results; `transaction.link.heard_us` is then the time of the response.
 */
typedef struct {
    /** @brief The transaction of the line. The first member, so that one pointer serves for both types. */
    fathom_transaction_t transaction;
    /** @brief The request and its response. */
    fathom_modbus_message_t message;
} fathom_modbus_request_t;

/**
 * @brief A transport: a line, and the function that submits Modbus requests to it.
 *
 * A driver refuses a transport without an initialised line: its init function returns FATHOM_ERR_ARGUMENT. The line must
 * stay valid as long as the drivers that use the transport.
 */
typedef struct {
    /** @brief The line, after fathom_line_init(). Its clock is the clock of the drivers. */
    fathom_line_t *line;

    /**
     * @brief Sets `protocol` and `address` of the transaction and submits it to the line (fathom_line_submit()).
     * @retval FATHOM_PENDING          The request is queued; `transaction.status` has its result later.
     * @retval FATHOM_ERR_ARGUMENT     A count is out of range, or the time-out is above 2^31 - 1. Nothing changed.
     * @retval FATHOM_ERR_CAPACITY     The frame buffer is too small for the request or its response. Nothing changed.
     * @retval FATHOM_ERR_BUSY         This request is queued already. Nothing changed.
     * @retval FATHOM_ERR_UNSUPPORTED  The transport cannot carry this request. Nothing changed.
     */
    fathom_status_t (*submit)(fathom_line_t *line, fathom_modbus_request_t *request);
} fathom_modbus_t;

#ifdef __cplusplus
}
#endif

#endif
