/* SPDX-License-Identifier: MIT */
#include "fathom/codec/crc16.h"

#include <avr/pgmspace.h>

/* What eight shifts by one bit do to each low byte. It is the sum of what they do to each of its bits. */
#define OF(n)                                                                                                \
    (uint16_t)(((n)&1 ? 0xC0C1u : 0) ^ ((n)&2 ? 0xC181u : 0) ^ ((n)&4 ? 0xC301u : 0) ^                       \
               ((n)&8 ? 0xC601u : 0) ^ ((n)&16 ? 0xCC01u : 0) ^ ((n)&32 ? 0xD801u : 0) ^                     \
               ((n)&64 ? 0xF001u : 0) ^ ((n)&128 ? 0xA001u : 0))
#define OF_4(n)  OF(n), OF((n) + 1), OF((n) + 2), OF((n) + 3)
#define OF_16(n) OF_4(n), OF_4((n) + 4), OF_4((n) + 8), OF_4((n) + 12)
#define OF_64(n) OF_16(n), OF_16((n) + 16), OF_16((n) + 32), OF_16((n) + 48)

/* In program memory: 512 bytes of flash, and none of RAM. */
static const uint16_t table[256] PROGMEM = {OF_64(0), OF_64(64), OF_64(128), OF_64(192)};

uint16_t fathom_crc16(const uint8_t *bytes, uint8_t length)
{
    uint16_t crc = 0xFFFFu;
    for (; length != 0u; length--)
        crc = (uint16_t)((crc >> 8) ^ pgm_read_word(&table[(uint8_t)crc ^ *bytes++]));
    return crc;
}
