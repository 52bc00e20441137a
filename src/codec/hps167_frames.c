/* SPDX-License-Identifier: MIT */
/*
 * Encodes and decodes the frames of an HPS-167 with a UART.
 */
#include "fathom/codec/hps167_frames.h"

enum { START = 0x0A };

/* Offsets in a frame. */
enum { COMMAND = 1, SIZE = 1, FIRST = 2, DATA = 2, DISTANCE = 5 };

/* Numbers of bytes behind the second byte of a response, with the CRC. */
enum { CRC_SIZE = 2, ACK_SIZE = 3, TEMPERATURE_SIZE = 4, MEASUREMENT_SIZE = 13 };

enum { MEASUREMENT_REGISTERS = 4 };

/* Each byte: x^16 = x^12 + x^5 + 1, applied to its 8 bits at once. The first line folds the upper four bits, which the
 * term x^12 moves onto the lower four. */
uint16_t fathom_hps167_crc(const uint8_t *bytes, uint8_t length)
{
    uint16_t crc = 0xFFFF;
    for (; length != 0u; length--) {
        uint8_t top = (uint8_t)((crc >> 8) ^ *bytes);
        top = (uint8_t)(top ^ (top >> 4));
        crc = (uint16_t)(((uint32_t)crc << 8) ^ ((uint32_t)top << 12) ^ ((uint32_t)top << 5) ^ top);
        bytes++;
    }
    return crc;
}

uint8_t fathom_hps167_response_length(uint8_t command)
{
    if ((command == FATHOM_HPS167_SINGLE) || (command == FATHOM_HPS167_CONTINUOUS))
        return DATA + MEASUREMENT_SIZE;
    if (command == FATHOM_HPS167_STOP) return DATA + ACK_SIZE;
    if (command == FATHOM_HPS167_TEMPERATURE) return DATA + TEMPERATURE_SIZE;
    return 0;
}

/* Writes the CRC of the bytes from `from` up to `end` behind them. */
static void seal(const uint8_t *from, uint8_t *end)
{
    const uint16_t crc = fathom_hps167_crc(from, (uint8_t)(end - from));
    end[0] = (uint8_t)(crc >> 8);
    end[1] = (uint8_t)crc;
}

uint8_t fathom_hps167_encode_request(uint8_t *frame, uint8_t command)
{
    const bool is_first_1 = (command == FATHOM_HPS167_STOP) || (command == FATHOM_HPS167_TEMPERATURE);
    frame[0] = START;
    frame[COMMAND] = command;
    frame[FIRST] = is_first_1 ? 1 : 0;
    frame[FIRST + 1] = 0;
    frame[FIRST + 2] = 0;
    frame[FIRST + 3] = 0;
    frame[FIRST + 4] = 0;
    frame[FIRST + 5] = 0;
    seal(frame, &frame[FATHOM_HPS167_REQUEST_LENGTH - CRC_SIZE]);
    return FATHOM_HPS167_REQUEST_LENGTH;
}

uint8_t fathom_hps167_frame_length(const uint8_t *bytes, uint8_t have)
{
    if (bytes[0] != START) return 0;
    if (have <= SIZE) return SIZE + 1;
    const uint8_t size = bytes[SIZE];
    const bool is_response = (size == MEASUREMENT_SIZE) || (size == TEMPERATURE_SIZE) || (size == ACK_SIZE);
    return is_response ? (uint8_t)(DATA + size) : 0u;
}

bool fathom_hps167_is_valid(const uint8_t *frame, uint8_t length)
{
    const uint8_t from = (length == FATHOM_HPS167_REQUEST_LENGTH) ? 0u : (uint8_t)DATA;
    const uint8_t end = (uint8_t)(length - CRC_SIZE);
    const uint16_t crc = fathom_hps167_crc(&frame[from], (uint8_t)(end - from));
    return (frame[end] == (uint8_t)(crc >> 8)) && (frame[end + 1] == (uint8_t)crc);
}

void fathom_hps167_decode(const uint8_t *frame, uint16_t *values)
{
    const uint8_t *at = &frame[DATA];
    uint8_t left = 1;
    if (frame[SIZE] == ACK_SIZE) {
        *values = *at;
        return;
    }
    if (frame[SIZE] == MEASUREMENT_SIZE) {
        at = &frame[DISTANCE];
        left = MEASUREMENT_REGISTERS;
    }
    for (; left != 0u; left--) {
        *values = (uint16_t)((at[0] * 256u) + at[1]);
        at += 2;
        values++;
    }
}

uint8_t fathom_hps167_encode_response(uint8_t *frame, const uint8_t *data, uint8_t count)
{
    frame[0] = START;
    frame[SIZE] = (uint8_t)(count + CRC_SIZE);
    for (uint8_t i = 0; i != count; i++) frame[DATA + i] = data[i];
    seal(&frame[DATA], &frame[DATA + count]);
    return (uint8_t)(DATA + count + CRC_SIZE);
}
