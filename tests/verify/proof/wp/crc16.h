/* SPDX-License-Identifier: MIT */
/* What the table of crc16.c is worth. STEP is what its loop does with a byte; crc_step.c sees that the axioms hold. */
#include "crc.h"

#define STEP(crc, byte) (((crc) >> 8) ^ entry(((crc) ^ (byte)) & 0xFF))

static const uint16_t table[256];

/*@ axiomatic table_is {
        logic integer entry(integer i); // of the table: no axiom on the table itself, which would be one on any memory
        axiom table_steps: \forall integer crc, value; 0 <= crc <= 0xFFFF && 0 <= value <= 0xFF ==>
            STEP(crc, value) == crc_step(crc, value) && 0 <= (crc ^ value) <= 0xFFFF;
    } */

/*@ requires \forall integer i; 0 <= i ==> table[i & 0xFF] == entry(i & 0xFF); */
uint16_t fathom_crc16(const uint8_t *bytes, uint8_t length);
