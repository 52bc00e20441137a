/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "commands/decode/decode.h"
#include "fathom/codec/crc16.h"
#include "fathom/codec/dyp_stream.h"
#include "fathom/codec/modbus_rtu.h"

enum { UNIT = 0, HEAD = 6, ALL_UNITS = 0xFF };
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

static void decode_exception(decode_frame_t *frame, const decode_context_t *context, bool is_asked)
{
    const uint8_t code = frame->bytes[DECODE_AT_SIZE];
    decode_meaning_t *const meaning = decode_mean(frame, "", "", "the request is refused");
    decode_remark(decode_number(meaning, "exception", code, ""), "%s", modbus_exception(code).name);
    bool has_none = false;
    for (size_t i = 0; i != model_count; i++) {
        const model_t *const model = &models[i];
        if (context->only != NULL && context->only != model) continue;
        if (model->exception_name == NULL)
            has_none = true;
        else if (model->exception_name(code) != NULL)
            (void)decode_mean(frame, model->name, model->exception_source, "%s", model->exception_name(code));
    }
    if (has_none) decode_note(frame, "no exceptions are in the datasheets of a16 and a05");
    if (is_asked) decode_note(frame, "refuses the request before");
}

/* The registers, for what no sensor knows either. */
static void decode_plain(decode_frame_t *frame)
{
    const uint8_t *const bytes = frame->bytes;
    const bool is_response = frame->piece->direction == DECODE_RESPONSE;
    if (bytes[DECODE_AT_FUNCTION] == READ && is_response) {
        (void)decode_mean(frame, "", "", "%u registers", bytes[DECODE_AT_SIZE] / 2u);
        return;
    }
    decode_meaning_t *const meaning = decode_mean(frame, "", "", "none of these sensors knows this");
    decode_string(meaning, "address", "0x%04X", decode_get16(bytes + DECODE_AT_FIRST));
    decode_number(meaning,
                  bytes[DECODE_AT_FUNCTION] == FATHOM_MODBUS_WRITE_SINGLE_REGISTER ? "value" : "registers",
                  decode_get16(bytes + DECODE_AT_COUNT), "");
}

static bool responses(const decode_frame_t *frame, const decode_context_t *context)
{
    const uint8_t *const bytes = frame->bytes;
    const uint8_t *const head = context->head;
    if (!context->is_asked || (frame->piece->direction & DECODE_RESPONSE) == 0) return false;
    if (bytes[UNIT] != head[UNIT] && head[UNIT] != ALL_UNITS) return false;
    if ((bytes[DECODE_AT_FUNCTION] & (uint8_t)~EXCEPTION) != head[DECODE_AT_FUNCTION]) return false;
    if ((bytes[DECODE_AT_FUNCTION] & EXCEPTION) != 0) return true;
    if (bytes[DECODE_AT_FUNCTION] == READ)
        return bytes[DECODE_AT_SIZE] == 2 * decode_get16(head + DECODE_AT_COUNT);
    return memcmp(bytes + DECODE_AT_FIRST, head + DECODE_AT_FIRST, HEAD - DECODE_AT_FIRST) == 0;
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
    for (size_t i = 0; i != model_count; i++) {
        const model_t *const model = &models[i];
        const bool is_beyond = !model->has_address_zero && frame->unit > model->max_address;
        if (context->only != NULL ? context->only == model : !is_beyond) model->decode(frame, model, request);
    }
    if (frame->meanings == 0) decode_plain(frame);
}

static void decode_modbus(decode_frame_t *frame, decode_context_t *context)
{
    const decode_piece_t *const piece = frame->piece;
    const uint8_t *const bytes = frame->bytes;
    const bool is_asked = responses(frame, context);
    frame->unit = bytes[UNIT];
    frame->code = bytes[DECODE_AT_FUNCTION];
    frame->code_is = "function";
    (void)snprintf(frame->what, sizeof frame->what, "%s%s",
                   (bytes[DECODE_AT_FUNCTION] & EXCEPTION) != 0 ? "refuses to " : "",
                   function_name(bytes[DECODE_AT_FUNCTION]));
    decode_checksum(frame);
    if (frame->unit == FATHOM_MODBUS_BROADCAST)
        decode_note(frame, "0 is the broadcast address: all obey, none answers");
    if (frame->unit == ALL_UNITS) decode_note(frame, "FF is the broadcast address of a16 and a05");
    if ((bytes[DECODE_AT_FUNCTION] & EXCEPTION) != 0) {
        decode_exception(frame, context, is_asked);
    } else if (piece->direction == DECODE_RESPONSE && bytes[DECODE_AT_FUNCTION] == READ) {
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
    if (is_asked || piece->direction == DECODE_RESPONSE || piece->is_damaged) return;
    memcpy(context->head, bytes, sizeof context->head);
    context->is_asked = true;
}

/* Decodes a frame with a sum for the models that send it. */
static void decode_sum(decode_frame_t *frame)
{
    frame->checksum_length = 1;
    frame->checksum[0] = fathom_dyp_checksum(frame->bytes, (uint8_t)(frame->piece->length - 1));
    for (size_t i = 0; i != model_count; i++)
        if ((models[i].protocols & frame->piece->protocol) != 0) models[i].decode_sum(frame, &models[i]);
}

void decode_frame(decode_frame_t *frame, decode_context_t *context, const decode_input_t *input,
                  const decode_piece_t *piece)
{
    frame->piece = piece;
    frame->bytes = input->bytes + piece->offset;
    frame->unit = frame->code = -1;
    frame->code_is = "";
    frame->what[0] = '\0';
    frame->is_sure = context->only != NULL;
    frame->meanings = frame->notes = 0;
    if (piece->protocol == DECODE_MODBUS)
        decode_modbus(frame, context);
    else
        decode_sum(frame);
    if (piece->is_damaged)
        decode_note(frame, "a receiver drops the frame; which of its bytes are wrong is unknown");
}
