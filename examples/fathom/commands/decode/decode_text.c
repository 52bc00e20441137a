/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "commands/decode/decode.h"

enum { BYTES_A_LINE = 20 };

const char *decode_protocol_name(uint8_t protocol)
{
    switch (protocol) {
    case DECODE_MODBUS:
        return "modbus";
    case DECODE_DYP:
        return "dyp";
    default:
        return "stream";
    }
}

static void put_bytes(FILE *to, const uint8_t *bytes, const decode_piece_t *piece)
{
    for (size_t i = 0; i != piece->length; i++) {
        if (i % BYTES_A_LINE == 0) (void)fprintf(to, "%s%06zu ", i != 0 ? "\n" : "", piece->offset + i);
        (void)fprintf(to, " %02X", bytes[i]);
    }
    (void)fputc('\n', to);
}

static const char *direction_text(uint8_t direction)
{
    switch (direction) {
    case DECODE_REQUEST:
        return "request";
    case DECODE_RESPONSE:
        return "response";
    default:
        return "request or response, which are the same bytes";
    }
}

static void put_head(FILE *to, const decode_frame_t *frame)
{
    static const char *const names[] = {
        [DECODE_MODBUS] = "Modbus RTU",
        [DECODE_DYP] = "55 AA protocol",
        [DECODE_STREAM_ONE] = "FF frame of one distance",
        [DECODE_STREAM_FOUR] = "FF frame of four distances",
    };
    const decode_piece_t *const piece = frame->piece;
    const bool is_stream = (piece->protocol & (DECODE_STREAM_ONE | DECODE_STREAM_FOUR)) != 0;
    (void)fprintf(to, "        %s", names[piece->protocol]);
    if (!is_stream) (void)fprintf(to, ", %s", direction_text(piece->direction));
    if (frame->unit >= 0) (void)fprintf(to, ", address %d", frame->unit);
    if (frame->code >= 0) (void)fprintf(to, ", %s %02X", frame->code_is, (unsigned)frame->code);
    if (frame->what[0] != '\0') (void)fprintf(to, " %s", frame->what);
    (void)fputc('\n', to);
}

static void put_checksum(FILE *to, const decode_frame_t *frame)
{
    const uint8_t *const found = frame->bytes + frame->piece->length - frame->checksum_length;
    const bool is_crc = frame->checksum_length == 2;
    (void)fprintf(to, "        %s %02X", is_crc ? "CRC" : "sum", found[0]);
    if (is_crc) (void)fprintf(to, " %02X", found[1]);
    if (!frame->piece->is_damaged) {
        (void)fputs(" right\n", to);
        return;
    }
    (void)fprintf(to, " WRONG, it should be %02X", frame->checksum[0]);
    if (is_crc) (void)fprintf(to, " %02X", frame->checksum[1]);
    (void)fputc('\n', to);
}

static void put_frame(FILE *to, const decode_frame_t *frame)
{
    put_bytes(to, frame->bytes, frame->piece);
    put_head(to, frame);
    for (uint8_t i = 0; i != frame->meanings; i++) decoding_put_text(to, &frame->meaning[i]);
    put_checksum(to, frame);
    for (uint8_t i = 0; i != frame->notes; i++) (void)fprintf(to, "        note: %s\n", frame->note[i]);
}

static void put_leftover(FILE *to, const uint8_t *bytes, const decode_piece_t *piece, const char *why)
{
    put_bytes(to, bytes, piece);
    (void)fprintf(to, "        NO FRAME%s%s\n", why[0] != '\0' ? ": " : "", why);
}

const decode_format_t decode_text = {"text", put_frame, put_leftover};
