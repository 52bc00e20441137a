/* SPDX-License-Identifier: MIT */
/* What bits.c proves, as axioms: provers get lost in what else stands there. wp.py sees that each is there. */
#ifndef FATHOM_PROOF_FACTS_H
#define FATHOM_PROOF_FACTS_H

#include <stdint.h>

/*@ axiomatic facts {
    axiom bytes_of_register: \forall uint16_t x; 0 <= (x >> 8) < 256 && 256 * (x >> 8) + (uint8_t)x == x;
    axiom below_zero: \forall integer x; -256 <= x < 0 ==> (uint8_t)x == x + 256;
    axiom without_top_bit: \forall integer x; 0 <= x < 256 ==> (x & 127) == x % 128;
    axiom with_top_bit: \forall integer x; 0 <= x < 256 ==> (x | 128) == (x < 128 ? x + 128 : x);
    axiom odd: \forall integer x; 0 <= x < 256 ==> (x & 1) == x % 2;
} */

#endif
