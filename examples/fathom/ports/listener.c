/* SPDX-License-Identifier: MIT */
#include "ports/port.h"

#include <string.h>

#include "fathom/codec/crc16.h"
#include "fathom/codec/dyp_55aa.h"
#include "fathom/codec/dyp_stream.h"
#include "fathom/codec/modbus_rtu.h"
#include "fathom/hal.h"

/* Returns the bytes of a response that broke off at the end of the window: behind an echo, of the unit and the function of
 * the request. */
static uint16_t part_of(const listener_t *listener)
{
    const uint8_t *bytes = listener->window;
    uint16_t have = listener->have;
    const uint8_t request = listener->request_length;
    if (request != 0 && have >= request && memcmp(bytes, listener->request, request) == 0) {
        bytes += request;
        have = (uint16_t)(have - request);
    }
    if (have < 2 || have > sizeof listener->piece || bytes[0] != listener->request[0] ||
        (bytes[1] & 0x7F) != listener->request[1])
        return 0;
    return fathom_modbus_rtu_response_length(bytes, (uint8_t)have) > have ? have : 0;
}

/* Is this the rest of the response that broke off? */
static void take_piece(listener_t *listener, const uint8_t *bytes, uint32_t count, uint32_t now_us)
{
    uint8_t *const piece = listener->piece;
    const uint8_t have = listener->piece_length;
    if (have == 0) return;
    if (count > sizeof listener->piece - have) count = (uint32_t)sizeof listener->piece - have;
    memcpy(piece + have, bytes, count);
    listener->piece_length = (uint8_t)(have + count);
    const uint8_t length = fathom_modbus_rtu_response_length(piece, listener->piece_length);
    if (length > listener->piece_length) return;
    listener->piece_length = 0;
    if (length != 0 && fathom_crc16(piece, length) == 0)
        listener->pieces_us = fathom_elapsed_us(now_us, listener->last_us);
}

void listener_forget(listener_t *listener)
{
    listener->pieces_us = 0;
    listener->piece_length = (uint8_t)part_of(listener);
    memcpy(listener->piece, listener->window + listener->have - listener->piece_length,
           listener->piece_length);
    listener->have = 0;
    listener->bytes = 0;
    listener->slowest_us = 0;
    listener->has_asked = false;
}

void listener_sent(listener_t *listener, const uint8_t *request, uint8_t length, uint32_t now_us)
{
    memcpy(listener->request, request, length);
    listener->request_length = length;
    listener->piece_length = 0;
    listener->asked_us = now_us;
    if (!listener->has_asked && !listener->is_word_late) listener->word = 0;
    if (!listener->has_asked) listener->is_word_late = false;
    listener->has_asked = true;
    listener->requests++;
}

void listener_word(listener_t *listener, uint8_t exception)
{
    listener->word = exception;
    listener->is_word_late = !listener->has_asked;
}

void listener_received(listener_t *listener, const uint8_t *bytes, uint32_t count, uint32_t now_us)
{
    const uint32_t space = (uint32_t)sizeof listener->window - listener->have;
    const uint32_t kept = count < space ? count : space;
    const uint32_t took_us = fathom_elapsed_us(now_us, listener->asked_us);
    take_piece(listener, bytes, count, now_us);
    listener->last_us = now_us;
    memcpy(listener->window + listener->have, bytes, kept);
    listener->have = (uint16_t)(listener->have + kept);
    listener->bytes += count;
    if (listener->request_length != 0 && took_us > listener->slowest_us) listener->slowest_us = took_us;
}

/* Returns the bytes of at least two frames FF..SUM of this length in a row, else 0. A single one may be chance. */
static uint16_t streamed(const listener_t *listener, uint16_t at, uint8_t length, uint32_t *frames)
{
    uint16_t end = at;
    uint32_t in_a_row = 0;
    while (listener->have - end >= length && listener->window[end] == FATHOM_DYP_START &&
           fathom_dyp_stream_is_valid(listener->window + end, length)) {
        end = (uint16_t)(end + length);
        in_a_row++;
    }
    if (in_a_row < 2) return 0;
    *frames += in_a_row;
    return (uint16_t)(end - at);
}

