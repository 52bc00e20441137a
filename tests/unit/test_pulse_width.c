/* SPDX-License-Identifier: MIT */
#include <stdint.h>

#include "suite.h"

#include "fathom/codec/pulse_width.h"

/* proof/wp proves both formulas for every input; these are examples by hand. */

/* ---- the datasheet's formula ---- */

/* The mistake of A16 DS 1: "V = 348 m/s" and "S = T / 57.5" differ by 0.05 %. 10000 us * 348 m/s / 2 = 1740 mm, and
 * 10000 / 57.5 = 173.9 cm; the example says 173.9. */
TEST(the_example_of_a16_1_decides_between_348_m_per_s_and_57_5)
{
    assert_int_equal(fathom_pulse_width_mm(10000, 575), 1739);
}

/* By hand, T * 4 / 23: 12000 / 23 = 521.7, 345000 / 23 = 15000, 376000 / 23 = 16347.8; 348 m/s would give 522, 15007.5
 * and 16356 mm. */
TEST(widths_of_the_datasheet_by_hand)
{
    assert_int_equal(fathom_pulse_width_mm(0, 575), 0);
    assert_int_equal(fathom_pulse_width_mm(2, 575), 0); /* 0.35 */
    assert_int_equal(fathom_pulse_width_mm(3, 575), 1); /* 0.52 */
    assert_int_equal(fathom_pulse_width_mm(3000, 575), 522);
    assert_int_equal(fathom_pulse_width_mm(86250, 575), 15000);
    assert_int_equal(fathom_pulse_width_mm(94000, 575), 16348);
}

TEST(widths_beyond_65535_mm_give_65535)
{
    assert_int_equal(fathom_pulse_width_mm(376823, 575), 65534); /* 1507292 / 23 = 65534.4 */
    assert_int_equal(fathom_pulse_width_mm(376824, 575), 65535); /* 1507296 / 23 = 65534.6 */
    assert_int_equal(fathom_pulse_width_mm(376830, 575), 65535); /* 65535.65 */
    assert_int_equal(fathom_pulse_width_mm(500001, 575), 65535);
    assert_int_equal(fathom_pulse_width_mm(UINT32_C(0x40000000), 575), 65535);
    assert_int_equal(fathom_pulse_width_mm(UINT32_MAX, 575), 65535);
}

/* A half goes upwards: 1 us at 200 us/dm is 0.5 mm, and at 201 us/dm 0.498. 29 us at 580 are 5.0. 3932069 us at 6000 are
 * 65534.5 less 0.02, and one more is 65534.5. */
TEST(other_scales_by_hand)
{
    assert_int_equal(fathom_pulse_width_mm(1, 200), 1);
    assert_int_equal(fathom_pulse_width_mm(1, 201), 0);
    assert_int_equal(fathom_pulse_width_mm(29, 580), 5);
    assert_int_equal(fathom_pulse_width_mm(655, 1), 65500);
    assert_int_equal(fathom_pulse_width_mm(656, 1), 65535);
    assert_int_equal(fathom_pulse_width_mm(3932069, 6000), 65534);
    assert_int_equal(fathom_pulse_width_mm(3932070, 6000), 65535);
    assert_int_equal(fathom_pulse_width_mm(UINT32_MAX, 1), 65535);
    assert_int_equal(fathom_pulse_width_mm(UINT32_MAX, 6000), 65535);
    assert_int_equal(fathom_pulse_width_mm(0, 0), 65535);
}

/* ---- with the temperature of the air ---- */

/* (331.3 + 0.606 * degC) m/s; a us at 1 m/s is 1/1000 mm, and half of it is to the target. */

/* 331.3 + 12.12 = 343.42 m/s: 10000 us are 1717.1 mm. 331.3 - 24.24 = 307.06: 1535.3. 331.3 + 51.51 = 382.81:
 * 1914.05 */
TEST(temperatures_by_hand)
{
    assert_int_equal(fathom_pulse_width_mm_in_air(10000, 200), 1717);
    assert_int_equal(fathom_pulse_width_mm_in_air(10000, -400), 1535);
    assert_int_equal(fathom_pulse_width_mm_in_air(10000, 850), 1914);
    /* 25.9 degC: v = 3070600 + 606 * 659 = 3469954; 41087 * v = 142569999998, 2 short of 7128.5 * 2 * 10^7. */
    assert_int_equal(fathom_pulse_width_mm_in_air(41087, 259), 7128);
}

/* Every temperature, and of each one width in eight, others at the next. The formula in whole numbers of 64 bits. */
TEST(every_tenth_of_a_degree_gives_the_nearest_mm)
{
    for (int32_t dc = -400; dc <= 850; dc++)
        for (uint32_t us = (uint32_t)(dc + 400) % 8; us <= 105000; us += 8) {
            const uint64_t exact = (uint64_t)us * (uint64_t)(3313000 + 606 * dc);
            assert_int_equal(fathom_pulse_width_mm_in_air(us, (int16_t)dc), (exact + 10000000) / 20000000);
        }
}

TEST(beyond_the_ends_the_nearer_end_counts)
{
    const uint16_t coldest = fathom_pulse_width_mm_in_air(94000, -400);
    const uint16_t warmest = fathom_pulse_width_mm_in_air(94000, 850);
    assert_int_equal(fathom_pulse_width_mm_in_air(94000, -401), coldest);
    assert_int_equal(fathom_pulse_width_mm_in_air(94000, INT16_MIN), coldest);
    assert_int_equal(fathom_pulse_width_mm_in_air(94000, 851), warmest);
    assert_int_equal(fathom_pulse_width_mm_in_air(94000, INT16_MAX), warmest);
    assert_int_not_equal(fathom_pulse_width_mm_in_air(94000, 849), warmest);
    assert_int_not_equal(fathom_pulse_width_mm_in_air(94000, -399), coldest);
}

/* At -40 degC: 426851 * 307.06 / 2000 = 65534.43, and 426852 * 307.06 / 2000 = 65534.59. */
TEST(widths_in_air_beyond_65535_mm_give_65535)
{
    assert_int_equal(fathom_pulse_width_mm_in_air(426851, -400), 65534);
    assert_int_equal(fathom_pulse_width_mm_in_air(426852, -400), 65535);
    assert_int_equal(fathom_pulse_width_mm_in_air(UINT32_MAX, -400), 65535);
    assert_int_equal(fathom_pulse_width_mm_in_air(UINT32_MAX, 850), 65535);
}
