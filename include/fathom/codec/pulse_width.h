/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_PULSE_WIDTH_H
#define FATHOM_PULSE_WIDTH_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Converts the width of a pulse, the time of sound to a target and back, to a distance in millimetres (A16
 * 1(4)).
 *
 * The functions are pure, and use whole numbers only. include/COST.md has their size in the row `pulse_width`. A
 * program that calls one of them links only that one.
 *
 * The datasheet prints two formulas that differ by 0.05 %, which is 8 mm at 94 ms. One is the speed of sound 348 m/s.
 * The other is S[cm] = T[us] / 57.5, which is 347.83 m/s. The example of the datasheet, 10000 us = 173.9 cm, follows
 * the second formula (the first gives 174.0), and so does Fathom.
 */

/** @brief Greatest distance that a function returns, in millimetres. Longer pulses return it too. */
#define FATHOM_PULSE_WIDTH_MAX_MM UINT16_MAX

/** @brief Temperatures of fathom_pulse_width_mm_in_air(), in tenths of a degree Celsius. */
enum {
    FATHOM_PULSE_WIDTH_MIN_AIR_DC = -400, /**< Coldest air: -40 degrees C. */
    FATHOM_PULSE_WIDTH_MAX_AIR_DC = 850   /**< Hottest air: 85 degrees C. */
};

/** @brief Scales of fathom_pulse_width_mm(). */
enum { FATHOM_PULSE_WIDTH_A16_US_PER_DM = 575 /**< A16: 57.5 us for each centimetre (A16 1(4)). */ };

/**
 * @brief Returns the distance in millimetres by the scale of a model: width_us * 100 / us_per_dm, rounded to the
 * nearest (a half upwards).
 *
 * @param width_us   Width of the pulse in microseconds, any value. A distance above 65535 mm returns 65535.
 * @param us_per_dm  Width for each 100 mm, in microseconds: 1 to 6000. 575 is the formula of the A16. 0 returns 65535.
 */
uint16_t fathom_pulse_width_mm(uint32_t width_us, uint16_t us_per_dm);

/**
 * @brief Returns the distance in millimetres in air of a known temperature, rounded to the nearest (a half upwards).
 *
 * The speed of sound is 331.3 + 0.606 * t m/s at t degrees C; this formula is not in the datasheet. At 27.3 degrees C
 * the result differs from the formula of the A16 by at most 1 mm.
 *
 * @param width_us  Width of the pulse in microseconds, any value. A distance above 65535 mm returns 65535.
 * @param air_dc    Temperature in tenths of a degree C, -400 to 850. A value outside counts as the nearer end.
 */
uint16_t fathom_pulse_width_mm_in_air(uint32_t width_us, int16_t air_dc);

#ifdef __cplusplus
}
#endif

#endif
