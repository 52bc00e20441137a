/* SPDX-License-Identifier: MIT */
#ifndef DECODE_FRAME_H
#define DECODE_FRAME_H

#include "commands/decode/decode_find.h"
#include "sensors/models.h"

/* What is remembered from frame to frame: a read whose response is due. */
typedef struct {
    const model_t *only; /* the sensor; NULL: any of the models */
    bool is_asked;
    uint8_t head[6]; /* the last good Modbus request, as on the wire */
} decode_context_t;

/* Everything of one piece (protocol not 0). */
void decode_frame(decode_frame_t *frame, decode_context_t *context, const decode_input_t *input,
                  const decode_piece_t *piece);

/* Of a Modbus frame: the part of that which is the protocol's. */
void decode_modbus(decode_frame_t *frame, decode_context_t *context);

#endif
