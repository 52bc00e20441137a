/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "commands/request/request.h"
#include "fathom/codec/crc16.h"
#include "fathom/codec/modbus_rtu.h"
#include "ports/port_options.h"

enum { FUNCTION = 1, SIZE = 2, FIRST = 2, COUNT = 5 };
enum { LEAST_LENGTH = 4, MAX_LENGTH = 255, EXCEPTION_LENGTH = 5, READ_OVERHEAD = 5, WRITE_LENGTH = 8 };
enum { MAX_SIZE = 250 };
enum { READ_COILS = 1, READ_DISCRETE_INPUTS = 2, WRITE_COIL = 5, WRITE_COILS = 15 };

static const request_t *request_of(const fathom_transaction_t *transaction)
{
    return ((const request_ask_t *)transaction)->request;
}

static uint8_t encode(const fathom_transaction_t *transaction, uint8_t *frame)
{
    const request_t *const request = request_of(transaction);
    memcpy(frame, request->frame, request->length);
    return request->length;
}

static bool is_request(const fathom_transaction_t *transaction, const uint8_t *frame, uint8_t have)
{
    const request_t *const request = request_of(transaction);
    return memcmp(frame, request->frame, have < request->length ? have : request->length) == 0;
}

/* ---- how long a response is ---- */

static bool reads(uint8_t function) { return function >= READ_COILS && function <= REQUEST_READ_INPUT; }

/* Returns true if the first bytes of a response state its length (MODBUS Application Protocol V1.1b3, 6). */
static bool has_known_length(uint8_t function)
{
    return reads(function) || function == WRITE_COIL || function == REQUEST_WRITE ||
           function == WRITE_COILS || function == REQUEST_WRITE_MANY;
}

static uint8_t known_length_with_zero(const uint8_t *frame, uint8_t have)
{
    if (have <= SIZE) return SIZE + 1;
    const uint8_t function = frame[FUNCTION] & (uint8_t)~FATHOM_MODBUS_EXCEPTION;
    if (!has_known_length(function)) return 0;
    if (function != frame[FUNCTION]) return EXCEPTION_LENGTH;
    if (!reads(function)) return WRITE_LENGTH;
    const uint8_t size = frame[SIZE];
    return size >= 1 && size <= MAX_SIZE ? (uint8_t)(size + READ_OVERHEAD) : 0;
}

/* A response of another function ends where its CRC is right. */
static uint8_t any_length_with_zero(const uint8_t *frame, uint8_t have)
{
    for (uint8_t length = LEAST_LENGTH; length <= have && length != 0; length++)
        if (fathom_crc16(frame, length) == 0) return length;
    if (have < LEAST_LENGTH) return LEAST_LENGTH;
    return have < MAX_LENGTH ? (uint8_t)(have + 1) : 0;
}

/* Noise has many zeros, so a frame from unit 0 counts only if unit 0 may respond. */
static uint8_t known_length(const uint8_t *frame, uint8_t have)
{
    return frame[0] != 0 ? known_length_with_zero(frame, have) : 0;
}

static uint8_t any_length(const uint8_t *frame, uint8_t have)
{
    return frame[0] != 0 ? any_length_with_zero(frame, have) : 0;
}

/* ---- is it the response? ---- */

static bool fits(const request_t *request, const uint8_t *frame)
{
    const uint8_t *const asked = request->frame;
    const uint8_t function = asked[FUNCTION];
    if (!has_known_length(function)) return true;
    if (!reads(function)) return memcmp(frame + FIRST, asked + FIRST, WRITE_LENGTH - 2 - FIRST) == 0;
    if (function >= REQUEST_READ) return frame[SIZE] == 2 * asked[COUNT];
    /* A byte has eight coils. The user may have entered other bytes than those of a request for coils. */
    return request->length != WRITE_LENGTH || frame[SIZE] == (request_word(request, REQUEST_COUNT) + 7u) / 8u;
}

static fathom_status_t parse_response(fathom_transaction_t *transaction, const uint8_t *frame)
{
    request_ask_t *const ask = (request_ask_t *)transaction;
    const uint8_t *const asked = ask->request->frame;
    const bool is_exception = frame[FUNCTION] == (asked[FUNCTION] | FATHOM_MODBUS_EXCEPTION);
    if (!is_exception && (frame[FUNCTION] != asked[FUNCTION] || !fits(ask->request, frame)))
        return FATHOM_ERR_MALFORMED;
    ask->length = transaction->protocol->length(frame, MAX_LENGTH);
    memcpy(ask->response, frame, ask->length);
    return is_exception ? FATHOM_ERR_EXCEPTION : FATHOM_OK;
}

static bool may_collide(const fathom_transaction_t *transaction)
{
    return request_may_collide(request_of(transaction));
}

#define PROTOCOL(length_of, with_zero)                                                                       \
    {                                                                                                        \
        .encode = encode, .length = (length_of), .check = fathom_crc16, .is_request = is_request,            \
        .parse_response = parse_response, .may_collide = may_collide, .is_unit_0_ordinary = (with_zero)      \
    }

