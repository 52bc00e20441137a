/* SPDX-License-Identifier: MIT */
#ifndef DECODE_INPUT_H
#define DECODE_INPUT_H

#include <stdint.h>

#include "cli/origin.h"

enum { DECODE_MAX_BYTES = 4 * 1024 * 1024 };

/* Bytes to decode. People write a frame on a line, so the first byte of a line has a mark. */
typedef struct {
    uint8_t *bytes;
    bool *line_starts; /* of each byte */
    size_t count;
    size_t capacity;
} decode_input_t;

/*
 * Reads bytes in hex from the arguments. A single argument that is no hex names a file; without an argument, or with "-",
 * the bytes are those of the standard input. is_raw: the file has the bytes themselves. Returns an exit status:
 * STATUS_OK, or after a message STATUS_FAILED if the file cannot be read, and STATUS_USAGE if a text is no hex. Call
 * decode_input_free() in each case.
 */
int decode_input_read(decode_input_t *input, const origin_t *origin, int count, char **arguments,
                      bool is_raw);
void decode_input_free(decode_input_t *input);

#endif
