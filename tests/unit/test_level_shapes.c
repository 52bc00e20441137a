/* SPDX-License-Identifier: MIT */
#include <math.h>

#include "suite.h"

#include "fathom/processing/level.h"

/* Every level of tanks of these heights and capacities. */
static const uint16_t heights_mm[] = {1, 2, 3, 7, 100, 999, 1000, 2000, 2016, 5008, 32767, 65535};
static const uint32_t capacities[] = {1, 1000, 123456789, UINT32_MAX - 1, UINT32_MAX};
enum {
    HEIGHTS = sizeof heights_mm / sizeof *heights_mm,
    CAPACITIES = sizeof capacities / sizeof *capacities
};

/* n / d, and of two that are as near the upper one. */
static uint64_t to_nearest(uint64_t n, uint64_t d) { return (2 * n + d) / (2 * d); }

/* The volume and per mille at a level, by the whole of the library. */
static fathom_level_t level_of(const fathom_level_config_t *tank, uint32_t level_mm)
{
    fathom_level_t level;
    assert_int_equal(fathom_level_from_distance(tank, (uint16_t)(tank->mounting_mm - level_mm), &level),
                     FATHOM_OK);
    assert_int_equal(level.level_mm, level_mm);
    return level;
}

static fathom_level_config_t tank_of(fathom_tank_volume_t volume, uint16_t height_mm, uint32_t capacity)
{
    const fathom_level_config_t tank = {
        .volume = volume, .capacity = capacity, .mounting_mm = height_mm, .height_mm = height_mm};
    assert_int_equal(fathom_level_check(&tank), FATHOM_OK);
    return tank;
}

TEST(every_level_of_an_upright_tank_is_the_nearest_volume_and_per_mille)
{
    for (unsigned i = 0; i != HEIGHTS; i++) {
        for (unsigned n = 0; n != CAPACITIES; n++) {
            const uint16_t height_mm = heights_mm[i];
            const fathom_level_config_t tank = tank_of(fathom_tank_upright, height_mm, capacities[n]);
            for (uint32_t mm = 0; mm <= height_mm; mm++) {
                const fathom_level_t level = level_of(&tank, mm);
                assert_int_equal(level.volume, to_nearest((uint64_t)capacities[n] * mm, height_mm));
                assert_int_equal(level.per_mille, to_nearest(1000 * (uint64_t)mm, height_mm));
            }
        }
    }
}

/* A first point, at the bottom, in the middle or one below the next, and one at the full height. */
TEST(every_level_of_a_table_is_the_nearest_volume_on_the_line_between_its_points)
{
    for (unsigned i = 1; i != HEIGHTS; i++) {
        const uint16_t height_mm = heights_mm[i];
        const uint16_t firsts_mm[] = {0, height_mm / 2, (uint16_t)(height_mm - 1)};
        for (unsigned n = 1; n != CAPACITIES * 3; n++) {
            const uint32_t all = capacities[n / 3];
            const uint32_t firsts[] = {0, all / 3, all - 1};
            const uint64_t from = firsts[n % 3], from_mm = firsts_mm[(n + i) % 3];
            const fathom_level_point_t points[] = {{(uint32_t)from, (uint16_t)from_mm}, {all, height_mm}};
            fathom_level_config_t tank = tank_of(fathom_tank_upright, height_mm, all);
            tank.volume = fathom_tank_table;
            tank.points = points;
            tank.point_count = 2;
            if (from == all) continue;
            assert_int_equal(fathom_level_check(&tank), FATHOM_OK);
            for (uint64_t mm = 0; mm <= height_mm; mm++) {
                const uint64_t right =
                    mm < from_mm ? to_nearest(from * mm, from_mm)
                                 : from + to_nearest((all - from) * (mm - from_mm), height_mm - from_mm);
                assert_int_equal(level_of(&tank, (uint32_t)mm).volume, right);
            }
        }
    }
}

