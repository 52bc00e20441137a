/* SPDX-License-Identifier: MIT */
/* What bits of registers and of their pairs are, as bits.c has it of bytes; hps167s_registers.h has it as axioms. */
#include <stdint.h>

/*@
    lemma both_ones: \forall uint16_t x, y; (x & y) == 65535 <==> (x == 65535 && y == 65535);
    lemma high_word: \forall uint32_t x; (uint16_t)(x >> 16) == (x >> 16);
    lemma shifted_up: \forall uint16_t x, integer n; 0 <= n <= 16 ==> (x << n) <= 0xFFFF0000;
    lemma shifted_not_below: \forall uint16_t x, integer n; 0 <= n <= 16 ==> 0 <= (x << n);
*/
