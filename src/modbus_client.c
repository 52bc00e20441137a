/* SPDX-License-Identifier: MIT */
#include "fathom/modbus_client.h"

#include "fathom/crc16.h"
#include "modbus_client_inside.h"

uint8_t fathom_modbus_client_encode(const fathom_exchange_t *exchange, uint8_t *frame)
{
    return fathom_modbus_rtu_encode_request(&((const fathom_modbus_request_t *)exchange)->message, frame);
}

bool fathom_modbus_client_is_request(const fathom_exchange_t *exchange, const uint8_t *frame, uint8_t have)
{
    return fathom_modbus_rtu_is_request(&((const fathom_modbus_request_t *)exchange)->message, frame, have);
}

fathom_status_t fathom_modbus_client_answer(fathom_exchange_t *exchange, const uint8_t *frame)
{
    return fathom_modbus_rtu_parse_response(&((fathom_modbus_request_t *)exchange)->message, frame);
}

/* Zeros are what noise is made of: no frame of unit 0 is looked for. */
static uint8_t length(const uint8_t *frame, uint8_t have)
{
    return frame[0] != FATHOM_MODBUS_BROADCAST ? fathom_modbus_rtu_response_length(frame, have) : 0;
}

static const fathom_protocol_t protocol = {
    fathom_modbus_client_encode, length, fathom_crc16, fathom_modbus_client_is_request,
    fathom_modbus_client_answer, 0,      false};

fathom_status_t fathom_modbus_client_start(fathom_line_t *line, fathom_modbus_request_t *request,
                                           const fathom_protocol_t *with)
{
    const uint8_t room = fathom_modbus_rtu_room(&request->message);
    if (room == 0) return FATHOM_ERR_ARGUMENT;
    if (room > line->config->frame_size) return FATHOM_ERR_CAPACITY;
    request->exchange.protocol = with;
    request->exchange.unit = request->message.head[0];
    return fathom_line_submit(line, &request->exchange);
}

fathom_status_t fathom_modbus_client_submit(fathom_line_t *line, fathom_modbus_request_t *request)
{
    if (fathom_modbus_client_reads_0(request)) return FATHOM_ERR_UNSUPPORTED;
    return fathom_modbus_client_start(line, request, &protocol);
}

void fathom_modbus_client_cancel(fathom_line_t *line, fathom_modbus_request_t *request)
{
    fathom_line_cancel(line, &request->exchange);
}

static fathom_status_t seam_submit(void *ctx, fathom_modbus_request_t *request)
{
    return fathom_modbus_client_submit(ctx, request);
}

fathom_modbus_t fathom_modbus_client(fathom_line_t *line)
{
    return fathom_modbus_over_line(line, seam_submit);
}
