/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "commands/request/request.h"

/* Returns true if the request can be for this model. An HPS-167S obeys unit 0, and cannot have address 255. */
static bool can_be(const model_t *model, const request_t *request)
{
    if (request->model != NULL) return model == request->model;
    return model->has_address_zero || request->frame[REQUEST_UNIT] <= model->max_address;
}

void request_decode(decode_frame_t *frame, decode_piece_t *piece, const request_t *request,
                    const uint8_t *response, uint8_t length)
{
    memset(frame, 0, sizeof *frame);
    memset(piece, 0, sizeof *piece);
    piece->protocol = DECODE_MODBUS;
    piece->direction = response != NULL ? DECODE_RESPONSE : DECODE_REQUEST;
    piece->length = response != NULL ? length : request->length;
    frame->piece = piece;
    frame->bytes = response != NULL ? response : request->frame;
    frame->is_sure = request->model != NULL;
    frame->unit = frame->bytes[REQUEST_UNIT];
    frame->code = frame->bytes[REQUEST_FUNCTION];
    /* The datasheets know no other functions, whose frames may have any shape. */
    if (frame->code != REQUEST_READ && frame->code != REQUEST_WRITE && frame->code != REQUEST_WRITE_MANY)
        return;
    for (size_t i = 0; i != model_count; i++)
        if (can_be(&models[i], request)) models[i].decode(frame, &models[i], request->frame);
}

/* Returns what the read changes, NULL: nothing. Another model than the named one may be at the address. */
static const char *changes(const request_t *request)
{
    const char *text = NULL;
    const uint8_t function = request->frame[REQUEST_FUNCTION];
    if (function != REQUEST_READ && function != REQUEST_READ_INPUT) return NULL;
    for (size_t i = 0; i != model_count && text == NULL; i++)
        if (models[i].read_changes != NULL) text = models[i].read_changes(request->frame);
    return text;
}

static void print_meanings(const request_t *request)
{
    decode_frame_t frame;
    decode_piece_t piece;
    request_decode(&frame, &piece, request, NULL, 0);
    for (uint8_t i = 0; i != frame.meanings && !request_is_read(request); i++) {
        const decode_meaning_t *const meaning = &frame.meaning[i];
        (void)fprintf(stderr, "fathom: if it is %s: ", meaning->sensor);
        decoding_put_line(stderr, meaning);
        (void)fputs("\n", stderr);
    }
    for (uint8_t i = 0; i != frame.notes; i++) (void)fprintf(stderr, "fathom: %s\n", frame.note[i]);
}

static void print_write(uint8_t function)
{
    if (function == REQUEST_WRITE || function == REQUEST_WRITE_MANY)
        (void)fputs(
            "fathom: the request writes. The unit may store the value in flash, which wears out, and may "
            "change its address or baud rate.\n",
            stderr);
    else
        (void)fprintf(stderr,
                      "fathom: function %u (0x%02X) is in none of the datasheets; its effect is unknown.\n",
                      function, function);
    if (function == 10)
        (void)fputs("fathom: the function 10 that the datasheets print is in hex: 0x10, which is 16.\n",
                    stderr);
}

static void print_unit(const request_t *request)
{
    const uint8_t unit = request->frame[REQUEST_UNIT];
    if (unit == FATHOM_MODBUS_ANY_UNIT)
        (void)fputs("fathom: unit 255: each A16 and A05 obeys it, whatever its address.\n", stderr);
    else if (unit == FATHOM_MODBUS_BROADCAST)
        (void)fprintf(stderr, "fathom: unit 0 is all units%s\n",
                      request_is_broadcast(request) ? ": all obey, and none responds"
                                                    : ", or an A16 or A05 whose address is 0");
}

bool request_may_collide(const request_t *request)
{
    return request_is_read(request) && changes(request) == NULL;
}

bool request_effects(const request_t *request)
{
    const uint8_t unit = request->frame[REQUEST_UNIT];
    const char *const changed = changes(request);
    for (size_t i = 0; i != model_count; i++)
        if (models[i].request_ends != NULL && can_be(&models[i], request))
            (void)fprintf(stderr, "fathom: the request ends %s\n", models[i].request_ends);
    if (changed != NULL) (void)fprintf(stderr, "fathom: %s\n", changed);
    if (!request_is_read(request)) print_write(request->frame[REQUEST_FUNCTION]);
    print_meanings(request);
    print_unit(request);
    return !request_may_collide(request) || unit == FATHOM_MODBUS_BROADCAST || unit == FATHOM_MODBUS_ANY_UNIT;
}
