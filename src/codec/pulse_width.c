/* SPDX-License-Identifier: MIT */
#include "fathom/codec/pulse_width.h"

/* The width of a pulse as a distance. Both functions calculate with whole numbers of at most 32 bits. */

/* This width is more than 65535 mm at any temperature, and the products below stay within 32 bits. */
#define LONGEST_US 500000uL

static uint32_t bounded_us(uint32_t width_us) { return (width_us < LONGEST_US) ? width_us : LONGEST_US; }

static uint16_t bounded_mm(uint32_t mm)
{
    return (mm < FATHOM_PULSE_WIDTH_MAX_MM) ? (uint16_t)mm : FATHOM_PULSE_WIDTH_MAX_MM;
}

uint16_t fathom_pulse_width_mm(uint32_t width_us)
{
    return bounded_mm(((bounded_us(width_us) * 4u) + 11u) / 23u);
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
    const uint32_t us = bounded_us(width_us);
    const uint32_t v =
        UINT32_C(3070600) + (UINT32_C(606) * (uint16_t)(air_dc - FATHOM_PULSE_WIDTH_MIN_AIR_DC));
    const uint32_t high = us * (v / 1000u);
    const uint32_t low = us * (v % 1000u);
    const uint32_t mm = high / 20000u;
    const uint32_t rest = ((high - (mm * 20000u)) * 1000u) + low;
    return bounded_mm(mm + ((rest + 10000000u) / 20000000u));
}
