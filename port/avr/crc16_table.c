/* SPDX-License-Identifier: MIT */
/* The CRC of Modbus with a table of 256 entries in program memory. It replaces crc16.c of this folder. */
#include "fathom/codec/crc16.h"

#include <avr/pgmspace.h>

/* The table has the effect of eight shifts by one bit on each low byte: the sum of the effects on each of its bits. */
#define OF_BIT(n, bit, sum) ((((n) & (bit)) != 0u) ? (sum) : 0u)
#define OF(n)                                                                                                \
    (uint16_t)(OF_BIT(n, 1u, 0xC0C1u) ^ OF_BIT(n, 2u, 0xC181u) ^ OF_BIT(n, 4u, 0xC301u) ^                    \
               OF_BIT(n, 8u, 0xC601u) ^ OF_BIT(n, 16u, 0xCC01u) ^ OF_BIT(n, 32u, 0xD801u) ^                  \
               OF_BIT(n, 64u, 0xF001u) ^ OF_BIT(n, 128u, 0xA001u))
#define OF_4(n)  OF(n), OF((n) + 1u), OF((n) + 2u), OF((n) + 3u)
#define OF_16(n) OF_4(n), OF_4((n) + 4u), OF_4((n) + 8u), OF_4((n) + 12u)
#define OF_64(n) OF_16(n), OF_16((n) + 16u), OF_16((n) + 32u), OF_16((n) + 48u)

/* The table is in program memory: 512 bytes of flash, and no RAM. */
static const uint16_t table[256] PROGMEM = {OF_64(0u), OF_64(64u), OF_64(128u), OF_64(192u)};

uint16_t fathom_crc16(const uint8_t *bytes, uint8_t length)
{
    uint16_t crc = 0xFFFFu;
    for (; length != 0u; length--) {
        crc = (uint16_t)((crc >> 8) ^ pgm_read_word(&table[(uint8_t)crc ^ *bytes]));
        bytes++;
    }
    return crc;
}
