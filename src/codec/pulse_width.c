/* SPDX-License-Identifier: MIT */
#include "fathom/codec/pulse_width.h"

/* The width of a pulse as a distance. Both functions calculate with whole numbers of at most 32 bits. */

/* This width is more than 65535 mm at any temperature, and the products below stay within 32 bits. */
#define LONGEST_IN_AIR_US 500000uL

/* This width is more than 65535 mm at 6000 us for each 100 mm, and 100 times it stays within 32 bits. */
#define LONGEST_US 4000000uL

static uint32_t least(uint32_t a, uint32_t b) { return (a < b) ? a : b; }

static uint16_t bounded_mm(uint32_t mm)
{
    return (mm < FATHOM_PULSE_WIDTH_MAX_MM) ? (uint16_t)mm : FATHOM_PULSE_WIDTH_MAX_MM;
}

uint16_t fathom_pulse_width_mm(uint32_t width_us, uint16_t us_per_dm)
{
    if (us_per_dm == 0u) return FATHOM_PULSE_WIDTH_MAX_MM;
    return bounded_mm(((least(width_us, LONGEST_US) * 100u) + (us_per_dm / 2u)) / us_per_dm);
}

/*
 * The speed v, in units of 0.1 mm/s, is 3313000 + 606 for each tenth of a degree, which is 3070600 at -40 degrees C.
 * The sound goes there and back, so the distance in mm is v * us / (2 * 10^7). The product v * us has up to 41 bits.
 * The function therefore calculates in two parts: v = 1000 * v1 + v0.
 */
uint16_t fathom_pulse_width_mm_in_air(uint32_t width_us, int16_t air_dc)
{
    if (air_dc < FATHOM_PULSE_WIDTH_MIN_AIR_DC) air_dc = FATHOM_PULSE_WIDTH_MIN_AIR_DC;
    if (air_dc > FATHOM_PULSE_WIDTH_MAX_AIR_DC) air_dc = FATHOM_PULSE_WIDTH_MAX_AIR_DC;
    const uint32_t us = least(width_us, LONGEST_IN_AIR_US);
    const uint32_t v =
        UINT32_C(3070600) + (UINT32_C(606) * (uint16_t)(air_dc - FATHOM_PULSE_WIDTH_MIN_AIR_DC));
    const uint32_t high = us * (v / 1000u);
    const uint32_t low = us * (v % 1000u);
    const uint32_t mm = high / 20000u;
    const uint32_t rest = ((high - (mm * 20000u)) * 1000u) + low;
    return bounded_mm(mm + ((rest + 10000000u) / 20000000u));
}