static void note(uint32_t *count, uint8_t *first, uint8_t address)
{
    if ((*count)++ == 0) *first = address;
}

/* Returns true if the length of a response of the unit of the request fits the request. */
static bool is_fitting(const listener_t *listener, const uint8_t *response, uint8_t length)
{
    enum { FUNCTION = 1, COUNT = 5, READ_REQUEST = 8, READ_RESPONSE = 5 };
    return response[FUNCTION] != FATHOM_MODBUS_READ_HOLDING_REGISTERS ||
           listener->request_length != READ_REQUEST || length == READ_RESPONSE + 2 * listener->request[COUNT];
}

static void note_response(evidence_t *evidence, uint8_t from, uint8_t address)
{
    if (from == address)
        evidence->own++;
    else
        note(&evidence->foreign, &evidence->foreign_address, from);
}

static bool has_crc(const uint8_t *bytes, uint8_t have, uint8_t length)
{
    return length != 0 && length <= have && fathom_crc16(bytes, length) == 0;
}

/* Counts the Modbus or 55 AA frame at the front. Returns its length, 0 if there is none. A request of another master 55
 * AA has the length and the sum of a request, and the command of a measurement. */
static uint8_t account_frame(const listener_t *listener, const uint8_t *bytes, uint8_t have, uint8_t address,
                             evidence_t *evidence)
{
    enum { ADDRESS = 2, COMMAND = 3 };
    uint8_t length = fathom_modbus_rtu_response_length(bytes, have);
    if ((bytes[0] != 0 || address == 0) && has_crc(bytes, have, length)) {
        note_response(evidence, bytes[0], address);
        if (bytes[0] == address && is_fitting(listener, bytes, length)) evidence->fitting++;
        return length;
    }
    length = fathom_modbus_rtu_request_length(bytes, have);
    if (has_crc(bytes, have, length)) {
        note(&evidence->masters, &evidence->masters_address, bytes[0]);
        return length;
    }
    length = fathom_dyp_55aa_frame_length(bytes, have);
    if (length == 0 || have < FATHOM_DYP_REQUEST_LENGTH) return 0;
    if (length <= have && fathom_dyp_55aa_is_valid(bytes, length)) {
        note_response(evidence, bytes[ADDRESS], address);
        return length;
    }
    if (fathom_dyp_55aa_value_count(bytes[COMMAND]) == 0 ||
        !fathom_dyp_55aa_is_valid(bytes, FATHOM_DYP_REQUEST_LENGTH))
        return 0;
    note(&evidence->masters, &evidence->masters_address, bytes[ADDRESS]);
    return FATHOM_DYP_REQUEST_LENGTH;
}

/* Counts the frames or the echo at this place of the window. Returns their length, 0 if there are none. */
static uint16_t account(const listener_t *listener, uint16_t at, uint8_t address, evidence_t *evidence)
{
    const uint8_t *const bytes = listener->window + at;
    const unsigned left = (unsigned)listener->have - at;
    const uint8_t have = left < UINT8_MAX ? (uint8_t)left : UINT8_MAX;
    uint16_t length = listener->request_length;
    if (length != 0 && have >= length && memcmp(bytes, listener->request, length) == 0) {
        evidence->echoes++;
        return length;
    }
    length = account_frame(listener, bytes, have, address, evidence);
    if (length == 0) length = streamed(listener, at, FATHOM_DYP_A05_LENGTH, &evidence->streamed_a05);
    return length != 0 ? length : streamed(listener, at, FATHOM_DYP_A16_LENGTH, &evidence->streamed_a16);
}

