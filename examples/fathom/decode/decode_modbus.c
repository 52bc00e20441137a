/* SPDX-License-Identifier: MIT */
#include "decode/decode_frame.h"

#include <stdio.h>
#include <string.h>

#include "fathom/crc16.h"
#include "fathom/hps167s_registers.h"
#include "fathom/modbus_rtu.h"

enum { UNIT = 0, FUNCTION = 1, SIZE = 2, FIRST = 2, COUNT = 4, HEAD = 6, EVERYBODY = 0xFF };
enum { READ = FATHOM_MODBUS_READ_HOLDING_REGISTERS, EXCEPTION = FATHOM_MODBUS_EXCEPTION };

static const char *function_name(uint8_t function)
{
    switch (function & (uint8_t)~EXCEPTION) {
    case FATHOM_MODBUS_READ_HOLDING_REGISTERS:
        return "read holding registers";
    case FATHOM_MODBUS_WRITE_SINGLE_REGISTER:
        return "write single register";
    case FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS:
        return "write multiple registers";
    default:
        return "do what none of these sensors can";
    }
}

/* By the specification's name, section 7; the HPS-167S has its own words for the first four (table 39). */
static const char *exception_name(uint8_t code)
{
    static const char *const names[] = {[1] = "illegal function",
                                        [2] = "illegal data address",
                                        [3] = "illegal data value",
                                        [4] = "server device failure",
                                        [5] = "acknowledge",
                                        [6] = "server device busy",
                                        [8] = "memory parity error",
                                        [10] = "gateway path unavailable",
                                        [11] = "gateway target device failed to respond"};
    const char *const name = code < sizeof names / sizeof names[0] ? names[code] : NULL;
    return name != NULL ? name : "no code of the specification";
}

static const char *hps167s_exception_name(uint8_t code)
{
    static const char *const names[] = {[1] = "illegal function code",
                                        [2] = "illegal start address or register address",
                                        [3] = "illegal register count",
                                        [4] = "device operation failed"};
    return code != 0 && code < sizeof names / sizeof names[0] ? names[code] : NULL;
}

static void decode_exception(decode_frame_t *frame, const decode_context_t *context, bool is_asked)
{
    const uint8_t code = frame->bytes[SIZE];
    decode_meaning_t *const meaning = decode_mean(frame, "", "", "the request is refused");
    decode_number(meaning, "exception", code, "")->note = exception_name(code);
    if ((context->sensors & DECODE_HPS167S) != 0 && hps167s_exception_name(code) != NULL)
        (void)decode_mean(frame, "hps167s", "HPS table 39", "%s", hps167s_exception_name(code));
    if ((context->sensors & (DECODE_A16 | DECODE_A05)) != 0)
        decode_note(frame, "no exceptions are in the datasheets of a16 and a05");
    if (is_asked) decode_note(frame, "refuses the request before");
}

/* The registers, for what no sensor knows either. */
static void decode_plain(decode_frame_t *frame)
{
    const uint8_t *const bytes = frame->bytes;
    const bool is_answer = frame->piece->direction == DECODE_ANSWER;
    if (bytes[FUNCTION] == READ && is_answer) {
        (void)decode_mean(frame, "", "", "%u registers", bytes[SIZE] / 2u);
        return;
    }
    decode_meaning_t *const meaning = decode_mean(frame, "", "", "none of these sensors knows this");
    decode_string(meaning, "address", "0x%04X", decode_get16(bytes + FIRST));
    decode_number(meaning, bytes[FUNCTION] == FATHOM_MODBUS_WRITE_SINGLE_REGISTER ? "value" : "registers",
                  decode_get16(bytes + COUNT), "");
}

static bool answers(const decode_frame_t *frame, const decode_context_t *context)
{
    const uint8_t *const bytes = frame->bytes;
    const uint8_t *const head = context->head;
    if (!context->is_asked || (frame->piece->direction & DECODE_ANSWER) == 0) return false;
    if (bytes[UNIT] != head[UNIT] && head[UNIT] != EVERYBODY) return false;
    if ((bytes[FUNCTION] & (uint8_t)~EXCEPTION) != head[FUNCTION]) return false;
    if ((bytes[FUNCTION] & EXCEPTION) != 0) return true;
    if (bytes[FUNCTION] == READ) return bytes[SIZE] == 2 * decode_get16(head + COUNT);
    return memcmp(bytes + FIRST, head + FIRST, HEAD - FIRST) == 0;
}

static void decode_checksum(decode_frame_t *frame)
{
    const uint8_t data = (uint8_t)(frame->piece->length - 2);
    const uint8_t *const found = frame->bytes + data;
    const uint16_t crc = fathom_crc16(frame->bytes, data);
    frame->checksum_length = 2;
    frame->checksum[0] = (uint8_t)crc;
    frame->checksum[1] = (uint8_t)(crc >> 8);
    if (frame->piece->is_damaged && found[0] == frame->checksum[1] && found[1] == frame->checksum[0])
        decode_note(frame, "the two bytes of the CRC are swapped: the low one goes first");
}

static void decode_meanings(decode_frame_t *frame, const decode_context_t *context, const uint8_t *request)
{
    const bool is_wide = frame->unit > FATHOM_HPS167S_MAX_ADDRESS;
    if ((context->sensors & DECODE_A16) != 0) decode_a16(frame, request);
    if ((context->sensors & DECODE_A05) != 0) decode_a05(frame, request);
    if ((context->sensors & DECODE_HPS167S) != 0 && (!is_wide || context->sensors == DECODE_HPS167S))
        decode_hps167s(frame, request);
    if (frame->meanings == 0) decode_plain(frame);
}

void decode_modbus(decode_frame_t *frame, decode_context_t *context)
{
    const decode_piece_t *const piece = frame->piece;
    const uint8_t *const bytes = frame->bytes;
    const bool is_asked = answers(frame, context);
    frame->unit = bytes[UNIT];
    frame->code = bytes[FUNCTION];
    frame->code_is = "function";
    (void)snprintf(frame->what, sizeof frame->what, "%s%s",
                   (bytes[FUNCTION] & EXCEPTION) != 0 ? "refuses to " : "", function_name(bytes[FUNCTION]));
    decode_checksum(frame);
    if (frame->unit == FATHOM_MODBUS_BROADCAST)
        decode_note(frame, "0 is the broadcast address: all obey, none answers");
    if (frame->unit == EVERYBODY) decode_note(frame, "FF is the broadcast address of a16 and a05");
    if ((bytes[FUNCTION] & EXCEPTION) != 0) {
        decode_exception(frame, context, is_asked);
    } else if (piece->direction == DECODE_ANSWER && bytes[FUNCTION] == READ) {
        decode_meanings(frame, context, is_asked ? context->head : NULL);
        if (!is_asked) decode_note(frame, "its request is not here; what it answers hangs on that");
    } else {
        decode_meanings(frame, context, bytes);
        if (is_asked)
            decode_note(frame, piece->direction == DECODE_BOTH
                                   ? "acknowledges the request before, or is its echo"
                                   : "acknowledges the request before");
    }
    if (is_asked && !piece->is_damaged) context->is_asked = false;
    if (is_asked || piece->direction == DECODE_ANSWER || piece->is_damaged) return;
    memcpy(context->head, bytes, sizeof context->head);
    context->is_asked = true;
}
