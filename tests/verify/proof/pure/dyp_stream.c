/* SPDX-License-Identifier: MIT */
/*
 * Frames FF .. SUM of 4 and of 10 bytes, and the sum over 0..255 bytes.
 *
 * proves: src/codec/dyp_stream.c
 * options: -eva-auto-loop-unroll 12 -eva-slevel-function fathom_dyp_checksum:0
 */
#include "fathom/codec/dyp_stream.h"
#include "assumptions.h"

static void sum(void)
{
    static uint8_t bytes[UINT8_MAX];
    any_memory(bytes, sizeof bytes);
    /*@ loop unroll 256; */
    for (unsigned length = 0; length <= UINT8_MAX; length++)
        (void)fathom_dyp_checksum(bytes + UINT8_MAX - length, (uint8_t)length);
}

static void frame(uint8_t length, uint8_t probes)
{
    uint8_t bytes[FATHOM_DYP_MAX_LENGTH];
    uint16_t values[FATHOM_DYP_PROBES];
    uint8_t *const frame = bytes + FATHOM_DYP_MAX_LENGTH - length;
    uint16_t *const first = values + FATHOM_DYP_PROBES - probes;
    for (uint8_t i = 0; i != probes; i++) first[i] = any_16();
    const uint8_t encoded = fathom_dyp_stream_encode(frame, first, probes);
    /*@ assert encoded == length; */
    const bool is_valid = fathom_dyp_stream_is_valid(frame, length);
    any_bytes(frame, length);
    if (fathom_dyp_stream_is_valid(frame, length)) fathom_dyp_stream_decode(frame, first, probes);
    /*@ assert \initialized(first + (0 .. probes - 1)); */
}

int main(void)
{
    sum();
    frame(FATHOM_DYP_A16_LENGTH, 1);
    frame(FATHOM_DYP_A05_LENGTH, FATHOM_DYP_PROBES);
    return 0;
}
