/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HPS167_FRAMES_H
#define FATHOM_HPS167_FRAMES_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Encodes and decodes the frames of an HPS-167 or HPS-166 with a UART.
 *
 * The functions serve both the host and a simulated sensor. They are pure: they have no time, no I/O and no state.
 * include/COST.md has the flash of all of them (`hps167_frames`). The driver hps167_uart.h sends these frames on a line.
 *
 *     request                 0A COMMAND FIRST 00 00 00 00 00 CRC_H CRC_L     10 bytes; the CRC is over the first 8
 *     response, measurement   0A 0D r r r D D M M E A P P CRC_H CRC_L         15 bytes
 *     response, temperature   0A 04 H L CRC_H CRC_L                            6 bytes
 *     response, stop          0A 03 ACK CRC_H CRC_L                            5 bytes
 *
 * The second byte of a response is the number of bytes behind it, and the CRC is over the bytes between this number and
 * the CRC. The CRC is CRC-16/CCITT-FALSE: polynomial 0x1021, initial value 0xFFFF, high byte first. `D D M M E A P P`
 * are the 8 bytes of command #5 of the HPS-167S (hps167s_registers.h). What the three bytes `r r r` mean is not certain;
 * a program of 2016 names them the interrupt flag, the interrupt mode and the zone mode. They are 01 01 01 in the example
 * for the CRC that the datasheet of the HPS-167S prints, which has eleven such bytes. The functions accept any.
 *
 * @code
 * uint8_t frame[FATHOM_HPS167_MEASUREMENT_LENGTH];
 * const uint8_t length = fathom_hps167_encode_request(frame, FATHOM_HPS167_SINGLE);  // 0A 22 00 00 00 00 00 00 AE 57
 * if (fathom_hps167_is_valid(frame, length)) send(frame, length);
 * @endcode
 *
 * @note The facts come from public programs for these sensors, not from a datasheet. One of them prints the command to
 * stop with 00 in place of 01 and a CRC that fits 01; these functions send 01.
 */

/** @brief Commands that change no setting. The sensor has others, which no function of this library sends. */
enum {
    FATHOM_HPS167_SINGLE = 0x22,     /**< Measure once. */
    FATHOM_HPS167_CONTINUOUS = 0x24, /**< Measure again and again, and send each measurement. */
    FATHOM_HPS167_STOP = 0x30,       /**< Stop the continuous measurement. FIRST is 01. */
    FATHOM_HPS167_TEMPERATURE = 0x3F /**< Return the temperature of the analog front end. FIRST is 01. */
};

/** @brief Lengths of frames in bytes, and the values of ACK. */
enum {
    FATHOM_HPS167_REQUEST_LENGTH = 10,     /**< Every request. */
    FATHOM_HPS167_MEASUREMENT_LENGTH = 15, /**< A measurement, which is the longest response. */
    FATHOM_HPS167_REFUSED = 0,             /**< ACK: the sensor refused the command. */
    FATHOM_HPS167_DONE = 1                 /**< ACK: the sensor executed the command. */
};

/**
 * @brief Returns the CRC-16/CCITT-FALSE of `length` bytes, computed without a table.
 *
 * @param bytes   The bytes.
 * @param length  Number of bytes, 0 to 255.
 */
uint16_t fathom_hps167_crc(const uint8_t *bytes, uint8_t length);

/** @brief Returns the length of the response to a command in bytes: 15, 6 or 5; 0 if this file has no such command. */
uint8_t fathom_hps167_response_length(uint8_t command);

/**
 * @brief Encodes a request.
 *
 * @param frame    Written: FATHOM_HPS167_REQUEST_LENGTH bytes.
 * @param command  The command.
 * @return FATHOM_HPS167_REQUEST_LENGTH.
 */
uint8_t fathom_hps167_encode_request(uint8_t *frame, uint8_t command);

/**
 * @brief Returns the length of the response that begins with these bytes, as far as they determine it.
 *
 * A result above `have` is the number of bytes that the next call needs; it is 2 until the second byte has arrived. A
 * result up to `have` is the length of a complete response, whose CRC is not checked yet.
 *
 * @param bytes  The received bytes.
 * @param have   Number of bytes, at least 1.
 * @retval 0  No response begins with these bytes: discard the first byte and try again.
 */
uint8_t fathom_hps167_frame_length(const uint8_t *bytes, uint8_t have);

/**
 * @brief Returns true if the last two bytes are the CRC of a request (of 10 bytes) or of a response (of another length).
 *
 * @param frame   The frame.
 * @param length  Length of the frame in bytes, at least 4.
 */
bool fathom_hps167_is_valid(const uint8_t *frame, uint8_t length);

/**
 * @brief Decodes the registers of a valid response.
 *
 * | response    | written to `values`                                                                  |
 * |-------------|--------------------------------------------------------------------------------------|
 * | measurement | 4 registers, as fathom_hps167s_decode() of hps167s_registers.h needs them            |
 * | temperature | 1 register                                                                           |
 * | stop        | 1 register: FATHOM_HPS167_DONE or FATHOM_HPS167_REFUSED                              |
 *
 * @param frame   The response.
 * @param values  Written: 4 registers or 1.
 */
void fathom_hps167_decode(const uint8_t *frame, uint16_t *values);

/**
 * @brief Encodes a response: the side of the sensor.
 *
 * @param frame  Written: `count` + 4 bytes.
 * @param data   The bytes between the length and the CRC.
 * @param count  Number of these bytes, 1 to 251.
 * @return The length of the response in bytes.
 */
uint8_t fathom_hps167_encode_response(uint8_t *frame, const uint8_t *data, uint8_t count);

#ifdef __cplusplus
}
#endif

#endif
