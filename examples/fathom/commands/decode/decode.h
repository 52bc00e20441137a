/* SPDX-License-Identifier: MIT */
#ifndef DECODE_H
#define DECODE_H

#include "sensors/decoding.h"
#include "sensors/models.h"

enum { DECODE_MAX_BYTES = 4 * 1024 * 1024 };

/* Bytes to decode. People write a frame on a line, so the first byte of a line has a mark. */
typedef struct {
    uint8_t bytes[DECODE_MAX_BYTES];
    bool line_starts[DECODE_MAX_BYTES];
    size_t count;
} decode_input_t;

/*
 * Divides the input into pieces so that as many bytes as possible are explained: frames with a right checksum count most,
 * then damaged frames. Single bytes are the last resort. A sum of 8 bits proves little, so a frame that has only a sum
 * gives way to a Modbus frame around it.
 */
typedef struct {
    const decode_input_t *input;
    uint8_t protocols; /* DECODE_... */
    size_t at;
    struct decode_choice *choices; /* one for each byte; free() it at the end */
} decode_finder_t;

void decode_find_begin(decode_finder_t *finder, const decode_input_t *input, uint8_t protocols);

/* Finds the next piece. Returns false at the end. */
bool decode_find_next(decode_finder_t *finder, decode_piece_t *piece);

/* Returns what bytes of no frame may have been meant to be; "" mostly. */
const char *decode_guess(const decode_finder_t *finder, const decode_piece_t *piece, char text[DECODE_TEXT]);

#endif