static const fathom_protocol_t *protocol_of(const request_t *request)
{
    /* by whether the length of the response is known, and whether unit 0 may respond */
    static const fathom_protocol_t protocols[2][2] = {
        {PROTOCOL(any_length, false), PROTOCOL(any_length_with_zero, true)},
        {PROTOCOL(known_length, false), PROTOCOL(known_length_with_zero, true)}};
    const uint8_t unit = request->frame[REQUEST_UNIT];
    const bool has_zero =
        unit == FATHOM_MODBUS_ANY_UNIT || (unit == FATHOM_MODBUS_BROADCAST && !request_is_broadcast(request));
    return &protocols[has_known_length(request->frame[REQUEST_FUNCTION])][has_zero];
}

/* ---- its outcome ---- */

/*
 * Judges one copy of a request whose acknowledgement equals it, on a line that may echo. An acknowledgement on a wire
 * ends after the request, a silence of 3.5 characters and its own characters; an echo arrives at the latest when the
 * adapter releases it.
 */
static request_outcome_t judge_copy(const request_ask_t *ask, const port_t *port)
{
    const request_t *const request = ask->request;
    const uint64_t bits = fathom_character_bits(&request->line);
    const uint64_t wire_us = request->length * bits * 1000000u / request->line.baud;
    const uint64_t silence_us = FATHOM_T3_5_US(request->line.baud, bits);
    const uint64_t took_us = ask->evidence.slowest_us;
    if (ask->evidence.echoes != 1 || ask->evidence.rest != 0) return REQUEST_NO_RESPONSE;
    if (took_us > wire_us + PORT_RESPONSE_GAP_US) return REQUEST_ANSWERED;
    if (port->has_wire && took_us < 2 * wire_us + silence_us) return REQUEST_NO_RESPONSE;
    return REQUEST_ECHO;
}

/* Returns true if the acknowledgement equals the request. That may also be so with functions that are not known. */
static bool equals_acknowledgement(const request_t *request)
{
    const uint8_t function = request->frame[REQUEST_FUNCTION];
    return !request_is_read(request) && function != WRITE_COILS && function != REQUEST_WRITE_MANY;
}

const struct request_outcome_row request_outcomes[REQUEST_OUTCOMES] = {
    [REQUEST_ANSWERED] = {"answered", FATHOM_OK},
    [REQUEST_SENT] = {"sent", FATHOM_OK},
    [REQUEST_ECHO] = {"answered_or_echo", FATHOM_ERR_ECHO},
    [REQUEST_REFUSED] = {"exception", FATHOM_ERR_EXCEPTION},
    [REQUEST_UNEXPECTED] = {"other_response", FATHOM_ERR_MALFORMED},
    [REQUEST_DAMAGED] = {"damaged", FATHOM_ERR_CHECKSUM},
    [REQUEST_NO_RESPONSE] = {"no_response", FATHOM_ERR_NO_RESPONSE},
    [REQUEST_LINE_BUSY] = {"line_busy", FATHOM_ERR_LINE_BUSY},
    [REQUEST_OTHER_MASTER] = {"other_master", FATHOM_ERR_OTHER_MASTER},
    [REQUEST_FAILED] = {"failed", FATHOM_ERR_PORT},
};

static request_outcome_t outcome_of(const request_ask_t *ask, const port_t *port, fathom_status_t status)
{
    request_outcome_t outcome = REQUEST_ANSWERED;
    if (status == FATHOM_OK && request_is_broadcast(ask->request)) return REQUEST_SENT;
    if (status == FATHOM_ERR_ECHO)
        return equals_acknowledgement(ask->request) ? judge_copy(ask, port) : REQUEST_NO_RESPONSE;
    while (outcome != REQUEST_FAILED && request_outcomes[outcome].status != status) outcome++;
    return outcome;
}

/* Counts the bytes that belong neither to the response nor to the echo, such as those of another unit with the same
 * address. */
static uint32_t count_more(const request_ask_t *ask, const port_t *port)
{
    const uint32_t echo = fathom_line_get_echo(&port->line) == FATHOM_LINE_ECHO_ON ? ask->request->length : 0;
    const uint32_t known = ask->length + echo;
    return ask->length != 0 && ask->evidence.bytes > known ? ask->evidence.bytes - known : 0;
}

void request_ask(request_ask_t *ask, const request_t *request, port_t *port)
{
    memset(ask, 0, sizeof *ask);
    ask->request = request;
    ask->transaction.protocol = protocol_of(request);
    ask->transaction.address = request->frame[REQUEST_UNIT];
    ask->transaction.timeout_us = request->timeout_us;
    if (port->kind == PORT_SERIAL) port_listen(port, PORT_LISTEN_US);
    listener_forget(&port->listener);
    fathom_status_t status = fathom_line_submit(&port->line, &ask->transaction);
    if (status == FATHOM_PENDING) status = port_finish(port, &ask->transaction);
    if (ask->length != 0 && port->kind == PORT_SERIAL) port_listen(port, PORT_RESPONSE_GAP_US);
    listener_judge(&port->listener, request->frame[REQUEST_UNIT], &ask->evidence);
    ask->outcome = outcome_of(ask, port, status);
    ask->more = count_more(ask, port);
    if (ask->outcome != REQUEST_ANSWERED || ask->length != 0) return;
    memcpy(ask->response, request->frame, request->length); /* the copy, which is no echo */
    ask->length = request->length;
}
