/* SPDX-License-Identifier: MIT */
/* What the table of crc16_small.c is worth. STEP is what its loop does with a byte, in two halves; crc_step.c sees that
 * the axioms hold. */
#include "crc.h"

#define HALF_STEP(crc)  (((crc) >> 4) ^ entry((crc)&15))
#define STEP(crc, byte) HALF_STEP(HALF_STEP((crc) ^ (byte)))

static const uint16_t table[16];

/*@ axiomatic table_is {
        logic integer entry(integer i); // of the table: no axiom on the table itself, which would be one on any memory
        axiom table_steps: \forall integer crc, value; 0 <= crc <= 0xFFFF && 0 <= value <= 0xFF ==>
            STEP(crc, value) == crc_step(crc, value) && 0 <= (crc ^ value) <= 0xFFFF && 0 <= HALF_STEP(crc ^ value) <= 0xFFFF;
    } */

/*@ requires \forall integer i; 0 <= i ==> table[i & 15] == entry(i & 15); */
uint16_t fathom_crc16(const uint8_t *bytes, uint8_t length);
