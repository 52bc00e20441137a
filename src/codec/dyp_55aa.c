/* SPDX-License-Identifier: MIT */
/*
 * Encodes and decodes the `55 AA` frames of the A05. Requests and responses have the same head and the same sum.
 */
#include "fathom/codec/dyp_55aa.h"

#include "fathom/codec/dyp_stream.h"

/* Offset of the command in a frame, and the length of a frame without values. */
enum { COMMAND = 3, OVERHEAD = 5 };

enum { START = 0x55, SECOND_START = 0xAA };

uint8_t fathom_dyp_55aa_value_count(uint8_t command)
{
    if (command == FATHOM_DYP_ALL_PROBES) return FATHOM_DYP_PROBES;
    const bool is_one_probe =
        (command >= FATHOM_DYP_FIRST_PROBE) && (command < (FATHOM_DYP_FIRST_PROBE + FATHOM_DYP_PROBES));
    return is_one_probe ? 1 : 0;
}

uint8_t fathom_dyp_55aa_response_length(uint8_t command)
{
    const uint8_t values = fathom_dyp_55aa_value_count(command);
    return ((values != 0u) || (command == FATHOM_DYP_SET_ADDRESS)) ? (uint8_t)(OVERHEAD + (2u * values)) : 0u;
}

static uint8_t *put_head(uint8_t *frame, uint8_t address, uint8_t command)
{
    frame[0] = START;
    frame[1] = SECOND_START;
    frame[2] = address;
    frame[COMMAND] = command;
    return &frame[COMMAND + 1];
}

static uint8_t seal(uint8_t *frame, uint8_t *end)
{
    const uint8_t length = (uint8_t)(end - frame);
    *end = fathom_dyp_checksum(frame, length);
    return (uint8_t)(length + 1u);
}

uint8_t fathom_dyp_55aa_encode_request(uint8_t *frame, uint8_t address, uint8_t command)
{
    return seal(frame, put_head(frame, address, command));
}

uint8_t fathom_dyp_55aa_frame_length(const uint8_t *bytes, uint8_t have)
{
    if ((bytes[0] != START) || ((have > 1u) && (bytes[1] != SECOND_START))) return 0;
    return (have > COMMAND) ? fathom_dyp_55aa_response_length(bytes[COMMAND]) : (COMMAND + 1);
}

bool fathom_dyp_55aa_is_valid(const uint8_t *frame, uint8_t length)
{
    const uint8_t last = (uint8_t)(length - 1u);
    return fathom_dyp_checksum(frame, last) == frame[last];
}

void fathom_dyp_55aa_decode(const uint8_t *frame, uint16_t *values)
{
    fathom_dyp_stream_decode(&frame[COMMAND], values, fathom_dyp_55aa_value_count(frame[COMMAND]));
}

uint8_t fathom_dyp_55aa_encode_response(uint8_t *frame, uint8_t address, uint8_t command,
                                        const uint16_t *values)
{
    uint8_t *at = put_head(frame, address, command);
    for (uint8_t left = fathom_dyp_55aa_value_count(command); left != 0u; left--) {
        at[0] = (uint8_t)(*values >> 8);
        at[1] = (uint8_t)*values;
        at += 2;
        values++;
    }
    return seal(frame, at);
}
