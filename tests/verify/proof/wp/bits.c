/* SPDX-License-Identifier: MIT */
/* What bits of bytes and of registers are in numbers: proved here once. What the codecs' proofs need of it stands again
 * in facts.h, as axioms; wp.py sees that each is a lemma here, by its text. */
#include <stdint.h>

/*@
    logic integer shift_1(integer x) = x >> 1;
    logic integer shift_2(integer x) = x >> 2;
    logic integer shift_4(integer x) = x >> 4;
    lemma shift_1_halves: \forall uint16_t x; shift_1(x) == x / 2;
    lemma shift_2_composed: \forall uint16_t x; shift_1(shift_1(x)) == shift_2(x);
    lemma shift_2_quarters: \forall uint16_t x; shift_2(x) == x / 4;
    lemma shift_4_composed: \forall uint16_t x; shift_2(shift_2(x)) == shift_4(x);
    lemma shift_4_sixteenths: \forall uint16_t x; shift_4(x) == x / 16;
    lemma shift_8_composed: \forall uint16_t x; shift_4(shift_4(x)) == (x >> 8);
    lemma high_byte: \forall uint16_t x; (x >> 8) == x / 256;

    lemma low_byte: \forall integer x; 0 <= x ==> (uint8_t)x == x % 256;
    lemma below_zero: \forall integer x; -256 <= x < 0 ==> (uint8_t)x == x + 256;

    lemma bytes_of_register: \forall uint16_t x; 0 <= (x >> 8) < 256 && 256 * (x >> 8) + (uint8_t)x == x;

    lemma without_top_bit: \forall integer x; 0 <= x < 256 ==> (x & 127) == x % 128;
    lemma with_top_bit: \forall integer x; 0 <= x < 256 ==> (x | 128) == (x < 128 ? x + 128 : x);
    lemma odd: \forall integer x; 0 <= x < 256 ==> (x & 1) == x % 2;
*/