/* Returns true if the first byte of a frame stands where it can have stood: damage begins behind it. */
static bool has_start(const uint8_t *head, size_t length, const uint8_t *window, size_t at)
{
    size_t whole = 0; /* bytes of the head that stand before the tail */
    while (whole < length && whole < at && window[at - whole - 1] == head[length - whole - 1]) whole++;
    for (size_t back = whole + 1; back <= length && back <= at; back++)
        if (window[at - back] == head[0]) return true;
    return false;
}

/* Returns true if bytes of the window are the values and the CRC of the response: the CRC fits them behind the three bytes
 * that the request makes certain, and the first of these three is missing or wrong. 55 AA has a sum of one byte, so the
 * values must be the last bytes. */
static bool has_tail(const listener_t *listener)
{
    enum {
        FUNCTION = 1,
        COUNT = 5,
        COMMAND = 3,
        READ_INPUT = 4,
        READ_REQUEST = 8,
        MODBUS_HEAD = 3,
        CRC = 2,
        DYP_HEAD = 4
    };
    const uint8_t *const request = listener->request;
    uint8_t frame[UINT8_MAX] = {request[0], request[FUNCTION], (uint8_t)(2 * request[COUNT])};
    const bool is_dyp = listener->request_length == FATHOM_DYP_REQUEST_LENGTH;
    const bool is_read =
        listener->request_length == READ_REQUEST &&
        (request[FUNCTION] == FATHOM_MODBUS_READ_HOLDING_REGISTERS || request[FUNCTION] == READ_INPUT);
    const size_t head = is_dyp ? DYP_HEAD : MODBUS_HEAD;
    const size_t length = is_dyp    ? fathom_dyp_55aa_response_length(request[COMMAND])
                          : is_read ? head + frame[2] + CRC
                                    : 0;
    if (is_dyp) memcpy(frame, request, head);
    if (length <= head || length > sizeof frame) return false;
    const size_t tail = length - head;
    for (size_t at = is_dyp && listener->have > tail ? listener->have - tail : 0; at + tail <= listener->have;
         at++) {
        memcpy(frame + head, listener->window + at, tail);
        const bool is_whole = is_dyp ? fathom_dyp_55aa_is_valid(frame, (uint8_t)length)
                                     : fathom_crc16(frame, (uint8_t)length) == 0;
        if (is_whole && !has_start(frame, head, listener->window, at)) return true;
    }
    return false;
}

/* Returns true if the window begins with a header of Modbus TCP: a transaction, protocol 0 or that of the request (the
 * server took RTU for a header), and the length of what follows. */
static bool is_mbap(const listener_t *listener)
{
    enum { PROTOCOL = 2, LENGTH = 4, HEADER = 6, LEAST = 3 };
    const uint8_t *const bytes = listener->window;
    const unsigned length = (unsigned)bytes[LENGTH] << 8 | bytes[LENGTH + 1];
    if (listener->have < HEADER + LEAST || length < LEAST || listener->have != HEADER + length) return false;
    return (bytes[PROTOCOL] == 0 && bytes[PROTOCOL + 1] == 0) ||
           memcmp(bytes, listener->request, LENGTH) == 0;
}

void listener_judge(const listener_t *listener, uint8_t address, evidence_t *evidence)
{
    memset(evidence, 0, sizeof *evidence);
    evidence->bytes = listener->bytes;
    evidence->slowest_us = listener->slowest_us;
    evidence->is_mbap = is_mbap(listener);
    evidence->word = listener->word;
    evidence->is_zeros = listener->have != 0;
    for (uint16_t at = 0; at != listener->have; at++)
        if (listener->window[at] != 0) evidence->is_zeros = false;
    evidence->part = part_of(listener);
    evidence->pieces_us = listener->pieces_us;
    for (uint16_t at = 0; at < listener->have;) {
        const uint16_t length = account(listener, at, address, evidence);
        if (length == 0) evidence->rest++;
        at = (uint16_t)(at + (length != 0 ? length : 1));
    }
    evidence->headless = address != 0 && evidence->rest != 0 && evidence->own == 0 && has_tail(listener);
}
