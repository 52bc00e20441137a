/* SPDX-License-Identifier: MIT */
#include <inttypes.h>

#include "decode/decode_print.h"

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

/* The name and the unit of a field, as one word. */
static void put_key(FILE *to, const decode_field_t *field)
{
    (void)fputc('"', to);
    for (const char *at = field->name; *at != '\0'; at++) {
        const char low = *at >= 'A' && *at <= 'Z' ? (char)(*at - 'A' + 'a') : *at;
        (void)fputc(low == ' ' || low == '-' ? '_' : low, to);
    }
    if (field->unit[0] != '\0')
        (void)fprintf(to, "_%s", field->unit[0] == 'F' ? "f" : field->unit[0] == 'C' ? "c" : field->unit);
    (void)fputs("\":", to);
}

static void put_meaning(FILE *to, const decode_meaning_t *meaning)
{
    bool any = false;
    (void)fputc('{', to);
    if (meaning->sensor[0] != '\0')
        (void)fprintf(to, "\"sensor\":\"%s\",\"source\":\"%s\",", meaning->sensor, meaning->source);
    (void)fprintf(to, "\"what\":\"%s\",\"fields\":{", meaning->what);
    for (uint8_t i = 0; i != meaning->count; i++) {
        const decode_field_t *const field = &meaning->fields[i];
        const char *const quote = field->is_number ? "" : "\"";
        if (i != 0) (void)fputc(',', to);
        put_key(to, field);
        (void)fprintf(to, "%s%s%s", quote, field->value, quote);
    }
    (void)fputs("},\"notes\":{", to);
    for (uint8_t i = 0; i != meaning->count; i++) {
        if (meaning->fields[i].note == NULL) continue;
        if (any) (void)fputc(',', to);
        any = true;
        put_key(to, &meaning->fields[i]);
        (void)fprintf(to, "\"%s\"", meaning->fields[i].note);
    }
    (void)fputs("}}", to);
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
        put_meaning(to, &frame->meaning[i]);
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
