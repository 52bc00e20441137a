/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_CRC16_H
#define FATHOM_CRC16_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/*
 * CRC-16/MODBUS (MODBUS over Serial Line V1.02, 6.2.2; HPS-167S 2.2.5): polynomial 0xA001 (reflected
 * 0x8005), initial value 0xFFFF. On the wire its low byte goes first.
 *
 * Over a frame that ends in its own CRC the result is 0, which is how a receiver checks one.
 *
 * Link exactly one of: src/codec/crc16.c (256-entry table, 512 bytes, fastest), src/codec/crc16_small.c (16 entries,
 * 32 bytes). avr-gcc would put those in RAM: on an AVR port/avr/crc16.c (no table, 30 cycles a byte) or
 * port/avr/crc16_table.c (256 entries in program memory, 24 cycles a byte).
 *
 * bytes: may be NULL when length is 0, which gives 0xFFFF.
 */
uint16_t fathom_crc16(const uint8_t *bytes, uint8_t length);

#ifdef __cplusplus
}
#endif

#endif
