/* SPDX-License-Identifier: MIT */
#ifndef DECODE_FIND_H
#define DECODE_FIND_H

#include "commands/decode/decode_input.h"
#include "sensors/decoding.h"

/*
 * Cuts the input into pieces such that as much as possible is explained: frames with a right checksum count
 * most, then damaged ones, and single bytes are the last resort. An 8-bit sum says little, so a frame that only
 * has that gives way to a Modbus frame around it.
 */
typedef struct {
    const decode_input_t *input;
    uint8_t protocols;
    size_t at;
    struct decode_choice *choices; /* one a byte */
} decode_finder_t;

/* False after saying that there is no memory. To be freed in any case. */
bool decode_find_begin(decode_finder_t *finder, const decode_input_t *input, uint8_t protocols);

/* The next piece; false: that was all. */
bool decode_find_next(decode_finder_t *finder, decode_piece_t *piece);

void decode_find_free(decode_finder_t *finder);

#endif
