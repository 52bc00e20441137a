/* SPDX-License-Identifier: MIT */
#include "fathom/modbus_client.h"

#include <stdbool.h>

#include "fathom/crc16.h"

enum { LEAST_REQUEST = 8 };

/* The line's name of the unit 0 that answers, for which 0 means that none does. They owe alike (modulo 16). */
enum { ZERO = 240 };

/* What stands at the front: is it the request itself, or the beginning of it? An answer comes first: that to a
 * write of one register is the request again, that to a write of many begins like it. */
static void look_for_request(const fathom_modbus_message_t *message, const uint8_t *bytes, uint8_t have,
                             fathom_match_t *match)
{
    const uint8_t length = fathom_modbus_rtu_begun_request(message, bytes, have);
    if (length == 0) return;
    if (length > have) {
        match->length = length;
    } else if (fathom_crc16(bytes, length) == 0) {
        match->request = length;
    }
}

static fathom_modbus_message_t *message_of(fathom_exchange_t *exchange)
{
    return &((fathom_modbus_request_t *)exchange)->message;
}

/* An answer whose unit and function are right: does it begin as its request does? Whoever acknowledges a write of one
 * register sends it back. And the echo of a read of 0200 begins with a whole answer, CRC and all, if the unit is 83 or
 * 147. */
static bool begins_alike(const uint8_t *head, const uint8_t *bytes)
{
    return bytes[2] == head[2] && bytes[3] == head[3] && bytes[4] == head[4] && bytes[5] == head[5];
}

/* Frames of unit 0 are looked for where it has been asked, or all have, and nowhere else: zeros are what noise is made
 * of. */
static bool asks_zero(const fathom_exchange_t *exchange)
{
    return exchange != NULL && (exchange->unit == ZERO || exchange->unit == FATHOM_LINE_ANY_UNIT);
}

static void judge(fathom_exchange_t *exchange, const uint8_t *bytes, uint8_t have, fathom_match_t *match)
{
    const bool is_none = bytes[0] == FATHOM_MODBUS_BROADCAST && !asks_zero(exchange);
    const uint8_t length = is_none ? 0 : fathom_modbus_rtu_response_length(bytes, have);
    match->length = length;
    match->unit = bytes[0];
    /* Each is the other, so that unit 240 does not answer for 0. */
    if (exchange != NULL && message_of(exchange)->head[0] == 0 && (bytes[0] == 0 || bytes[0] == ZERO))
        match->unit ^= ZERO;
    match->status = FATHOM_ERR_CHECKSUM;
    match->request = 0;
    if (length != 0 && length <= have && fathom_crc16(bytes, length) == 0) {
        match->status = FATHOM_PENDING;
        if (exchange == NULL) return;
        fathom_modbus_message_t *const message = message_of(exchange);
        if (exchange->unit == FATHOM_LINE_ANY_UNIT) match->unit = FATHOM_LINE_ANY_UNIT;
        match->status = (int8_t)fathom_modbus_rtu_parse_response(message, bytes);
        if (match->status == FATHOM_READY && message->head[1] != FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS &&
            begins_alike(message->head, bytes))
            match->request = length;
    } else if (exchange != NULL && (length <= have || have >= LEAST_REQUEST)) {
        look_for_request(message_of(exchange), bytes, have, match);
    }
}

static void protocol(fathom_exchange_t *exchange, uint8_t *frame, uint8_t have, fathom_match_t *match)
{
    if (have != 0)
        judge(exchange, frame, have, match);
    else
        match->length =
            fathom_modbus_rtu_encode_request(&((const fathom_modbus_request_t *)exchange)->message, frame);
}

fathom_status_t fathom_modbus_client_submit(fathom_line_t *line, fathom_modbus_request_t *request)
{
    const fathom_modbus_message_t *const message = &request->message;
    const uint8_t room = fathom_modbus_rtu_room(message);
    fathom_exchange_t *const exchange = &request->exchange;
    const bool is_read = message->head[1] == FATHOM_MODBUS_READ_HOLDING_REGISTERS;
    if (room == 0) return FATHOM_ERR_ARGUMENT;
    if (room > line->config->frame_size) return FATHOM_ERR_CAPACITY;
    exchange->protocol = protocol;
    exchange->unit = message->head[0] == FATHOM_MODBUS_BROADCAST && is_read ? ZERO : message->head[0];
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

fathom_modbus_t fathom_modbus_client(fathom_line_t *line)
{
    return fathom_modbus_over_line(line, seam_submit);
}
