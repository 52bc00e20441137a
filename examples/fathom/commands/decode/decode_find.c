/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "commands/decode/decode.h"
#include "fathom/codec/crc16.h"
#include "fathom/codec/dyp_55aa.h"
#include "fathom/codec/dyp_stream.h"
#include "fathom/codec/modbus_rtu.h"
#include "output/words.h"

/*
 * The price of each piece; the cheapest way through the input is taken. A damaged frame is dearer than the good ones that
 * its bytes could be instead, so it has a price a byte, and cheaper than bytes of no frame. Frames seldom go across the end
 * of a line.
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

/* The input from one byte on. */
typedef struct {
    const uint8_t *bytes;
    const bool *line_starts;
    uint8_t have; /* up to 255 */
    choice_t *choices;
} view_t;

/* Takes a frame of `length` bytes, if it is there, as the choice unless another one is cheaper. */
static void offer(const view_t *view, uint8_t length, uint8_t protocol, uint8_t direction, bool is_good,
                  uint32_t cost)
{
    choice_t *const choice = view->choices;
    const bool is_sure = is_good && protocol == DECODE_MODBUS;
    if (length == 0 || length > view->have) return;
    cost += choice[length].cost + (is_good ? 0 : length * (uint32_t)COST_DAMAGED_BYTE);
    for (uint8_t i = 1; i < length; i++) {
        /* A right CRC of 16 bits is hardly chance: nothing less sure goes over the beginning of such a frame. */
        if (choice[i].has_crc && !is_sure) return;
        if (view->line_starts[i]) cost += is_good ? COST_LINE : COST_DAMAGED_LINE;
    }
    choice->has_crc = choice->has_crc || is_sure;
    if (cost <= choice->cost)
        *choice = (choice_t){cost, length, protocol, direction, !is_good, choice->has_crc};
}

/* ---- Modbus ---- */

static bool is_known(uint8_t function)
{
    return function == FATHOM_MODBUS_READ_HOLDING_REGISTERS ||
           function == FATHOM_MODBUS_WRITE_SINGLE_REGISTER ||
           function == FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS;
}

/* With a wrong CRC only what these sensors could send passes for a frame; else noise would be full of them. */
enum { LAST_PAGE = DECODE_MAX_ADDRESS >> 8, LAST_EXCEPTION = 11 };

static bool is_likely_response(const uint8_t *bytes)
{
    if ((bytes[1] & FATHOM_MODBUS_EXCEPTION) != 0) return bytes[2] != 0 && bytes[2] <= LAST_EXCEPTION;
    return bytes[2] <=
           (bytes[1] == FATHOM_MODBUS_READ_HOLDING_REGISTERS ? 2 * DECODE_MAX_REGISTERS : LAST_PAGE);
}

static bool is_likely_request(const uint8_t *bytes)
{
    const uint8_t count = bytes[5];
    if (!is_known(bytes[1]) || bytes[2] > LAST_PAGE) return false;
    if (bytes[1] == FATHOM_MODBUS_WRITE_SINGLE_REGISTER) return true;
    return bytes[4] == 0 && count != 0 && count <= DECODE_MAX_REGISTERS &&
           (bytes[1] == FATHOM_MODBUS_READ_HOLDING_REGISTERS || bytes[6] == 2 * count);
}

static void offer_modbus(const view_t *view)
{
    enum { SHORTEST = 5 };
    const uint8_t *const bytes = view->bytes;
    if (view->have < SHORTEST) return;
    const bool is_write = bytes[1] == FATHOM_MODBUS_WRITE_SINGLE_REGISTER;
    const uint8_t request = fathom_modbus_rtu_request_length(bytes, view->have);
    const uint8_t response = fathom_modbus_rtu_response_length(bytes, view->have);
    bool is_response = false;
    if (response != 0 && response <= view->have) {
        is_response = fathom_crc16(bytes, response) == 0;
        if (is_response || is_likely_response(bytes))
            offer(view, response, DECODE_MODBUS, is_write ? DECODE_BOTH : DECODE_RESPONSE, is_response,
                  is_response ? COST_MODBUS : COST_DAMAGED);
    }
    if (request == 0 || request > view->have || (is_write && response == request)) return;
    /* A good response of 7 bytes and a 00 after it have a CRC of 0 too. */
    const bool is_good = fathom_crc16(bytes, request) == 0;
    if (is_likely_request(bytes) || (is_good && !is_response))
        offer(view, request, DECODE_MODBUS, DECODE_REQUEST, is_good, is_good ? COST_MODBUS : COST_DAMAGED);
}

/* ---- sums ---- */

