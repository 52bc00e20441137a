/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MODBUS_H
#define FATHOM_MODBUS_H

#include "fathom/codec/modbus_rtu.h"
#include "fathom/engine/line.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The transport between the Modbus sensors and what carries Modbus: modbus_client.h on a line, or a port over
 * another stack. A driver knows only this.
 */

/*
 * A request in the caller's memory. Fill in the message (modbus_rtu.h), transaction.timeout_us,
 * transaction.retries and transaction.line_settings (NULL: as the line is), submit it, and leave it alone until
 * transaction.status is no longer FATHOM_PENDING; what it may then be stands at fathom_transaction_t, as does the time
 * of the response, transaction.link.heard_us. The rest of the transaction is the transport's.
 */
typedef struct {
    fathom_transaction_t transaction; /* first, so that one pointer is both */
    fathom_modbus_message_t message;
} fathom_modbus_request_t;

/*
 * submit    FATHOM_PENDING: under way, transaction.status tells the rest. Else nothing happened:
 *           FATHOM_ERR_ARGUMENT   a count out of range, or a time-out over 2^31 - 1
 *           FATHOM_ERR_CAPACITY   the transport's frame buffer is too small for the request or its response
 *           FATHOM_ERR_BUSY       this request is under way already
 * cancel    Ends a request with FATHOM_ERR_CANCELLED; its memory is the caller's again.
 * cancel_unit  The same for every request to this unit that has not ended: it is no longer where it was.
 * poll      Does all that can be done without waiting. FATHOM_PENDING, or FATHOM_ERR_PORT: the transport's port is
 *           broken, and what was under way has ended with that.
 * clock     The clock of the transport and of the drivers over it, which it outlives.
 * due_us    How long until poll has something to do if no byte comes; FATHOM_NO_DEADLINE.
 */
typedef struct {
    fathom_status_t (*submit)(void *ctx, fathom_modbus_request_t *request);
    void (*cancel)(void *ctx, fathom_modbus_request_t *request);
    void (*cancel_unit)(void *ctx, uint8_t address);
    fathom_status_t (*poll)(void *ctx);
    uint32_t (*due_us)(void *ctx);
    const fathom_clock_t *clock;
    void *ctx;
} fathom_modbus_t;

/* A transport whose requests are transactions of a line: all but submit is the line's, the clock too. The line is
 * ready (fathom_line_init). By value: keep it as long as the drivers that point to it. */
fathom_modbus_t fathom_modbus_over_line(fathom_line_t *line,
                                        fathom_status_t (*submit)(void *line,
                                                                  fathom_modbus_request_t *request));

#ifdef __cplusplus
}
#endif

#endif
