/* SPDX-License-Identifier: MIT */
#include <stdint.h>

#include "suite.h"

#include "fathom/codec/pulse_width.h"

/* Exact: twice what n / d is more than mm, times d. */
static int64_t twice_off(uint16_t mm, uint64_t n, uint64_t d)
{
    return 2 * ((int64_t)n - (int64_t)mm * (int64_t)d);
}

/* mm is the nearest to n / d, and of two that are as near the upper one. */
static void assert_nearest_half_up(uint16_t mm, uint64_t n, uint64_t d)
{
    const int64_t off = twice_off(mm, n, d);
    if (off >= (int64_t)d || off < -(int64_t)d) fail_msg("%u mm for %g", mm, (double)n / (double)d);
}

/* ---- the datasheet's formula ---- */

/* A16 1(4): S = T / 57.5 in cm: 10 * T / 57.5 = 20 * T / 115 mm. */
TEST(every_width_to_500_ms_is_the_nearest_mm_of_t_over_57_5)
{
    unsigned ties = 0;
    for (uint32_t us = 0; us <= 500000; us++) {
        const uint16_t mm = fathom_pulse_width_mm(us, 575);
        if (us >= 376824) assert_int_equal(mm, 65535);
        if (us >= 376824) continue;
        assert_nearest_half_up(mm, 20 * (uint64_t)us, 115);
        const int64_t off = twice_off(mm, 20 * (uint64_t)us, 115);
        ties += off == 115 || off == -115;
    }
    assert_int_equal(ties, 0);
}

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

/* Each scale with widths around its ends; a half goes upwards: 29 us at 580 are 5.0, 32 us at 640 are 5.0, 1 us at 200 is
 * 0.5. */
TEST(other_scales_are_the_nearest_mm_too)
{
    static const uint16_t scales[] = {1, 2, 100, 575, 580, 588, 5999, 6000};
    for (unsigned i = 0; i != sizeof scales / sizeof *scales; i++) {
        for (uint32_t us = 0; us <= 4100000; us += us < 70000 ? 1 : 997) {
            const uint16_t mm = fathom_pulse_width_mm(us, scales[i]);
            if (200 * (uint64_t)us + scales[i] >= UINT64_C(131070) * scales[i])
                assert_int_equal(mm, 65535);
            else
                assert_nearest_half_up(mm, 100 * (uint64_t)us, scales[i]);
        }
        assert_int_equal(fathom_pulse_width_mm(UINT32_MAX, scales[i]), 65535);
    }
    assert_int_equal(fathom_pulse_width_mm(1, 200), 1);
    assert_int_equal(fathom_pulse_width_mm(0, 0), 65535);
}

/* ---- with the temperature of the air ---- */

/* (331.3 + 0.606 * dc / 10) m/s = (3313000 + 606 * dc) / 10000 m/s; a us at 1 m/s is 1/1000 mm, and half of it is to
 * the target. */
static uint64_t numerator(uint32_t us, int16_t air_dc)
{
    return (uint64_t)us * (uint64_t)(3313000 + 606 * (int32_t)air_dc);
}

enum { DENOMINATOR = 20000000 };

/* Every temperature and every width, but of each temperature one width in eight, other ones at the next; with
 * FATHOM_LONG each with each. */
TEST(every_tenth_of_a_degree_and_width_is_the_nearest_mm_and_so_within_1_mm_at_15_m)
{
    const uint32_t step_us = suite_is_long ? 1 : 8;
    for (int16_t dc = -400; dc <= 850; dc++)
        for (uint32_t us = (uint32_t)(dc + 400) % step_us; us <= 105000; us += step_us)
            assert_nearest_half_up(fathom_pulse_width_mm_in_air(us, dc), numerator(us, dc), DENOMINATOR);
}

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

/* 347.83 m/s is at (347.83 - 331.3) / 0.606 = 27.3 degC. */
TEST(at_27_3_degrees_both_formulas_agree_to_1_mm)
{
    for (uint32_t us = 0; us <= 105000; us++) {
        const int plain = fathom_pulse_width_mm(us, 575);
        const int in_air = fathom_pulse_width_mm_in_air(us, 273);
        assert_in_range(in_air - plain + 1, 0, 2);
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

/* The products do not wrap, and what is too long says so. */
TEST(long_widths_in_any_air_grow_until_65535_mm)
{
    static const int16_t dcs[] = {-400, 0, 850};
    for (unsigned i = 0; i != sizeof dcs / sizeof *dcs; i++) {
        for (uint32_t us = 105000; us <= 600000; us += 13) {
            const uint16_t mm = fathom_pulse_width_mm_in_air(us, dcs[i]);
            if (numerator(us, dcs[i]) >= UINT64_C(65535) * DENOMINATOR)
                assert_int_equal(mm, 65535);
            else
                assert_nearest_half_up(mm, numerator(us, dcs[i]), DENOMINATOR);
        }
        assert_int_equal(fathom_pulse_width_mm_in_air(UINT32_MAX, dcs[i]), 65535);
    }
}
