/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_DYP_STREAM_H
#define FATHOM_DYP_STREAM_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The frames that A16 and A05 send by themselves (A16 2(3), 3(4), 5(3); A05 1(2)):
 *
 *   FF H L SUM                          4 bytes, one probe (A16)
 *   FF 1H 1L 2H 2L 3H 3L 4H 4L SUM     10 bytes, four probes (A05)
 *
 * H and L are the high and the low byte of a distance in mm; SUM is the low byte of the sum of all before
 * it. Pure functions: no time, no I/O, no state.
 *
 * What they cannot do: the sum is 8 bits and FF may stand anywhere in a frame, so a good sum does not prove
 * where a frame begins. FF 01 FF FF (511 mm), read one byte late again and again, is 65281 mm with a good
 * sum. stream.h has the rules that keep frames apart.
 */
enum {
    FATHOM_DYP_START = 0xFF,
    FATHOM_DYP_PROBES = 4,      /* of an A05 */
    FATHOM_DYP_A16_LENGTH = 4,  /* bytes of a frame with one probe */
    FATHOM_DYP_A05_LENGTH = 10, /* bytes of a frame with four probes */
    FATHOM_DYP_MAX_LENGTH = FATHOM_DYP_A05_LENGTH
};

/* The low byte of the sum of `length` (0..255) bytes. */
uint8_t fathom_dyp_checksum(const uint8_t *bytes, uint8_t length);

/* Do these `length` (4 or 10) bytes begin with FF and end in their sum? */
bool fathom_dyp_stream_is_valid(const uint8_t *frame, uint8_t length);

/* The distances of a valid frame, as they were sent: `probes` (1 or 4) values. */
void fathom_dyp_stream_decode(const uint8_t *frame, uint16_t *values, uint8_t probes);

/* Writes the frame that carries `probes` (1 or 4) values; returns its length, 4 or 10. */
uint8_t fathom_dyp_stream_encode(uint8_t *frame, const uint16_t *values, uint8_t probes);

#ifdef __cplusplus
}
#endif

#endif
