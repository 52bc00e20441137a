/* SPDX-License-Identifier: MIT */
#include "fathom/engine/modbus_client.h"

#include "fathom/codec/crc16.h"
#include "modbus_client_internal.h"

/*
 * The Modbus RTU client of a line: its protocol table and its transport. The functions that
 * modbus_client_zero.c needs too are in modbus_client_internal.h.
 */

uint8_t fathom_modbus_client_encode(const fathom_transaction_t *transaction, uint8_t *frame)
{
    return fathom_modbus_rtu_encode_request(&((const fathom_modbus_request_t *)transaction)->message, frame);
}

bool fathom_modbus_client_is_request(const fathom_transaction_t *transaction, const uint8_t *frame,
                                     uint8_t have)
{
    return fathom_modbus_rtu_is_request(&((const fathom_modbus_request_t *)transaction)->message, frame,
                                        have);
}

bool fathom_modbus_client_may_collide(const fathom_transaction_t *transaction)
{
    const fathom_modbus_message_t *const message = &((const fathom_modbus_request_t *)transaction)->message;
    return (message->head[1] == FATHOM_MODBUS_READ_HOLDING_REGISTERS) && !message->has_effect;
}

fathom_status_t fathom_modbus_client_parse_response(fathom_transaction_t *transaction, const uint8_t *frame)
{
    return fathom_modbus_rtu_parse_response(&((fathom_modbus_request_t *)transaction)->message, frame);
}

/* Noise often consists of zeros, so this client searches for no frame of unit 0. */
static uint8_t length(const uint8_t *frame, uint8_t have)
{
    return (frame[0] != FATHOM_MODBUS_BROADCAST) ? fathom_modbus_rtu_response_length(frame, have) : 0u;
}

static const fathom_protocol_t protocol = {.encode = fathom_modbus_client_encode,
                                           .length = length,
                                           .check = fathom_crc16,
                                           .is_request = fathom_modbus_client_is_request,
                                           .parse_response = fathom_modbus_client_parse_response,
                                           .may_collide = fathom_modbus_client_may_collide};

fathom_status_t fathom_modbus_client_start(fathom_line_t *line, fathom_modbus_request_t *request,
                                           const fathom_protocol_t *with)
{
    const uint8_t frame_size = fathom_modbus_rtu_frame_size(&request->message);
    if (frame_size == 0u) return FATHOM_ERR_ARGUMENT;
    if (frame_size > line->parts->frame_size) return FATHOM_ERR_CAPACITY;
    request->transaction.protocol = with;
    request->transaction.address = request->message.head[0];
    return fathom_line_submit(line, &request->transaction);
}

fathom_status_t fathom_modbus_client_submit(fathom_line_t *line, fathom_modbus_request_t *request)
{
    if (fathom_modbus_client_reads_0(request)) return FATHOM_ERR_UNSUPPORTED;
    return fathom_modbus_client_start(line, request, &protocol);
}

void fathom_modbus_client_cancel(fathom_line_t *line, fathom_modbus_request_t *request)
{
    fathom_line_cancel(line, &request->transaction);
}

fathom_modbus_t fathom_modbus_client(fathom_line_t *line)
{
    const fathom_modbus_t transport = {.line = line, .submit = fathom_modbus_client_submit};
    return transport;
}
