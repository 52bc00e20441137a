/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>

#include "commands/decode/decode.h"
#include "fathom/codec/crc16.h"
#include "fathom/codec/dyp_55aa.h"
#include "fathom/codec/dyp_stream.h"
#include "fathom/codec/modbus_rtu.h"

/*
 * The price of each piece; the cheapest way through the input is taken. A damaged frame is dearer than the good
 * ones that its bytes could be instead, so it has a price a byte, and cheaper than bytes of no frame. Frames
 * seldom go across the end of a line.
 */
enum {
    COST_MODBUS = 1,
    COST_LONG_SUM = 2,
    COST_SHORT_SUM = 3,
    COST_LINE = 1,
    COST_DAMAGED = 10,
    COST_DAMAGED_STREAM = 12,
    COST_DAMAGED_BYTE = 1,
    COST_DAMAGED_LINE = 12,
    COST_BYTE = 5
};

typedef struct decode_choice {
    uint32_t cost; /* from here to the end */
    uint8_t length;
    uint8_t protocol;
    uint8_t direction;
    bool is_damaged;
    bool has_crc; /* a frame with a right CRC begins here, chosen or not */
} choice_t;

/* What is looked at: the input from one byte on. */
typedef struct {
    const uint8_t *bytes;
    const bool *line_starts;
    size_t left;
    uint8_t have; /* the same, up to 255 */
    choice_t *choices;
} view_t;

static uint32_t lines_crossed(const view_t *view, uint8_t length)
{
    uint32_t lines = 0;
    for (uint8_t i = 1; i < length; i++)
        if (view->line_starts[i]) lines++;
    return lines;
}

/* A right CRC of 16 bits is hardly chance: nothing that is less sure goes over the beginning of such a frame. */
static bool hides_frame(const view_t *view, uint8_t length)
{
    for (uint8_t i = 1; i < length; i++)
        if (view->choices[i].has_crc) return true;
    return false;
}

static void offer(view_t *view, uint8_t length, uint8_t protocol, uint8_t direction, bool is_good,
                  uint32_t cost)
{
    choice_t *const choice = view->choices;
    const bool is_sure = is_good && protocol == DECODE_MODBUS;
    if (length == 0 || length > view->left || (!is_sure && hides_frame(view, length))) return;
    choice->has_crc = choice->has_crc || is_sure;
    uint32_t all = cost + choice[length].cost;
    all += lines_crossed(view, length) * (is_good ? COST_LINE : COST_DAMAGED_LINE);
    if (!is_good) all += length * (uint32_t)COST_DAMAGED_BYTE;
    if (all > choice->cost) return;
    *choice = (choice_t){all, length, protocol, direction, !is_good, choice->has_crc};
}

/* ---- Modbus ---- */

static bool is_ours(uint8_t function)
{
    return function == FATHOM_MODBUS_READ_HOLDING_REGISTERS ||
           function == FATHOM_MODBUS_WRITE_SINGLE_REGISTER ||
           function == FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS;
}

/* With a wrong CRC only what these sensors could send passes for a frame; else noise would be full of them. */
enum { MOST_REGISTERS = DECODE_MAX_REGISTERS, LAST_PAGE = DECODE_MAX_ADDRESS >> 8 };

static bool is_likely_response(const uint8_t *bytes)
{
    enum { LAST_EXCEPTION = 11 };
    if ((bytes[1] & FATHOM_MODBUS_EXCEPTION) != 0) return bytes[2] != 0 && bytes[2] <= LAST_EXCEPTION;
    return bytes[2] <= (bytes[1] == FATHOM_MODBUS_READ_HOLDING_REGISTERS ? 2 * MOST_REGISTERS : LAST_PAGE);
}

static bool is_likely_request(const uint8_t *bytes)
{
    const uint8_t count = bytes[5];
    if (bytes[2] > LAST_PAGE) return false;
    switch (bytes[1]) {
    case FATHOM_MODBUS_READ_HOLDING_REGISTERS:
        return bytes[4] == 0 && count != 0 && count <= MOST_REGISTERS;
    case FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS:
        return bytes[4] == 0 && count != 0 && count <= MOST_REGISTERS && bytes[6] == 2 * count;
    default:
        return bytes[1] == FATHOM_MODBUS_WRITE_SINGLE_REGISTER;
    }
}

