/* SPDX-License-Identifier: MIT */
/*
 * What the contracts of the codecs are made of: registers as pairs of bytes, the sum, the CRC. What stands
 * here as a lemma is a goal of its own, proved first in this order.
 */
#ifndef FATHOM_PROOF_LOGIC_H
#define FATHOM_PROOF_LOGIC_H

#include "facts.h"

/*@
    // ---- registers in a frame: the high byte first ----

    predicate registers{L}(uint8_t *at, uint16_t *values, integer count) =
        \forall integer i; 0 <= i < count ==> values[i] == 256 * at[2 * i] + at[2 * i + 1];

    // ---- the sum of A16 and A05: its low byte. Defined by recursion; as two equations, because provers unfold a
    // recursive definition for ever ----

    axiomatic sum_is {
        logic integer sum_of{L}(uint8_t *bytes, integer length) reads bytes[0 .. length - 1];
        axiom sum_of_none{L}: \forall uint8_t *bytes; sum_of(bytes, 0) == 0;
        axiom sum_of_next{L}: \forall uint8_t *bytes, integer n, m; 0 <= n && m == n + 1 ==>
            sum_of(bytes, m) == (uint8_t)(sum_of(bytes, n) + bytes[n]);
    }

    lemma sum_of_same_bytes{K, L}: \forall uint8_t *bytes, integer n; 0 <= n &&
        (\forall integer i; 0 <= i < n ==> \at(bytes[i], K) == \at(bytes[i], L)) ==>
            sum_of{K}(bytes, n) == sum_of{L}(bytes, n);
*/

#endif
