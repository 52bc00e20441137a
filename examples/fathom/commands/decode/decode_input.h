/* SPDX-License-Identifier: MIT */
#ifndef DECODE_INPUT_H
#define DECODE_INPUT_H

#include <stdint.h>

#include "cli/origin.h"

enum { DECODE_MAX_BYTES = 4 * 1024 * 1024 };

/* Bytes to explain. One that begins a line of the text has a mark: people put a frame on a line. */
typedef struct {
    uint8_t *bytes;
    bool *line_starts; /* as many as bytes */
    size_t count;
} decode_input_t;

/*
 * Takes hex bytes from the arguments; or what is in the file that the only argument names, or on the standard
 * input where there is none or it is "-". raw: the file has the bytes themselves. Returns an exit status: 0, or
 * after saying why STATUS_FAILED when it cannot be read, and STATUS_USAGE when it is no hex. The memory is the
 * input's and is given back by decode_input_free, in any case.
 */
int decode_input_take(decode_input_t *input, const origin_t *origin, int count, char **arguments, bool raw);
void decode_input_free(decode_input_t *input);

#endif
