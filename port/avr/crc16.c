/* SPDX-License-Identifier: MIT */
/* The CRC of Modbus without a table, by the routine of avr-libc. It replaces src/codec/crc16.c. */
#include "fathom/codec/crc16.h"

#include <util/crc16.h>

/* avr-libc's _crc16_update is the same polynomial in 29 instructions without a table: no flash for one, and
 * no RAM, where avr-gcc would put a const table. */
uint16_t fathom_crc16(const uint8_t *bytes, uint8_t length)
{
    uint16_t crc = 0xFFFFu;
    for (; length != 0u; length--) {
        crc = _crc16_update(crc, *bytes);
        bytes++;
    }
    return crc;
}