/* More points than a byte counts: (i, 2 * i) up to 299, each a step of 2 mm and 1 unit. */
TEST(a_table_may_have_hundreds_of_points)
{
    fathom_level_point_t points[300];
    enum { COUNT = sizeof points / sizeof *points };
    fathom_level_config_t tank = tank_of(fathom_tank_upright, 1000, 1);
    for (unsigned i = 0; i != COUNT; i++) points[i] = (fathom_level_point_t){i, (uint16_t)(2 * i)};
    tank.volume = fathom_tank_table;
    tank.points = points;
    tank.point_count = COUNT;
    assert_int_equal(fathom_level_check(&tank), FATHOM_OK);
    for (uint32_t mm = 0; mm <= 1000; mm++)
        assert_int_equal(level_of(&tank, mm).volume, mm < 598 ? (mm + 1) / 2 : 299);
    points[COUNT - 1].volume = 298;
    assert_int_equal(fathom_level_check(&tank), FATHOM_ERR_ARGUMENT);
}

static long double area_of(long double x)
{
    return (acosl(1 - 2 * x) - 2 * (1 - 2 * x) * sqrtl(x - x * x)) / acosl(-1);
}

/* All levels of all capacities: the volume grows from 0 to the capacity, and is within the error of the header. Returns
 * the greatest error, as a part of 2^32 - 1 units. */
static long double expect_lying(uint16_t height_mm)
{
    static uint32_t before[CAPACITIES];
    long double greatest = 0;
    memset(before, 0, sizeof before);
    for (uint32_t mm = 0; mm <= height_mm; mm++) {
        const long double area = area_of((long double)mm / height_mm);
        for (unsigned n = 0; n != CAPACITIES; n++) {
            const uint32_t capacity = capacities[n];
            const fathom_level_config_t tank = tank_of(fathom_tank_horizontal_cylinder, height_mm, capacity);
            const uint32_t volume = level_of(&tank, mm).volume;
            const long double error = fabsl(volume - area * capacity);
            if (error > 0.0000431L * capacity + 0.5L || volume < before[n])
                fail_msg("%lu of %u mm: %lu of %lu", (unsigned long)mm, height_mm, (unsigned long)volume,
                         (unsigned long)capacity);
            if (mm == 0) assert_int_equal(volume, 0);
            if (mm == height_mm) assert_int_equal(volume, capacity);
            if (mm * 2 == height_mm) assert_int_equal(volume, to_nearest(capacity, 2));
            if (capacity == UINT32_MAX && error / capacity > greatest) greatest = error / capacity;
            before[n] = volume;
        }
    }
    return greatest;
}

/* And the error of the header is no greater than it must be: 5008 mm have the most of it. With FATHOM_LONG every height to 2 m, and some beyond. */
TEST(every_level_of_a_lying_cylinder_is_within_0_0431_per_mille_and_no_less_than_the_one_below)
{
    long double greatest = 0;
    for (unsigned i = 0; i != HEIGHTS; i++) {
        const long double error = expect_lying(heights_mm[i]);
        if (error > greatest) greatest = error;
    }
    assert_true(greatest > 0.0000430L);
    if (!suite_is_long) return;
    for (uint32_t mm = 1; mm <= 2000; mm++) expect_lying((uint16_t)mm);
    for (uint32_t mm = 2000; mm <= 65535; mm += 997) expect_lying((uint16_t)mm);
}

/* Of 65536 units the volume is the part itself; of another capacity it is the same part, to the nearest. */
TEST(the_part_of_a_lying_cylinder_does_not_depend_on_its_capacity)
{
    for (uint32_t mm = 0; mm <= 2000; mm++) {
        const fathom_level_config_t whole = tank_of(fathom_tank_horizontal_cylinder, 2000, 65536);
        const uint64_t part = level_of(&whole, mm).volume;
        for (uint32_t capacity = 1; capacity <= 1000; capacity++) {
            const fathom_level_config_t tank = tank_of(fathom_tank_horizontal_cylinder, 2000, capacity);
            assert_int_equal(level_of(&tank, mm).volume, to_nearest(part * capacity, 65536));
        }
    }
}
