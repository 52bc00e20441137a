/* SPDX-License-Identifier: MIT */
/*
 * CRC-16/MODBUS as it is defined (MODBUS over Serial Line V1.02, 6.2.2), over the step of a byte. What a step is, bit by
 * bit, stands in crc_step.c, which runs through all 2^24 pairs of a CRC and a byte and sees that the axioms on
 * crc_step below, and those of crc16.h and crc16_small.h, hold for each.
 */
#ifndef FATHOM_PROOF_CRC_H
#define FATHOM_PROOF_CRC_H

#include "logic.h"

/*@ axiomatic crc_step_is {
        // Of the low 16 bits of crc and the low 8 of byte.
        logic integer crc_step(integer crc, integer byte);
        axiom crc_step_range: \forall integer crc, byte; 0 <= crc_step(crc, byte) <= 0xFFFF;
        axiom crc_step_low: \forall integer crc, byte, high;
            0 <= crc <= 0xFFFF && 0 <= byte <= 0xFF && 0 <= high <= 0xFF ==>
            (crc_step(crc, byte) == high <==> crc == byte + 256 * high);
    }

    axiomatic crc_is {
        logic integer crc_of{L}(uint8_t *bytes, integer length) reads bytes[0 .. length - 1];
        axiom crc_of_none{L}: \forall uint8_t *bytes; crc_of(bytes, 0) == 0xFFFF;
        axiom crc_of_next{L}: \forall uint8_t *bytes, integer n, m; 0 <= n && m == n + 1 ==>
            crc_of(bytes, m) == crc_step(crc_of(bytes, n), bytes[n]);
    }

    lemma crc_of_same_bytes{K, L}: \forall uint8_t *bytes, integer n; 0 <= n &&
        (\forall integer i; 0 <= i < n ==> \at(bytes[i], K) == \at(bytes[i], L)) ==>
            crc_of{K}(bytes, n) == crc_of{L}(bytes, n);

    predicate ends_in_crc{L}(uint8_t *frame, integer length) =
        frame[length - 2] + 256 * frame[length - 1] == crc_of(frame, length - 2);
*/

/*@ requires \valid_read(bytes + (0 .. length - 1));
    assigns \nothing;
    ensures \result == crc_of(bytes, length);
*/
uint16_t fathom_crc16(const uint8_t *bytes, uint8_t length);

#endif
