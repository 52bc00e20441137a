/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_PULSE_WIDTH_H
#define FATHOM_PULSE_WIDTH_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/*
 * From the width of a pulse, which is the time that sound takes to a target and back, to the distance in mm. Pure
 * functions: no time, no I/O, no state, integers only.
 *
 * A16 1(4) gives two formulas that differ by 0.05 %, 8 mm at 94 ms: the speed of sound 348 m/s, and S[cm] =
 * T[us] / 57.5, which is 347.83 m/s. Its example, 10000 us = 173.9 cm, follows the second (the first gives 174.0),
 * and so does Fathom.
 */

/* The longest distance that a result can be; longer widths give it too. */
#define FATHOM_PULSE_WIDTH_MAX_MM UINT16_MAX

/* The air that fathom_pulse_width_mm_in_air can calculate with, in tenths of a degree C. */
enum { FATHOM_PULSE_WIDTH_MIN_AIR_DC = -400, FATHOM_PULSE_WIDTH_MAX_AIR_DC = 850 };

/*
 * width_us * 4 / 23, which is width_us / 57.5 in cm (A16 1(4)), rounded to the nearest mm; there are no ties, 23
 * being odd. width_us: any; from 376830 us on the result is 65535.
 */
uint16_t fathom_pulse_width_mm(uint32_t width_us);

/*
 * The same with the speed of sound in air of this temperature, 331.3 + 0.606 * degC m/s (not in the datasheet),
 * rounded to the nearest mm, a half up. air_dc: tenths of a degree C, -400..850; what is beyond counts as the nearer
 * end. At 27.3 degC it agrees with the other one to 1 mm. width_us: any; what is longer than 65535 mm gives 65535.
 */
uint16_t fathom_pulse_width_mm_in_air(uint32_t width_us, int16_t air_dc);

#ifdef __cplusplus
}
#endif

#endif
