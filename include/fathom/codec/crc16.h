/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_CRC16_H
#define FATHOM_CRC16_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief The checksum of Modbus RTU: CRC-16/MODBUS (MODBUS over Serial Line V1.02, 6.2.2; HPS-167S 2.2.5).
 *
 * The polynomial is 0xA001 (0x8005 reflected), and the initial value is 0xFFFF. The low byte goes first on the wire.
 * The function is pure: it has no state and needs no time or I/O. Link exactly one of these sources; include/COST.md
 * has their sizes.
 *
 * | source | table | for |
 * |---|---|---|
 * | src/codec/crc16.c | 256 entries, 512 bytes | fastest |
 * | src/codec/crc16_small.c | 16 entries, 32 bytes | least flash |
 * | port/avr/crc16.c | none; 30 cycles a byte | AVR, where avr-gcc would put a table in RAM |
 * | port/avr/crc16_table.c | 256 entries in program memory; 24 cycles a byte | AVR |
 *
 * @code
 * if (fathom_crc16(frame, length) == 0) handle(frame);      // the last two bytes of the frame are its CRC
 * @endcode
 */

/**
 * @brief Returns the CRC of `length` bytes. The CRC of a frame that ends in its own right CRC is 0.
 *
 * @param bytes   The bytes. May be NULL if `length` is 0.
 * @param length  Number of bytes, 0 to 255. 0 returns 0xFFFF.
 */
uint16_t fathom_crc16(const uint8_t *bytes, uint8_t length);

#ifdef __cplusplus
}
#endif

#endif
