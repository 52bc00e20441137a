/* SPDX-License-Identifier: MIT */
#include "commands/decode/decode.h"

static json_t begin(FILE *to, const uint8_t *bytes, const decode_piece_t *piece)
{
    json_t json = {.to = to};
    json_begin(&json, NULL, '{');
    json_value(&json, "offset", "%zu", piece->offset);
    json_value(&json, "length", "%zu", piece->length);
    json_bytes(&json, "bytes", bytes, piece->length);
    return json;
}

static void end(json_t *json)
{
    json_end(json, '}');
    (void)fputc('\n', json->to);
}

static void put_checksum(json_t *json, const decode_frame_t *frame)
{
    const size_t length = frame->checksum_length;
    json_begin(json, "checksum", '{');
    json_flag(json, "right", !frame->piece->is_damaged);
    json_bytes(json, "found", frame->bytes + frame->piece->length - length, length);
    json_bytes(json, "expected", frame->checksum, length);
    json_end(json, '}');
}

static void put_frame(FILE *to, const decode_frame_t *frame)
{
    static const char *const directions[] = {
        [DECODE_REQUEST] = "request", [DECODE_RESPONSE] = "response", [DECODE_BOTH] = "both"};
    json_t json = begin(to, frame->bytes, frame->piece);
    json_string(&json, "protocol", decode_protocol_name(frame->piece->protocol));
    json_string(&json, "direction", directions[frame->piece->direction]);
    if (frame->unit >= 0) json_value(&json, "address", "%d", frame->unit);
    if (frame->code >= 0) json_value(&json, frame->code_is, "%d", frame->code);
    if (frame->what[0] != '\0') json_string(&json, "name", frame->what);
    put_checksum(&json, frame);
    json_begin(&json, "meanings", '[');
    for (uint8_t i = 0; i != frame->meanings; i++) decoding_put_json(&json, &frame->meaning[i]);
    json_end(&json, ']');
    json_begin(&json, "notes", '[');
    for (uint8_t i = 0; i != frame->notes; i++) json_string(&json, NULL, frame->note[i]);
    json_end(&json, ']');
    end(&json);
}

static void put_leftover(FILE *to, const uint8_t *bytes, const decode_piece_t *piece, const char *why)
{
    json_t json = begin(to, bytes, piece);
    json_string(&json, "protocol", NULL);
    json_begin(&json, "notes", '[');
    if (why[0] != '\0') json_string(&json, NULL, why);
    json_end(&json, ']');
    end(&json);
}

const decode_format_t decode_json = {"json", put_frame, put_leftover};
