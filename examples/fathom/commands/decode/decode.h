/* SPDX-License-Identifier: MIT */
#ifndef DECODE_H
#define DECODE_H

#include <stdio.h>

#include "cli/option.h"
#include "sensors/decoding.h"

/* ---- the bytes ---- */

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

/* ---- the frames ---- */

/*
 * Divides the input into pieces so that as many bytes as possible are explained: frames with a right checksum count most,
 * then damaged frames. Single bytes are the last resort. A sum of 8 bits proves little, so a frame that has only a sum
 * gives way to a Modbus frame around it.
 */
typedef struct {
    const decode_input_t *input;
    uint8_t protocols;
    size_t at;
    struct decode_choice *choices; /* one for each byte */
} decode_finder_t;

/* Returns false after a message if there is not enough memory. Call decode_find_free() in each case. */
bool decode_find_begin(decode_finder_t *finder, const decode_input_t *input, uint8_t protocols);

/* Finds the next piece. Returns false at the end. */
bool decode_find_next(decode_finder_t *finder, decode_piece_t *piece);

void decode_find_free(decode_finder_t *finder);

/* What is kept from frame to frame: a read that has no response yet. */
typedef struct {
    const model_t *only; /* the sensor; NULL: any model */
    bool is_asked;
    uint8_t head[6]; /* of the last good Modbus request, as on the wire */
} decode_context_t;

/* Decodes a piece that is a frame. */
void decode_frame(decode_frame_t *frame, decode_context_t *context, const decode_input_t *input,
                  const decode_piece_t *piece);

/* ---- the output ---- */

typedef struct {
    const char *name;
    void (*frame)(FILE *to, const decode_frame_t *frame);
    void (*leftover)(FILE *to, const uint8_t *bytes, const decode_piece_t *piece, const char *why);
} decode_format_t;

extern const decode_format_t decode_text;
extern const decode_format_t decode_json;

const char *decode_protocol_name(uint8_t protocol);

#endif
