/* SPDX-License-Identifier: MIT */
/* What fathom/codec/pulse_width.h says, as contracts. */
#include <stdint.h>

/*@ logic integer up_to(integer mm) = mm < 65535 ? mm : 65535;

    // 0.1 mm/s in air of so many tenths of a degree: 331.3 + 0.606 * degC m/s.
    logic integer speed(integer air_dc) = 3313000 + 606 * (air_dc < -400 ? -400 : air_dc > 850 ? 850 : air_dc);

    lemma quotient_of_parts: \forall integer q, rest, d; d > 0 && rest >= 0 && q >= 0 ==>
        (q * d + rest) / d == q + rest / d;
*/

/*@ assigns \nothing;
    ensures \result == (a < b ? a : b);
*/
static uint32_t least(uint32_t a, uint32_t b);

/*@ assigns \nothing;
    ensures \result == up_to(mm);
*/
static uint16_t bounded_mm(uint32_t mm);

/*@ assigns \nothing;
    ensures formula: 1 <= us_per_dm <= 6000 ==> \result == up_to((100 * width_us + us_per_dm / 2) / us_per_dm);
    ensures none: us_per_dm == 0 ==> \result == 65535;
*/
uint16_t fathom_pulse_width_mm(uint32_t width_us, uint16_t us_per_dm);

/*@ assigns \nothing;
    ensures formula: \result == up_to((speed(air_dc) * width_us + 10000000) / 20000000);
*/
uint16_t fathom_pulse_width_mm_in_air(uint32_t width_us, int16_t air_dc);
