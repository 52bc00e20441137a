/* SPDX-License-Identifier: MIT */
#ifndef DECODE_FRAME_H
#define DECODE_FRAME_H

#include "decode/decode_find.h"

/* What a frame says, before it is written as text or JSON. */

/* Sensors that may have been there; sets of them. */
enum { DECODE_A16 = 1, DECODE_A05 = 2, DECODE_HPS167S = 4, DECODE_SENSORS = 7 };

enum { DECODE_TEXT = 160, DECODE_VALUE = 64, DECODE_FIELDS = 10, DECODE_MEANINGS = 12, DECODE_NOTES = 6 };

typedef struct {
    const char *name;
    const char *unit; /* "": none */
    const char *note; /* NULL: none */
    bool is_number;
    char value[DECODE_VALUE];
} decode_field_t;

/* What it means if a certain sensor was meant; nothing but the fields where sensor is "". */
typedef struct {
    const char *sensor;
    const char *source; /* section of its datasheet */
    char what[DECODE_TEXT];
    uint8_t count;
    decode_field_t fields[DECODE_FIELDS];
} decode_meaning_t;

typedef struct {
    const decode_piece_t *piece;
    const uint8_t *bytes;
    bool is_sure;            /* one sensor was named; else only what is likely is guessed */
    int unit;                /* -1: it has none */
    int code;                /* function or command; -1: it has none */
    const char *code_is;     /* "function" or "command" */
    char what[DECODE_VALUE]; /* "read holding registers"; "": nothing to add */
    uint8_t checksum_length; /* bytes at the end */
    uint8_t checksum[2];     /* as they should be */
    uint8_t meanings;        /* used */
    uint8_t notes;           /* used */
    decode_meaning_t meaning[DECODE_MEANINGS];
    char note[DECODE_NOTES][DECODE_TEXT];
} decode_frame_t;

/* What is remembered from frame to frame: a read whose answer is due. */
typedef struct {
    uint8_t sensors; /* that may be there */
    bool is_asked;
    uint8_t head[6]; /* the last good Modbus request, as on the wire */
} decode_context_t;

/* Everything of one piece (protocol not 0). */
void decode_frame(decode_frame_t *frame, decode_context_t *context, const decode_input_t *input,
                  const decode_piece_t *piece);

/* ---- for those who fill it in ---- */

uint16_t decode_get16(const uint8_t *at);

/* A meaning with its name as printf makes it; further fields go to it. Full: the last one is overwritten. */
decode_meaning_t *decode_mean(decode_frame_t *frame, const char *sensor, const char *source,
                              const char *format, ...);
void decode_note(decode_frame_t *frame, const char *format, ...);

/* The field, for a note of its own. */
decode_field_t *decode_number(decode_meaning_t *meaning, const char *name, int64_t value, const char *unit);
/* As many decimal places. */
decode_field_t *decode_decimal(decode_meaning_t *meaning, const char *name, int64_t value, uint8_t places,
                               const char *unit);
decode_field_t *decode_string(decode_meaning_t *meaning, const char *name, const char *format, ...);

/* An ultrasonic distance as A16 and A05 send it. */
void decode_ultrasonic(decode_meaning_t *meaning, const char *name, uint16_t value);

/* ---- the parts ---- */

void decode_modbus(decode_frame_t *frame, decode_context_t *context);
void decode_sums(decode_frame_t *frame);

/* What a Modbus request or answer is to each sensor. An answer to a read may have no request (NULL); the bytes
 * of a request are those of the frame. */
void decode_a16(decode_frame_t *frame, const uint8_t *request);
void decode_a05(decode_frame_t *frame, const uint8_t *request);
void decode_hps167s(decode_frame_t *frame, const uint8_t *request);

#endif
