/* SPDX-License-Identifier: MIT */
/*
 * Any width, and any temperature of the air.
 *
 * proves: src/codec/pulse_width.c
 */
#include "fathom/codec/pulse_width.h"
#include "assumptions.h"

int main(void)
{
    (void)fathom_pulse_width_mm(any_32(), any_16());
    (void)fathom_pulse_width_mm_in_air(any_32(), Frama_C_short_interval(INT16_MIN, INT16_MAX));
    return 0;
}
