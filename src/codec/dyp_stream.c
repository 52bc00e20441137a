/* SPDX-License-Identifier: MIT */
#include "fathom/codec/dyp_stream.h"

/* The frames FF .. SUM of A16 and A05. Pure functions that check, decode and encode one frame. */

uint8_t fathom_dyp_checksum(const uint8_t *bytes, uint8_t length)
{
    uint8_t sum = 0;
    for (; length != 0u; length--) {
        sum = (uint8_t)(sum + *bytes);
        bytes++;
    }
    return sum;
}

bool fathom_dyp_stream_is_valid(const uint8_t *frame, uint8_t length)
{
    const uint8_t start = *frame;
    uint8_t sum = 0;
    for (length--; length != 0u; length--) {
        sum = (uint8_t)(sum + *frame);
        frame++;
    }
    return (start == FATHOM_DYP_START) && (sum == *frame);
}

void fathom_dyp_stream_decode(const uint8_t *frame, uint16_t *values, uint8_t probes)
{
    for (frame++; probes != 0u; probes--) {
        *values = (uint16_t)((frame[0] * 256u) + frame[1]);
        frame += 2;
        values++;
    }
}

uint8_t fathom_dyp_stream_encode(uint8_t *frame, const uint16_t *values, uint8_t probes)
{
    uint8_t length = 1;
    frame[0] = FATHOM_DYP_START;
    for (; probes != 0u; probes--) {
        frame[length] = (uint8_t)(*values >> 8);
        length++;
        frame[length] = (uint8_t)*values;
        length++;
        values++;
    }
    frame[length] = fathom_dyp_checksum(frame, length);
    return (uint8_t)(length + 1u);
}
