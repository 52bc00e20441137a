/* SPDX-License-Identifier: MIT */
#include "commands/request/request_meaning.h"

#include <string.h>

/* Functions that models know; of others the frame may have any shape. */
static bool is_known(uint8_t function)
{
    return function == REQUEST_READ || function == REQUEST_WRITE || function == REQUEST_WRITE_MANY;
}

/* An HPS-167S obeys unit 0; 255 it cannot have. */
static bool can_be(const model_t *model, const request_t *request)
{
    if (request->model != NULL) return model == request->model;
    return model->is_dyp || request->frame[REQUEST_UNIT] <= model->max_address;
}

void request_mean(decode_frame_t *frame, decode_piece_t *piece, const request_t *request,
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
    if (!is_known(frame->bytes[REQUEST_FUNCTION])) return;
    for (size_t i = 0; i != MODELS; i++)
        if (can_be(models[i], request)) models[i]->decode(frame, request->frame);
}
