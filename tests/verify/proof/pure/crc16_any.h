/* SPDX-License-Identifier: MIT */
#ifndef CRC16_ANY_H
#define CRC16_ANY_H

#include "assumptions.h"
#include "fathom/codec/crc16.h"

/* For both tables. Bytes that can be any, and behind the last one no memory. */
int main(void)
{
    static uint8_t bytes[UINT8_MAX];
    any_memory(bytes, sizeof bytes);
    /*@ loop unroll 256; */
    for (unsigned length = 0; length <= UINT8_MAX; length++)
        (void)fathom_crc16(bytes + UINT8_MAX - length, (uint8_t)length);
    (void)fathom_crc16(NULL, 0); /* "may be NULL when length is 0" */
    return 0;
}

#endif
