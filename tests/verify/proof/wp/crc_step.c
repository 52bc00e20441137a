/* SPDX-License-Identifier: MIT */
/*
 * All 2^24 steps of the CRC, as the table of SOURCE makes them, against the definition, and what the axioms of CONTRACTS
 * and crc.h say of them. Built and run by wp.py with both names defined.
 */
#include CONTRACTS

#include <stdio.h>

#include SOURCE

#define entry(i) table[i]
#ifndef HALF_STEP
#define HALF_STEP(crc) 0u
#endif

/* MODBUS over Serial Line V1.02, 6.2.2: the byte into the low bits; eight shifts to the right, each with the
 * polynomial where a 1 falls out. */
static unsigned by_definition(unsigned crc, unsigned byte)
{
    crc ^= byte;
    for (int bit = 0; bit != 8; bit++) crc = ((crc & 1u) != 0u) ? ((crc >> 1) ^ 0xA001u) : (crc >> 1);
    return crc;
}

/* crc_step_low: the step ends in the byte `high` just where it began with `byte` below and `high` above. */
static int is_low(unsigned crc, unsigned byte, unsigned step)
{
    const unsigned high = crc >> 8;
    return (step <= 0xFFu) ? (crc == byte + 256u * step) : (crc != byte + 256u * high);
}

int main(void)
{
    unsigned long steps = 0;
    for (unsigned crc = 0; crc <= 0xFFFFu; crc++)
        for (unsigned byte = 0; byte <= 0xFFu; byte++, steps++) {
            const unsigned step = by_definition(crc, byte);
            if (STEP(crc, byte) != step || step > 0xFFFFu || !is_low(crc, byte, step) ||
                (crc ^ byte) > 0xFFFFu || HALF_STEP(crc) > 0xFFFFu) {
                (void)printf("crc 0x%04X, byte 0x%02X: wrong\n", crc, byte);
                return 1;
            }
        }
    (void)printf("%lu steps\n", steps);
    return fathom_crc16((const uint8_t *)"123456789", 9) != 0x4B37;
}
