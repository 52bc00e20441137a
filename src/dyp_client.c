/* SPDX-License-Identifier: MIT */
#include "fathom/dyp_client.h"

#include "fathom/dyp_frame.h"
#include "fathom/dyp_protocol.h"

/* Offsets in a frame; behind an echo the answer stands at NEXT. */
enum { ADDRESS = 2, COMMAND = 3, NEXT = FATHOM_DYP_REQUEST_LENGTH };

enum { ADDRESS_REGISTER = 0x0200 };

/* The command for a read; 0: there is none. */
static uint8_t command_of_read(const uint8_t *head)
{
    const uint8_t count = head[5];
    const uint16_t probe = (uint16_t)(head[2] * 256u + head[3] - FATHOM_DYP_FIRST_REGISTER);
    if (head[4] != 0 || probe >= FATHOM_DYP_PROBES) return 0;
    if (count == 1) return (uint8_t)(FATHOM_DYP_FIRST_PROBE + probe);
    return count == FATHOM_DYP_PROBES && probe == 0 ? FATHOM_DYP_ALL_PROBES : 0;
}

static uint8_t command_of(const uint8_t *head)
{
    return head[1] == FATHOM_MODBUS_READ_HOLDING_REGISTERS ? command_of_read(head) : FATHOM_DYP_SET_ADDRESS;
}

/*
 * With a probe in the right place an answer begins with the same five bytes as its request (1H is the request's
 * sum). If 55 AA follows these, they are the echo and the answer comes: as distances it would be 43520 mm or more
 * for the second probe, which no A05 measures.
 */
static bool is_two_frames(const uint8_t *frame)
{
    return frame[NEXT] == frame[0] && frame[NEXT + 1] == frame[1];
}

/* A frame with a right sum: does it answer? */
static int8_t answer(fathom_modbus_request_t *request, const uint8_t *frame, uint8_t unit)
{
    fathom_modbus_message_t *const message = &request->message;
    if (unit != request->exchange.unit) return FATHOM_PENDING;
    if (frame[COMMAND] != command_of(message->head)) return FATHOM_ERR_MALFORMED;
    fathom_dyp_protocol_decode(frame, message->values);
    message->head[0] = frame[ADDRESS];
    return FATHOM_READY;
}

static void judge(fathom_exchange_t *exchange, const uint8_t *frame, uint8_t have, fathom_match_t *match)
{
    fathom_modbus_request_t *const request = (fathom_modbus_request_t *)exchange;
    const uint8_t length = fathom_dyp_protocol_length(frame, have);
    match->length = length;
    match->unit = frame[ADDRESS < have ? ADDRESS : 0];
    match->status = FATHOM_ERR_CHECKSUM;
    match->request = 0;
    if (exchange != NULL) {
        const uint8_t *const head = request->message.head;
        if (exchange->unit == FATHOM_LINE_ANY_UNIT) match->unit = FATHOM_LINE_ANY_UNIT;
        if (have >= FATHOM_DYP_REQUEST_LENGTH && frame[ADDRESS] == head[0] &&
            frame[COMMAND] == command_of(head) && fathom_dyp_protocol_valid(frame, FATHOM_DYP_REQUEST_LENGTH))
            match->request = FATHOM_DYP_REQUEST_LENGTH;
    }
    if (length == 0 || length > have || !fathom_dyp_protocol_valid(frame, length)) return;
    if (match->request != 0 && length == FATHOM_DYP_MAX_ANSWER && is_two_frames(frame)) return;
    match->status = exchange != NULL ? answer(request, frame, match->unit) : (int8_t)FATHOM_PENDING;
}

static void protocol(fathom_exchange_t *exchange, uint8_t *frame, uint8_t have, fathom_match_t *match)
{
    if (have != 0) {
        judge(exchange, frame, have, match);
        return;
    }
    const uint8_t *const head = ((const fathom_modbus_request_t *)exchange)->message.head;
    match->length = fathom_dyp_protocol_encode_request(frame, head[0], command_of(head));
}

static fathom_status_t start(fathom_line_t *line, fathom_modbus_request_t *request)
{
    if (line->config->frame_size < FATHOM_DYP_MAX_ANSWER) return FATHOM_ERR_CAPACITY;
    request->exchange.protocol = protocol;
    request->exchange.unit = request->message.head[0];
    return fathom_line_submit(line, &request->exchange);
}

fathom_status_t fathom_dyp_client_submit(fathom_line_t *line, fathom_modbus_request_t *request)
{
    const uint8_t *const head = request->message.head;
    if (head[1] != FATHOM_MODBUS_READ_HOLDING_REGISTERS || command_of_read(head) == 0)
        return FATHOM_ERR_UNSUPPORTED;
    return head[0] != FATHOM_LINE_ALL_UNITS ? start(line, request) : FATHOM_ERR_ARGUMENT;
}

fathom_status_t fathom_dyp_client_set_every_address(fathom_line_t *line, fathom_modbus_request_t *request,
                                                    uint8_t address)
{
    if (address == FATHOM_LINE_ALL_UNITS || address == FATHOM_LINE_ANY_UNIT) return FATHOM_ERR_ARGUMENT;
    if (fathom_line_has(line, &request->exchange)) return FATHOM_ERR_BUSY;
    fathom_modbus_write_single_register(&request->message, address, ADDRESS_REGISTER, address);
    return start(line, request);
}

static fathom_status_t seam_submit(void *ctx, fathom_modbus_request_t *request)
{
    return fathom_dyp_client_submit(ctx, request);
}

fathom_modbus_t fathom_dyp_client(fathom_line_t *line) { return fathom_modbus_over_line(line, seam_submit); }
