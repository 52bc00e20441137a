/* SPDX-License-Identifier: MIT */
#ifndef DECODING_H
#define DECODING_H

#include "fathom/codec/hps167s_registers.h"
#include "output/record.h"
#include "sensors/setting.h"

/* A decoded frame, before it is printed as text or JSON. */

/* The most registers in a response of these sensors, and their greatest address. */
enum { DECODE_MAX_REGISTERS = FATHOM_HPS167S_MAX_REGISTERS, DECODE_MAX_ADDRESS = 0x0207 };

enum { DECODE_REQUEST = 1, DECODE_RESPONSE = 2, DECODE_BOTH = 3 };

/* A frame, or bytes that belong to none (protocol 0). */
typedef struct {
    size_t offset;
    size_t length;
    uint8_t protocol;
    uint8_t direction; /* DECODE_REQUEST, DECODE_RESPONSE, or both where the bytes are the same */
    bool is_damaged;   /* the shape of a frame, but its checksum is wrong */
} decode_piece_t;

/* Positions in a Modbus frame. The response of a read has its size instead of the first register. */
enum {
    DECODE_AT_FUNCTION = 1,
    DECODE_AT_SIZE = 2,
    DECODE_AT_FIRST = 2,
    DECODE_AT_DATA = 3, /* the registers of a response to a read */
    DECODE_AT_COUNT = 4,
    DECODE_AT_VALUE = 4,
    DECODE_AT_MANY = 7 /* the registers of a write of several */
};

enum { DECODE_TEXT = 160, DECODE_VALUE = 64, DECODE_REMARK = 96 };
enum { DECODE_FIELDS = 10, DECODE_MEANINGS = 12, DECODE_NOTES = 6 };

typedef struct {
    const char *name;
    const char *unit;         /* "": none */
    char note[DECODE_REMARK]; /* "": none */
    bool is_number;
    char value[DECODE_VALUE];
} decode_field_t;

/* The meaning of a frame for one sensor; without a sensor (""), of any Modbus frame. */
typedef struct {
    const char *sensor;
    const char *source; /* section of its datasheet */
    char what[DECODE_TEXT];
    uint8_t count;
    decode_field_t fields[DECODE_FIELDS];
} decode_meaning_t;

typedef struct decode_frame {
    const decode_piece_t *piece;
    const uint8_t *bytes;
    bool is_sure;            /* the user named the sensor; otherwise only likely meanings are added */
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

/* ---- for model_t.decode ---- */

uint16_t decode_get16(const uint8_t *at);
void decode_registers(const uint8_t *at, uint16_t *registers, uint8_t count);

/* Adds a meaning. If there is no room, it replaces the last one. */
decode_meaning_t *decode_mean(decode_frame_t *frame, const char *sensor, const char *source,
                              const char *format, ...);
void decode_note(decode_frame_t *frame, const char *format, ...);

/* Add a field and return it, for a note. */
decode_field_t *decode_number(decode_meaning_t *meaning, const char *name, int64_t value, const char *unit);
decode_field_t *decode_string(decode_meaning_t *meaning, const char *name, const char *format, ...);

/* Sets the note of a field. */
void decode_remark(decode_field_t *field, const char *format, ...);

/* Add a value of a setting as it is on the wire, with a note if the setting cannot have it, and the value of a
 * response. */
void decode_setting(decode_meaning_t *meaning, const setting_t *setting, int64_t value);
void decode_response(decode_meaning_t *meaning, const setting_t *setting, const uint16_t *registers);

/* ---- printing ---- */

/* Prints the meaning and its first value, without a line feed. */
void decoding_put_line(FILE *to, const decode_meaning_t *meaning);

/* Prints indented lines; a meaning with one value is one line. */
void decoding_put_text(FILE *to, const decode_meaning_t *meaning);

/* Writes an element of the open array. */
void decoding_put_json(json_t *json, const decode_meaning_t *meaning);

#endif
