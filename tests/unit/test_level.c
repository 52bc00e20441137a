/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include "fathom/processing/level.h"

static fathom_level_config_t tank;

/* A tank of 2 m and 5000 l, whose sensor hangs 10 cm over it. */
static int set_up(void **state)
{
    tank = (fathom_level_config_t){
        .volume = fathom_tank_upright, .mounting_mm = 2100, .height_mm = 2000, .capacity = 5000};
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static fathom_level_t level_at(uint16_t distance_mm)
{
    fathom_level_t level;
    memset(&level, 0xA5, sizeof level);
    assert_int_equal(fathom_level_from_distance(&tank, distance_mm, &level), FATHOM_OK);
    return level;
}

static void expect_level(uint16_t distance_mm, int32_t level_mm, unsigned per_mille, uint32_t volume)
{
    const fathom_level_t level = level_at(distance_mm);
    assert_int_equal(level.level_mm, level_mm);
    assert_int_equal(level.per_mille, per_mille);
    assert_int_equal(level.volume, volume);
}

/* ---- the level ---- */

/* 2100 - 600 = 1500 mm of 2000: 750 per mille of 5000 l. */
TEST(the_level_is_from_the_bottom_up_and_the_sensor_measures_down)
{
    expect_level(600, 1500, 750, 3750);
    expect_level(1100, 1000, 500, 2500);
}

/* 1 - 65535 - 32767 and 65535 - 0 + 32768 */
TEST(no_distance_wraps_the_level)
{
    tank.mounting_mm = 1;
    tank.offset_mm = INT16_MAX;
    expect_level(65535, -98301, 0, 0);
    tank.mounting_mm = 65535;
    tank.offset_mm = INT16_MIN;
    expect_level(0, 98303, 1000, 5000);
    /* a height beyond what an int of 16 bits holds: 65535 - 10000 = 55535 of 60000 mm are 925.58 per mille, 4627.9 l */
    tank.offset_mm = 0;
    tank.height_mm = 60000;
    expect_level(10000, 55535, 926, 4628);
}

static void expect_per_mille(uint16_t height_mm, uint16_t level_mm, unsigned per_mille)
{
    tank.height_mm = tank.mounting_mm = height_mm;
    assert_int_equal(level_at((uint16_t)(height_mm - level_mm)).per_mille, per_mille);
}

/* 1000 / 2001 = 0.49975, 1000 / 3 = 333.3; 33 of 65535 mm are 0.5036 per mille, 32 are 0.488. */
TEST(per_mille_are_to_the_nearest)
{
    expect_per_mille(2001, 1, 0);
    expect_per_mille(2000, 1, 1);
    expect_per_mille(1999, 1, 1);
    expect_per_mille(3, 1, 333);
    expect_per_mille(3, 2, 667);
    expect_per_mille(1, 0, 0);
    expect_per_mille(1, 1, 1000);
    expect_per_mille(65535, 32, 0);
    expect_per_mille(65535, 33, 1);
    expect_per_mille(65535, 65502, 999);
    expect_per_mille(65535, 65503, 1000);
    expect_per_mille(65535, 65535, 1000);
}

static uint32_t of_own(const fathom_level_config_t *config, uint16_t level_mm)
{
    assert_ptr_equal(config, &tank);
    return 7000000ul + level_mm;
}

TEST(a_shape_may_be_the_callers_own_and_gets_levels_within_the_tank)
{
    tank.volume = of_own;
    expect_level(2200, -100, 0, 7000000);
    expect_level(600, 1500, 750, 7001500);
    expect_level(0, 2100, 1000, 7002000);
}

static uint32_t volume_of(fathom_tank_volume_t volume, uint32_t capacity, uint16_t height_mm,
                          uint16_t level_mm)
{
    tank.volume = volume;
    tank.capacity = capacity;
    tank.height_mm = height_mm;
    return volume(&tank, level_mm);
}

/* ---- a horizontal cylinder ---- */

/* 0.0431 per mille of 10^6 units are 43.1; then half a unit, and half of one by which `volume` is rounded. */
static void expect_near(uint16_t level_mm, uint32_t volume)
{
    const uint32_t found = volume_of(fathom_tank_horizontal_cylinder, 1000000, 2000, level_mm);
    assert_in_range(found, volume - 44, volume + 44);
}

/*
 * (acos(1 - 2x) - 2 * (1 - 2x) * sqrt(x - x^2)) / pi by hand:
 * x = 1/100: acos(0.98) = 0.2003348, 1.96 * 0.0994987 = 0.1950175: 0.0053173 / pi = 0.0016926
 * x = 1/10:  acos(0.8)  = 0.6435011, 1.6 * 0.3         = 0.48:      0.1635011 / pi = 0.0520440
 * x = 1/4:   acos(0.5)  = 1.0471976, 1 * 0.4330127:                 0.6141848 / pi = 0.1955011
 * x = 2/5:   acos(0.2)  = 1.3694384, 0.4 * 0.4898979   = 0.1959592: 1.1734792 / pi = 0.3735300
 */
TEST(a_lying_cylinders_volume_by_hand)
{
    expect_near(20, 1693);
    expect_near(200, 52044);
    expect_near(500, 195501);
    expect_near(800, 373530);
    expect_near(1200, 626470);
    expect_near(1500, 804499);
    expect_near(1800, 947956);
    expect_near(1980, 998307);
}

static void expect_lying(uint32_t capacity, uint16_t height_mm, uint16_t level_mm, uint32_t volume)
{
    assert_int_equal(volume_of(fathom_tank_horizontal_cylinder, capacity, height_mm, level_mm), volume);
}

/* 4294967295 / 2 = 2147483647.5; 0.5 is 1. */
TEST(a_lying_cylinder_is_exact_where_it_is_empty_half_full_and_full)
{
    static const uint16_t heights_mm[] = {2, 100, 2000, 65534};
    for (unsigned i = 0; i != sizeof heights_mm / sizeof *heights_mm; i++) {
        const uint16_t mm = heights_mm[i];
        expect_lying(4294967295u, mm, 0, 0);
        expect_lying(4294967295u, mm, mm / 2, 2147483648u);
        expect_lying(4294967295u, mm, mm, 4294967295u);
        expect_lying(4294967294u, mm, mm / 2, 2147483647u);
        expect_lying(5000, mm, mm / 2, 2500);
        expect_lying(1, mm, mm / 2, 1);
        expect_lying(1, mm, (uint16_t)(mm / 2 - 1), 0);
    }
    expect_lying(5000, 1, 0, 0);
    expect_lying(5000, 1, 1, 5000);
    expect_lying(4294967295u, 65535, 65535, 4294967295u);
}

/* ---- a table ---- */

static const fathom_level_point_t cone[] = {{50, 100}, {250, 200}, {1000, 1000}};

static void use_points(const fathom_level_point_t *points, size_t count)
{
    tank.volume = fathom_tank_table;
    tank.points = points;
    tank.point_count = count;
}

static void expect_by_table(uint16_t level_mm, uint32_t volume)
{
    assert_int_equal(fathom_tank_table(&tank, level_mm), volume);
}

/* 0.5 a mm to 100 mm, 2 to 200 mm, then 750 / 800 = 0.9375. */
TEST(between_points_the_volume_grows_with_the_level)
{
    use_points(cone, 3);
    expect_by_table(0, 0);
    expect_by_table(1, 1); /* 0.5 */
    expect_by_table(2, 1);
    expect_by_table(99, 50); /* 49.5 */
    expect_by_table(100, 50);
    expect_by_table(101, 52);
    expect_by_table(199, 248);
    expect_by_table(200, 250);
    expect_by_table(201, 251); /* 250.94 */
    expect_by_table(208, 258); /* 257.5 */
    expect_by_table(999, 999); /* 999.06 */
    expect_by_table(1000, 1000);
    expect_by_table(1001, 1000);
    expect_by_table(65535, 1000);
    tank.capacity = 77;                /* is not for a table */
    expect_level(1600, 500, 250, 531); /* 250 + 300 * 0.9375 = 531.25 */
}

TEST(points_beyond_their_count_do_not_exist)
{
    use_points(cone, 2);
    expect_by_table(600, 250);
    use_points(cone, 1);
    expect_by_table(50, 25);
    expect_by_table(150, 50);
    use_points(NULL, 0);
    expect_by_table(150, 0);
}

/* 4294967294 over 65534 mm: half of them are at 1 + 32767 mm. 4294967293 over 65535 mm are 65536.99997 a mm. */
TEST(a_tables_products_do_not_wrap)
{
    static const fathom_level_point_t from_one[] = {{1, 1}, {UINT32_MAX, 65535}};
    static const fathom_level_point_t from_two[] = {{2, 0}, {UINT32_MAX, 65535}};
    use_points(from_one, 2);
    expect_by_table(32768, 2147483648u);
    expect_by_table(65535, UINT32_MAX);
    use_points(from_two, 2);
    expect_by_table(65534, 4294901758u);
}

/* ---- the check of a config ---- */

static void expect_checked(fathom_status_t status) { assert_int_equal(fathom_level_check(&tank), status); }

static void expect_points(fathom_status_t status, fathom_level_point_t a, fathom_level_point_t b,
                          fathom_level_point_t c)
{
    const fathom_level_point_t points[] = {a, b, c};
    use_points(points, 3);
    expect_checked(status);
}

TEST(points_whose_levels_or_volumes_do_not_grow_are_refused)
{
    typedef fathom_level_point_t p;
    const p a = {10, 100}, b = {20, 200}, c = {30, 300};
    expect_points(FATHOM_OK, a, b, c);
    expect_points(FATHOM_OK, (p){0, 0}, b, c);
    expect_points(FATHOM_OK, (p){10, 0}, b, c);
    expect_points(FATHOM_OK, (p){0, 100}, b, c);
    expect_points(FATHOM_OK, (p){19, 199}, b, (p){21, 201});
    expect_points(FATHOM_ERR_ARGUMENT, (p){10, 200}, b, c);
    expect_points(FATHOM_ERR_ARGUMENT, (p){20, 100}, b, c);
    expect_points(FATHOM_ERR_ARGUMENT, (p){10, 201}, b, c);
    expect_points(FATHOM_ERR_ARGUMENT, (p){21, 100}, b, c);
    expect_points(FATHOM_ERR_ARGUMENT, a, b, (p){30, 200});
    expect_points(FATHOM_ERR_ARGUMENT, a, b, (p){20, 300});
    expect_points(FATHOM_ERR_ARGUMENT, a, b, (p){30, 199});
    expect_points(FATHOM_ERR_ARGUMENT, a, b, (p){19, 300});
}

static const fathom_level_point_t without_volume[] = {{0, 100}};

static const fathom_level_config_t refused[] = {
    {.volume = NULL, .mounting_mm = 2100, .height_mm = 2000, .capacity = 5000},
    {.volume = fathom_tank_upright, .mounting_mm = 2100, .height_mm = 0, .capacity = 5000},
    {.volume = fathom_tank_upright, .mounting_mm = 0, .height_mm = 2000, .capacity = 5000},
    {.volume = fathom_tank_upright, .mounting_mm = 2100, .height_mm = 2000},
    {.volume = fathom_tank_horizontal_cylinder, .mounting_mm = 2100, .height_mm = 2000},
    {.volume = fathom_tank_table, .mounting_mm = 2100, .height_mm = 2000},
    {.volume = fathom_tank_table, .mounting_mm = 2100, .height_mm = 2000, .point_count = 1},
    {.volume = fathom_tank_table, .mounting_mm = 2100, .height_mm = 2000, .points = cone},
    {.volume = fathom_tank_table,
     .mounting_mm = 2100,
     .height_mm = 2000,
     .points = without_volume,
     .point_count = 1},
};

TEST(a_config_without_a_shape_a_mounting_a_height_a_volume_or_points_is_refused)
{
    for (unsigned i = 0; i != sizeof refused / sizeof *refused; i++) {
        tank = refused[i];
        expect_checked(FATHOM_ERR_ARGUMENT);
    }
}

TEST(without_a_shape_or_a_height_no_level_is_written)
{
    for (unsigned i = 0; i != 2; i++) {
        fathom_level_t level, before;
        memset(&level, 0xA5, sizeof level);
        memset(&before, 0xA5, sizeof before);
        assert_int_equal(fathom_level_from_distance(&refused[i], 600, &level), FATHOM_ERR_ARGUMENT);
        assert_memory_equal(&level, &before, sizeof level);
    }
}
