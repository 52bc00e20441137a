/* SPDX-License-Identifier: MIT */
#include "commands/decode/decode_frame.h"

#include "fathom/codec/dyp_stream.h"

/* A frame with a sum is one of the models that send it. */
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
        decode_note(frame, "a receiver drops it; which of its bytes are wrong is not known");
}
