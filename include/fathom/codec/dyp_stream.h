/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_DYP_STREAM_H
#define FATHOM_DYP_STREAM_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Encodes and decodes the frames of the automatic and the controlled output of A16 and A05.
 *
 * The functions are pure: they have no state and need no time or I/O. include/COST.md has their size in the row
 * `dyp_stream`. The frames are (A16 2(3), 3(4), 5(3); A05 1(2)):
 *
 *     FF H L SUM                          4 bytes, one probe (A16)
 *     FF 1H 1L 2H 2L 3H 3L 4H 4L SUM     10 bytes, four probes (A05)
 *
 * H and L are the high and the low byte of a distance in millimetres. SUM is the low byte of the sum of all bytes
 * before it.
 *
 * @code
 * const uint8_t frame[] = {0xFF, 0x07, 0xA1, 0xA7};
 * if (fathom_dyp_stream_is_valid(frame, sizeof frame)) fathom_dyp_stream_decode(frame, &mm, 1);      // 1953
 * @endcode
 *
 * A right sum does not prove where a frame begins, because the sum has 8 bits and FF may stand anywhere in a frame. For
 * example FF 01 FF FF (511 mm), read one byte late each time, is 65281 mm with a right sum. stream.h has the rules that
 * find the beginning of a frame.
 */

/** @brief Parts of a frame. */
enum {
    FATHOM_DYP_START = 0xFF,                      /**< First byte of a frame. */
    FATHOM_DYP_PROBES = 4,                        /**< Number of probes of an A05. */
    FATHOM_DYP_A16_LENGTH = 4,                    /**< Length of a frame with one probe, in bytes. */
    FATHOM_DYP_A05_LENGTH = 10,                   /**< Length of a frame with four probes, in bytes. */
    FATHOM_DYP_MAX_LENGTH = FATHOM_DYP_A05_LENGTH /**< Length of the longest frame, in bytes. */
};

/**
 * @brief Returns the low byte of the sum of `length` bytes.
 *
 * @param bytes   The bytes.
 * @param length  Number of bytes, 0 to 255.
 */
uint8_t fathom_dyp_checksum(const uint8_t *bytes, uint8_t length);

/**
 * @brief Returns true if the bytes begin with FF and end with their sum.
 *
 * @param frame   The bytes.
 * @param length  Number of bytes: 4 or 10.
 */
bool fathom_dyp_stream_is_valid(const uint8_t *frame, uint8_t length);

/**
 * @brief Decodes the values of a valid frame, as the sensor sent them. Some values are no distances (dyp.h).
 *
 * @param frame   A frame of 4 bytes (1 probe) or 10 bytes (4 probes).
 * @param values  `probes` values in millimetres. All are written.
 * @param probes  Number of values: 1 or 4.
 */
void fathom_dyp_stream_decode(const uint8_t *frame, uint16_t *values, uint8_t probes);

/**
 * @brief Encodes a frame.
 *
 * @param frame   Memory for 4 bytes (1 probe) or 10 bytes (4 probes). All are written.
 * @param values  `probes` values in millimetres.
 * @param probes  Number of values: 1 or 4.
 * @return Length of the frame in bytes: 4 or 10.
 */
uint8_t fathom_dyp_stream_encode(uint8_t *frame, const uint16_t *values, uint8_t probes);

#ifdef __cplusplus
}
#endif

#endif
