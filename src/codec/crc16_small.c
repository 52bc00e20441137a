/* SPDX-License-Identifier: MIT */
#include "fathom/codec/crc16.h"

/*
 * CRC-16/MODBUS with a table of 16 entries, two steps for each byte. It is the smallest of the four sources
 * that crc16.h names.
 */

/* The result of four shifts by one bit, for each low nibble. */
static const uint16_t table[16] = {
    0x0000, 0xCC01, 0xD801, 0x1400, 0xF001, 0x3C00, 0x2800, 0xE401,
    0xA001, 0x6C00, 0x7800, 0xB401, 0x5000, 0x9C01, 0x8801, 0x4400,
};

uint16_t fathom_crc16(const uint8_t *bytes, uint8_t length)
{
    unsigned crc = 0xFFFF;
    for (; length != 0u; length--) {
        crc ^= *bytes;
        bytes++;
        crc = (crc >> 4) ^ table[crc & 15u];
        crc = (crc >> 4) ^ table[crc & 15u];
    }
    return (uint16_t)crc;
}
