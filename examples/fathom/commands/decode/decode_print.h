/* SPDX-License-Identifier: MIT */
#ifndef DECODE_PRINT_H
#define DECODE_PRINT_H

#include <stdio.h>

#include "commands/decode/decode_frame.h"

/* A way to write what was found. */
typedef struct {
    const char *name;
    void (*frame)(FILE *to, const decode_frame_t *frame);
    void (*leftover)(FILE *to, const uint8_t *bytes, const decode_piece_t *piece, const char *why);
} decode_format_t;

extern const decode_format_t decode_text;
extern const decode_format_t decode_json;

const char *decode_protocol_name(uint8_t protocol);

#endif