static void offer_modbus(view_t *view)
{
    const uint8_t *const bytes = view->bytes;
    enum { SHORTEST = 5 };
    if (view->have < SHORTEST) return;
    const bool is_write = bytes[1] == FATHOM_MODBUS_WRITE_SINGLE_REGISTER;
    const uint8_t request = fathom_modbus_rtu_request_length(bytes, view->have);
    const uint8_t response = fathom_modbus_rtu_response_length(bytes, view->have);
    bool is_response = false;
    if (response != 0 && response <= view->have) {
        const bool is_good = fathom_crc16(bytes, response) == 0;
        is_response = is_good;
        if (is_good || is_likely_response(bytes))
            offer(view, response, DECODE_MODBUS, is_write ? DECODE_BOTH : DECODE_RESPONSE, is_good,
                  is_good ? COST_MODBUS : COST_DAMAGED);
    }
    if (request == 0 || request > view->have || (is_write && response == request)) return;
    /* A good response of 7 bytes and a 00 after it have a CRC of 0 too. */
    const bool is_good = fathom_crc16(bytes, request) == 0;
    const bool is_likely = is_ours(bytes[1]) && is_likely_request(bytes);
    if (is_likely || (is_good && !is_response))
        offer(view, request, DECODE_MODBUS, DECODE_REQUEST, is_good, is_good ? COST_MODBUS : COST_DAMAGED);
}

/* ---- sums ---- */

static void offer_dyp(view_t *view)
{
    const uint8_t *const bytes = view->bytes;
    if (view->have < FATHOM_DYP_REQUEST_LENGTH || bytes[0] != 0x55 || bytes[1] != 0xAA) return;
    const uint8_t response = fathom_dyp_55aa_response_length(bytes[3]);
    const bool is_good = fathom_dyp_55aa_is_valid(bytes, FATHOM_DYP_REQUEST_LENGTH);
    if (is_good || response != 0)
        offer(view, FATHOM_DYP_REQUEST_LENGTH, DECODE_DYP,
              response == FATHOM_DYP_REQUEST_LENGTH ? DECODE_BOTH : DECODE_REQUEST, is_good,
              is_good ? COST_SHORT_SUM : COST_DAMAGED);
    if (response <= FATHOM_DYP_REQUEST_LENGTH || response > view->have) return;
    const bool is_response = fathom_dyp_55aa_is_valid(bytes, response);
    offer(view, response, DECODE_DYP, DECODE_RESPONSE, is_response,
          is_response ? COST_LONG_SUM : COST_DAMAGED);
}

static void offer_stream(view_t *view, uint8_t length, uint8_t protocol, uint32_t cost)
{
    if (view->have < length || view->bytes[0] != FATHOM_DYP_START) return;
    const bool is_good = fathom_dyp_stream_is_valid(view->bytes, length);
    offer(view, length, protocol, DECODE_RESPONSE, is_good, is_good ? cost : COST_DAMAGED_STREAM);
}

/* ---- all of it ---- */

static void choose(decode_finder_t *finder, size_t at)
{
    const decode_input_t *const input = finder->input;
    const size_t left = input->count - at;
    view_t view = {input->bytes + at, input->line_starts + at, left, (uint8_t)(left < 255 ? left : 255),
                   finder->choices + at};
    *view.choices = (choice_t){COST_BYTE + view.choices[1].cost, 1, 0, 0, false, false};
    if ((finder->protocols & DECODE_STREAM_ONE) != 0)
        offer_stream(&view, FATHOM_DYP_A16_LENGTH, DECODE_STREAM_ONE, COST_SHORT_SUM);
    if ((finder->protocols & DECODE_STREAM_FOUR) != 0)
        offer_stream(&view, FATHOM_DYP_A05_LENGTH, DECODE_STREAM_FOUR, COST_LONG_SUM);
    if ((finder->protocols & DECODE_DYP) != 0) offer_dyp(&view);
    if ((finder->protocols & DECODE_MODBUS) != 0) offer_modbus(&view);
}

bool decode_find_begin(decode_finder_t *finder, const decode_input_t *input, uint8_t protocols)
{
    finder->input = input;
    finder->protocols = protocols;
    finder->at = 0;
    finder->choices = calloc(input->count + 1, sizeof *finder->choices);
    if (finder->choices == NULL) {
        (void)fprintf(stderr, "fathom: there is no memory to look at %zu bytes.\n", input->count);
        return false;
    }
    for (size_t at = input->count; at != 0; at--) choose(finder, at - 1);
    return true;
}

bool decode_find_next(decode_finder_t *finder, decode_piece_t *piece)
{
    const size_t count = finder->input->count;
    if (finder->at == count) return false;
    const choice_t *choice = finder->choices + finder->at;
    *piece =
        (decode_piece_t){finder->at, choice->length, choice->protocol, choice->direction, choice->is_damaged};
    finder->at += choice->length;
    if (piece->protocol != 0) return true;
    /* Bytes of no frame go together, up to the end of the line. */
    while (finder->at != count && finder->choices[finder->at].protocol == 0 &&
           !finder->input->line_starts[finder->at]) {
        piece->length++;
        finder->at++;
    }
    return true;
}

void decode_find_free(decode_finder_t *finder)
{
    free(finder->choices);
    finder->choices = NULL;
}
