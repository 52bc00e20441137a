/* SPDX-License-Identifier: MIT */
#ifndef TRANSPORT_H
#define TRANSPORT_H

#include "any_line.h"

/*
 * Any transport that keeps to fathom/engine/modbus.h, on any line, to prove the drivers over it: over a client, whose own
 * proof is clients.c, or over a port's. A request ends with any status that stands at fathom_transaction_t. What the
 * transport may rely on is asserted.
 */

/* The registers of a response are there as soon as the request is, and can be any: nothing tells a driver when they
 * come but the status, and until then it may not look. */
static void assumed_registers(const fathom_modbus_message_t *message)
{
    const uint8_t count = message->head[5];
    /*@ assert count_of_read: 1 <= count <= 125 && message->head[4] == 0; */
    /*@ assert room: \valid(message->values + (0 .. count - 1)); */
    for (uint8_t i = 0; i < count; i++) message->values[i] = any_16();
}

static fathom_status_t assumed_submit(fathom_line_t *line, fathom_modbus_request_t *request)
{
    const uint8_t *const head = request->message.head;
    /*@ assert line == &any_line; */
    /*@ assert \initialized(&request->transaction.timeout_us) && \initialized(&request->transaction.retries); */
    if (request->transaction.line_settings != NULL)
        (void)assumed_set_line(&assumed_ctx, request->transaction.line_settings);
    if (any_line_queued == &request->transaction) return FATHOM_ERR_BUSY;
    if (any_bool()) return (fathom_status_t)Frama_C_interval(FATHOM_ERR_OTHER_MASTER, FATHOM_ERR_ARGUMENT);
    if (head[1] == FATHOM_MODBUS_READ_HOLDING_REGISTERS) {
        assumed_registers(&request->message);
    } else if (head[1] == FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS) {
        /*@ assert sent_many: 1 <= head[5] <= 123 &&
                              \initialized(request->message.values + (0 .. head[5] - 1)); */
    } else {
        /*@ assert function: head[1] == FATHOM_MODBUS_WRITE_SINGLE_REGISTER; */
    }
    request->transaction.address = head[0];
    request->message.head[0] = any_8(); /* of a read of any unit: who has responded */
    request->message.exception = any_8();
    request->transaction.status = FATHOM_PENDING;
    request->transaction.attempts = 0;
    any_line_queued = &request->transaction;
    return FATHOM_PENDING;
}

static const fathom_modbus_t assumed_transport = {&any_line, assumed_submit};

#endif
