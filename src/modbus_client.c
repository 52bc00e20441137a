/* SPDX-License-Identifier: MIT */
#include "fathom/modbus_client.h"

#include "fathom/crc16.h"

static uint8_t encode(const fathom_exchange_t *exchange, uint8_t *frame)
{
    return fathom_modbus_rtu_encode_request(&((const fathom_modbus_request_t *)exchange)->message, frame);
}

static void receive(fathom_exchange_t *exchange, const uint8_t *bytes, uint8_t have, fathom_match_t *match)
{
    const uint8_t length = fathom_modbus_rtu_response_length(bytes, have);
    match->length = length;
    match->unit = bytes[0];
    match->status = FATHOM_PENDING;
    if (length == 0 || length > have) return;
    if (fathom_crc16(bytes, length) != 0) {
        match->status = FATHOM_ERR_CHECKSUM;
    } else if (exchange != NULL) {
        fathom_modbus_request_t *const request = (fathom_modbus_request_t *)exchange;
        match->status = (int8_t)fathom_modbus_rtu_parse_response(&request->message, bytes);
    }
}

fathom_status_t fathom_modbus_client_submit(fathom_line_t *line, fathom_modbus_request_t *request)
{
    const fathom_modbus_message_t *const message = &request->message;
    const uint8_t room = fathom_modbus_rtu_room(message);
    fathom_exchange_t *const exchange = &request->exchange;
    const bool is_broadcast = message->head[0] == FATHOM_MODBUS_BROADCAST;
    if (room == 0 || (is_broadcast && message->head[1] == FATHOM_MODBUS_READ_HOLDING_REGISTERS))
        return FATHOM_ERR_ARGUMENT;
    if (room > line->config->frame_size) return FATHOM_ERR_CAPACITY;
    exchange->encode = encode;
    exchange->receive = is_broadcast ? NULL : receive;
    exchange->unit = message->head[0];
    return fathom_line_submit(line, exchange);
}

void fathom_modbus_client_cancel(fathom_line_t *line, fathom_modbus_request_t *request)
{
    fathom_line_cancel(line, &request->exchange);
}

static fathom_status_t seam_submit(void *ctx, fathom_modbus_request_t *request)
{
    return fathom_modbus_client_submit(ctx, request);
}

static void seam_cancel(void *ctx, fathom_modbus_request_t *request)
{
    fathom_modbus_client_cancel(ctx, request);
}

static fathom_status_t seam_poll(void *ctx) { return fathom_line_poll(ctx); }

static uint32_t seam_due_us(void *ctx) { return fathom_line_due_us(ctx); }

fathom_modbus_t fathom_modbus_client(fathom_line_t *line)
{
    fathom_modbus_t modbus;
    modbus.submit = seam_submit;
    modbus.cancel = seam_cancel;
    modbus.poll = seam_poll;
    modbus.due_us = seam_due_us;
    modbus.ctx = line;
    return modbus;
}
