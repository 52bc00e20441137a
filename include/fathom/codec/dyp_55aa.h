/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_DYP_55AA_H
#define FATHOM_DYP_55AA_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Encodes and decodes the `55 AA` frames of the A05 on RS-485, its "DYP protocol" (datasheet A05 2).
 *
 * The functions serve both the host and a simulated module. They are pure: they have no time, no I/O and no state. They
 * cannot detect all damage, because the sum of 8 bits lets one in 256 of the frames pass that are damaged in more than
 * one byte. include/COST.md has the flash of all of them (`dyp_55aa`). dyp_client.h sends these frames on a line.
 *
 *     request                55 AA ADDRESS COMMAND SUM                                    5 bytes
 *     response, all probes   55 AA ADDRESS 01 1H 1L 2H 2L 3H 3L 4H 4L SUM                13 bytes
 *     response, one probe    55 AA ADDRESS 10..13 H L SUM                                 7 bytes
 *     response, set address  55 AA ADDRESS 03 SUM                                         5 bytes
 *
 * H and L are the high and the low byte of a distance in mm. SUM is the low byte of the sum of all bytes before it.
 *
 * @code
 * uint8_t frame[FATHOM_DYP_MAX_RESPONSE];
 * const uint8_t length = fathom_dyp_55aa_encode_request(frame, 1, FATHOM_DYP_ALL_PROBES);    // 55 AA 01 01 01
 * if (fathom_dyp_55aa_is_valid(frame, length)) use(length);
 * @endcode
 *
 * @note The datasheet's tables and examples differ, and the examples are right. The sum of the response with four
 * distances is 62 (A05 2(3)3 prints 60). The command that sets the address is 03, with a response of 5 bytes (the table
 * of A05 2(3)5 prints 10 and a response with a distance).
 *
 * @warning The command that sets the address reaches every A05 of the line, because it contains the new address in
 * place of the old one. Its response equals the request. See a05_dyp.h, and rule 9 of line.h.
 */

/** @brief Commands. */
enum {
    FATHOM_DYP_ALL_PROBES = 0x01,  /**< Measure all four probes. */
    FATHOM_DYP_SET_ADDRESS = 0x03, /**< Set the address of every A05 of the line. */
    FATHOM_DYP_FIRST_PROBE = 0x10  /**< Measure probe 1. The next three commands measure probes 2 to 4. */
};

/** @brief Addresses and lengths. */
enum {
    /** Address of all units (A05 2(3)2). The datasheet does not state whether a unit responds to it. */
    FATHOM_DYP_ANY_ADDRESS = 0xFF,
    FATHOM_DYP_REQUEST_LENGTH = 5, /**< Length of every request in bytes. */
    FATHOM_DYP_MAX_RESPONSE = 13   /**< Length of the longest response in bytes. */
};

/** @brief Returns the length of the response to a command in bytes: 13, 7 or 5; 0 if there is no such command. */
uint8_t fathom_dyp_55aa_response_length(uint8_t command);

/** @brief Returns the number of distances in the response to a command: 4, 1 or 0. */
uint8_t fathom_dyp_55aa_value_count(uint8_t command);

/**
 * @brief Encodes a request.
 *
 * @param frame    Written: FATHOM_DYP_REQUEST_LENGTH bytes.
 * @param address  1 to 254, or FATHOM_DYP_ANY_ADDRESS. With FATHOM_DYP_SET_ADDRESS: the new address.
 * @param command  The command.
 * @return FATHOM_DYP_REQUEST_LENGTH.
 */
uint8_t fathom_dyp_55aa_encode_request(uint8_t *frame, uint8_t address, uint8_t command);

/**
 * @brief Returns the length of the response that begins with these bytes, as far as they determine it.
 *
 * A result above `have` is the number of bytes that the next call needs; it is 4 until the command has arrived. A
 * result up to `have` is the length of a complete response, whose sum is not checked yet.
 *
 * @param bytes  The received bytes.
 * @param have   Number of bytes, at least 1.
 * @retval 0  No response begins with these bytes: discard the first byte and try again.
 */
uint8_t fathom_dyp_55aa_frame_length(const uint8_t *bytes, uint8_t have);

/**
 * @brief Returns true if the last byte is the sum of the bytes before it.
 *
 * @param frame   The frame.
 * @param length  Length of the frame in bytes, at least 1.
 */
bool fathom_dyp_55aa_is_valid(const uint8_t *frame, uint8_t length);

/**
 * @brief Decodes the distances of a valid response.
 *
 * @param frame   The response.
 * @param values  Written: the 4, 1 or 0 values of the response in mm, as they were sent.
 */
void fathom_dyp_55aa_decode(const uint8_t *frame, uint16_t *values);

/**
 * @brief Encodes a response: the side of the module.
 *
 * @param frame    Written: up to FATHOM_DYP_MAX_RESPONSE bytes.
 * @param address  Address of the module, 1 to 254.
 * @param command  A command that exists.
 * @param values   fathom_dyp_55aa_value_count() distances in mm. Not used if that is 0.
 * @return The length of the response in bytes.
 */
uint8_t fathom_dyp_55aa_encode_response(uint8_t *frame, uint8_t address, uint8_t command,
                                        const uint16_t *values);

#ifdef __cplusplus
}
#endif

#endif