static void offer_dyp(const view_t *view)
{
    enum { REQUEST = FATHOM_DYP_REQUEST_LENGTH };
    const uint8_t *const bytes = view->bytes;
    if (view->have < REQUEST || bytes[0] != 0x55 || bytes[1] != 0xAA) return;
    const uint8_t response = fathom_dyp_55aa_response_length(bytes[3]);
    const bool is_request = fathom_dyp_55aa_is_valid(bytes, REQUEST);
    if (is_request || response != 0)
        offer(view, REQUEST, DECODE_DYP, response == REQUEST ? DECODE_BOTH : DECODE_REQUEST, is_request,
              is_request ? COST_SHORT_SUM : COST_DAMAGED);
    if (response <= REQUEST || response > view->have) return;
    const bool is_response = fathom_dyp_55aa_is_valid(bytes, response);
    offer(view, response, DECODE_DYP, DECODE_RESPONSE, is_response,
          is_response ? COST_LONG_SUM : COST_DAMAGED);
}

static void offer_stream(const view_t *view, uint8_t length, uint8_t protocol, uint32_t cost)
{
    if (view->have < length || view->bytes[0] != FATHOM_DYP_START) return;
    const bool is_good = fathom_dyp_stream_is_valid(view->bytes, length);
    offer(view, length, protocol, DECODE_RESPONSE, is_good, is_good ? cost : COST_DAMAGED_STREAM);
}

/* ---- all of it ---- */

static void choose(const decode_finder_t *finder, size_t at)
{
    const decode_input_t *const input = finder->input;
    const size_t left = input->count - at;
    const view_t view = {input->bytes + at, input->line_starts + at, (uint8_t)(left < 255 ? left : 255),
                         finder->choices + at};
    *view.choices = (choice_t){.cost = COST_BYTE + view.choices[1].cost, .length = 1};
    if ((finder->protocols & DECODE_STREAM_ONE) != 0)
        offer_stream(&view, FATHOM_DYP_A16_LENGTH, DECODE_STREAM_ONE, COST_SHORT_SUM);
    if ((finder->protocols & DECODE_STREAM_FOUR) != 0)
        offer_stream(&view, FATHOM_DYP_A05_LENGTH, DECODE_STREAM_FOUR, COST_LONG_SUM);
    if ((finder->protocols & DECODE_DYP) != 0) offer_dyp(&view);
    if ((finder->protocols & DECODE_MODBUS) != 0) offer_modbus(&view);
}

void decode_find_begin(decode_finder_t *finder, const decode_input_t *input, uint8_t protocols)
{
    finder->input = input;
    finder->protocols = protocols;
    finder->at = 0;
    finder->choices = allocate((input->count + 1) * sizeof *finder->choices);
    for (size_t at = input->count; at != 0; at--) choose(finder, at - 1);
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
           !finder->input->line_starts[finder->at])
        finder->at++;
    piece->length = finder->at - piece->offset;
    return true;
}

const char *decode_guess(const decode_finder_t *finder, const decode_piece_t *piece, char text[DECODE_TEXT])
{
    const decode_input_t *const input = finder->input;
    const uint8_t *const bytes = input->bytes + piece->offset;
    const bool may_be_modbus = (finder->protocols & DECODE_MODBUS) != 0;
    const size_t next = piece->offset + piece->length;
    uint8_t have = 255;
    if (piece->length < have) have = (uint8_t)piece->length;
    if (have == 1 && bytes[0] == FATHOM_DYP_START && next != input->count &&
        input->bytes[next] == FATHOM_DYP_START)
        return "an FF too many: a frame begins with one, though A16 2(3) prints two";
    if (may_be_modbus && have == 4 && fathom_crc16(bytes, have) == 0)
        return "its CRC is right, but it has no function; HPS table 40 leaves it out so";
    if ((finder->protocols & DECODE_DYP) != 0 && have >= 2 && bytes[0] == 0x55 && bytes[1] == 0xAA)
        return "begins like a 55 AA frame, but is none";
    if (!may_be_modbus || have < 3 || !is_known(bytes[1])) return "";
    const uint8_t response = fathom_modbus_rtu_response_length(bytes, have);
    const uint8_t request = fathom_modbus_rtu_request_length(bytes, have);
    const bool has_count = bytes[1] != FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS || have > 6;
    if (response <= have) return "";
    if (request > have && has_count)
        (void)snprintf(text, DECODE_TEXT,
                       "begins like a Modbus request of %u or a response of %u bytes, but ends early",
                       request, response);
    else
        (void)snprintf(text, DECODE_TEXT, "begins like a Modbus response of %u bytes, but ends early",
                       response);
    return text;
}
