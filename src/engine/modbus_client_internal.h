/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MODBUS_CLIENT_INTERNAL_H
#define FATHOM_MODBUS_CLIENT_INTERNAL_H

#include "fathom/engine/modbus_client.h"

/*
 * The functions that modbus_client.c and modbus_client_zero.c share. The first four are members of their protocol
 * tables.
 */

uint8_t fathom_modbus_client_encode(const fathom_transaction_t *transaction, uint8_t *frame);
bool fathom_modbus_client_is_request(const fathom_transaction_t *transaction, const uint8_t *frame,
                                     uint8_t have);
bool fathom_modbus_client_may_collide(const fathom_transaction_t *transaction);
fathom_status_t fathom_modbus_client_parse_response(fathom_transaction_t *transaction, const uint8_t *frame);

fathom_status_t fathom_modbus_client_start(fathom_line_t *line, fathom_modbus_request_t *request,
                                           const fathom_protocol_t *with);

static inline bool fathom_modbus_client_reads_0(const fathom_modbus_request_t *request)
{
    return (request->message.head[0] == FATHOM_MODBUS_BROADCAST) &&
           (request->message.head[1] == FATHOM_MODBUS_READ_HOLDING_REGISTERS);
}

#endif
