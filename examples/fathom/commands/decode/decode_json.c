/* SPDX-License-Identifier: MIT */
#include <inttypes.h>

#include "commands/decode/decode_print.h"
#include "sensors/decoding_print.h"

static void put_bytes(FILE *to, const uint8_t *bytes, size_t count)
{
    (void)fputc('"', to);
    for (size_t i = 0; i != count; i++) (void)fprintf(to, "%s%02X", i != 0 ? " " : "", bytes[i]);
    (void)fputc('"', to);
}

/* Only texts of the program's own: nothing in them needs to be escaped. */
static void put_text(FILE *to, const char *name, const char *value)
{
    (void)fprintf(to, ",\"%s\":\"%s\"", name, value);
}

static void put_head(FILE *to, const uint8_t *bytes, const decode_piece_t *piece)
{
    (void)fprintf(to, "{\"offset\":%zu,\"length\":%zu,\"bytes\":", piece->offset, piece->length);
    put_bytes(to, bytes, piece->length);
}

static void put_frame(FILE *to, const decode_frame_t *frame)
{
    static const char *const directions[] = {
        [DECODE_REQUEST] = "request", [DECODE_RESPONSE] = "response", [DECODE_BOTH] = "both"};
    const decode_piece_t *const piece = frame->piece;
    put_head(to, frame->bytes, piece);
    put_text(to, "protocol", decode_protocol_name(piece->protocol));
    put_text(to, "direction", directions[piece->direction]);
    if (frame->unit >= 0) (void)fprintf(to, ",\"address\":%d", frame->unit);
    if (frame->code >= 0) (void)fprintf(to, ",\"%s\":%d", frame->code_is, frame->code);
    if (frame->what[0] != '\0') put_text(to, "name", frame->what);
    (void)fprintf(to, ",\"checksum\":{\"right\":%s,\"found\":", piece->is_damaged ? "false" : "true");
    put_bytes(to, frame->bytes + piece->length - frame->checksum_length, frame->checksum_length);
    (void)fputs(",\"expected\":", to);
    put_bytes(to, frame->checksum, frame->checksum_length);
    (void)fputs("},\"meanings\":[", to);
    for (uint8_t i = 0; i != frame->meanings; i++) {
        if (i != 0) (void)fputc(',', to);
        decoding_put_json(to, &frame->meaning[i]);
    }
    (void)fputs("],\"notes\":[", to);
    for (uint8_t i = 0; i != frame->notes; i++)
        (void)fprintf(to, "%s\"%s\"", i != 0 ? "," : "", frame->note[i]);
    (void)fputs("]}\n", to);
}

static void put_leftover(FILE *to, const uint8_t *bytes, const decode_piece_t *piece, const char *why)
{
    put_head(to, bytes, piece);
    (void)fprintf(to, ",\"protocol\":null,\"notes\":[%s%s%s]}\n", why[0] != '\0' ? "\"" : "", why,
                  why[0] != '\0' ? "\"" : "");
}

const decode_format_t decode_json = {"json", put_frame, put_leftover};
