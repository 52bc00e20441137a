/* SPDX-License-Identifier: MIT */
#include "ports/listener.h"

#include <string.h>

#include "fathom/codec/crc16.h"
#include "fathom/codec/dyp_55aa.h"
#include "fathom/codec/dyp_stream.h"
#include "fathom/codec/modbus_rtu.h"

static uint32_t now_us(const listener_t *listener) { return listener->clock.now_us(listener->clock.ctx); }

static int listener_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    const listener_t *const tap = ctx;
    listener_t *const listener = tap->now != NULL ? tap->now : ctx;
    const int n = tap->inner.read(tap->inner.ctx, bytes, capacity, rx);
    if (n <= 0) return n;
    const size_t space = sizeof listener->window - listener->have;
    const size_t kept = (size_t)n < space ? (size_t)n : space;
    memcpy(listener->window + listener->have, bytes, kept);
    listener->have = (uint16_t)(listener->have + kept);
    listener->bytes += (uint32_t)n;
    const uint32_t took_us = fathom_elapsed_us(now_us(tap), listener->asked_us);
    if (listener->request_length != 0 && took_us > listener->slowest_us) listener->slowest_us = took_us;
    return n;
}

static int listener_write(void *ctx, const uint8_t *bytes, size_t length)
{
    listener_t *const tap = ctx;
    const uint32_t asked_us = now_us(tap); /* a response may be there before the write returns */
    const int n = tap->inner.write(tap->inner.ctx, bytes, length);
    if (n <= 0 || length > sizeof tap->request) return n;
    if (tap->whose != NULL) tap->now = tap->whose(tap->ctx);
    listener_t *const listener = tap->now != NULL ? tap->now : tap;
    memcpy(listener->request, bytes, length);
    listener->request_length = (uint8_t)length;
    listener->asked_us = asked_us;
    listener->requests++;
    return n;
}

static bool listener_sent(void *ctx)
{
    listener_t *const listener = ctx;
    return listener->inner.sent(listener->inner.ctx);
}

static int listener_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    listener_t *const listener = ctx;
    return listener->inner.set_line(listener->inner.ctx, settings);
}

static int listener_set_break(void *ctx, bool on)
{
    listener_t *const listener = ctx;
    return listener->inner.set_break(listener->inner.ctx, on);
}

static uint32_t listener_leaves_in_us(void *ctx)
{
    listener_t *const listener = ctx;
    return listener->inner.leaves_in_us(listener->inner.ctx);
}

void listener_begin(listener_t *listener, fathom_uart_t *uart, const fathom_clock_t *clock)
{
    listener->inner = *uart;
    listener->clock = *clock;
    listener->now = NULL;
    listener->request_length = 0;
    listener_forget(listener);
    uart->read = listener_read;
    uart->write = listener_write;
    uart->sent = listener_sent;
    if (uart->set_line != NULL) uart->set_line = listener_set_line;
    if (uart->set_break != NULL) uart->set_break = listener_set_break;
    if (uart->leaves_in_us != NULL) uart->leaves_in_us = listener_leaves_in_us;
    uart->ctx = listener;
}

void listener_forget(listener_t *listener)
{
    listener->have = 0;
    listener->bytes = 0;
    listener->slowest_us = 0;
}

/* Returns the length of the frame at the front if it is whole and its CRC is right, else 0. */
static uint8_t whole(const uint8_t *bytes, uint8_t have, uint8_t length)
{
    return length != 0 && length <= have && fathom_crc16(bytes, length) == 0 ? length : 0;
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

static void note_response(evidence_t *evidence, uint8_t from, uint8_t address)
{
    if (from == address)
        evidence->own++;
    else if (evidence->foreign++ == 0)
        evidence->foreign_address = from;
}

static void note_request(evidence_t *evidence, uint8_t to)
{
    if (evidence->masters++ == 0) evidence->masters_address = to;
}

static bool is_fitting(const listener_t *listener, const uint8_t *response, uint8_t length)
{
    enum { FUNCTION = 1, COUNT = 5, READ_REQUEST = 8, READ_RESPONSE = 5 };
    return response[FUNCTION] != FATHOM_MODBUS_READ_HOLDING_REGISTERS ||
           listener->request_length != READ_REQUEST || length == READ_RESPONSE + 2 * listener->request[COUNT];
}

/* As account(), for the frames 55 AA. A request of another master has the length and the sum of a request, and the
 * command of a measurement. */
static uint8_t account_dyp(const uint8_t *bytes, uint8_t have, uint8_t address, evidence_t *evidence)
{
    enum { ADDRESS = 2, COMMAND = 3 };
    const uint8_t length = fathom_dyp_55aa_frame_length(bytes, have);
    if (length == 0 || have < FATHOM_DYP_REQUEST_LENGTH) return 0;
    if (length <= have && fathom_dyp_55aa_is_valid(bytes, length)) {
        note_response(evidence, bytes[ADDRESS], address);
        return length;
    }
    if (fathom_dyp_55aa_value_count(bytes[COMMAND]) == 0 ||
        !fathom_dyp_55aa_is_valid(bytes, FATHOM_DYP_REQUEST_LENGTH))
        return 0;
    note_request(evidence, bytes[ADDRESS]);
    return FATHOM_DYP_REQUEST_LENGTH;
}

/* Counts the frame or echo that begins at this place of the window. Returns its length, 0 if there is none. */
static uint16_t account(const listener_t *listener, uint16_t at, uint8_t address, evidence_t *evidence)
{
    const uint8_t *const bytes = listener->window + at;
    const unsigned left = (unsigned)listener->have - at;
    const uint8_t have = left < UINT8_MAX ? (uint8_t)left : UINT8_MAX;
    if (listener->request_length != 0 && have >= listener->request_length &&
        memcmp(bytes, listener->request, listener->request_length) == 0) {
        evidence->echoes++;
        return listener->request_length;
    }
    uint8_t length = fathom_modbus_rtu_response_length(bytes, have);
    length = bytes[0] == 0 && address != 0 ? 0 : whole(bytes, have, length);
    if (length != 0) {
        note_response(evidence, bytes[0], address);
        if (bytes[0] == address && is_fitting(listener, bytes, length)) evidence->fitting++;
        return length;
    }
    length = whole(bytes, have, fathom_modbus_rtu_request_length(bytes, have));
    if (length != 0) {
        note_request(evidence, bytes[0]);
        return length;
    }
    length = account_dyp(bytes, have, address, evidence);
    if (length != 0) return length;
    const uint16_t a05 = streamed(listener, at, FATHOM_DYP_A05_LENGTH, &evidence->streamed_a05);
    return a05 != 0 ? a05 : streamed(listener, at, FATHOM_DYP_A16_LENGTH, &evidence->streamed_a16);
}

void listener_judge(const listener_t *listener, uint8_t address, evidence_t *evidence)
{
    memset(evidence, 0, sizeof *evidence);
    evidence->bytes = listener->bytes;
    evidence->slowest_us = listener->slowest_us;
    for (uint16_t at = 0; at < listener->have;) {
        const uint16_t length = account(listener, at, address, evidence);
        if (length == 0) evidence->rest++;
        at = (uint16_t)(at + (length != 0 ? length : 1));
    }
}
