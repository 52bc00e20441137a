/* SPDX-License-Identifier: MIT */
/* The CRC of Modbus without a table, by the routine of avr-libc. It replaces src/codec/crc16.c. */
#include "fathom/codec/crc16.h"

#include <util/crc16.h>

/* _crc16_update() of avr-libc has the same polynomial in 29 instructions without a table. avr-gcc would put a constant
 * table into RAM. */
uint16_t fathom_crc16(const uint8_t *bytes, uint8_t length)
{
    uint16_t crc = 0xFFFFu;
    for (; length != 0u; length--) {
        crc = _crc16_update(crc, *bytes);
        bytes++;
    }
    return crc;
}
