/* SPDX-License-Identifier: MIT */
/*
 * Any tank, any distance: each shape, for a table any points, which need not grow, and any number of them.
 *
 * proves: src/processing/level.c
 * options: -eva-split-return full -eva-domains-function octagon:fathom_tank_table
 */
#include "fathom/processing/level.h"
#include "assumptions.h"

enum { POINTS = 1000 };

static fathom_level_point_t points[POINTS];

static uint16_t any_height(void) { return Frama_C_unsigned_short_interval(1, UINT16_MAX); }

static void any_tank(fathom_tank_volume_t volume, uint16_t height_mm)
{
    fathom_level_config_t tank;
    fathom_level_t level;
    tank.volume = volume;
    tank.points = any_bool() ? points : NULL;
    tank.point_count = tank.points != NULL ? Frama_C_unsigned_short_interval(0, POINTS) : 0;
    tank.capacity = any_32();
    tank.mounting_mm = any_16();
    tank.height_mm = height_mm;
    tank.offset_mm = Frama_C_short_interval(INT16_MIN, INT16_MAX);
    (void)fathom_level_check(&tank);
    if (fathom_level_from_distance(&tank, any_16(), &level) == FATHOM_OK) {
        /*@ assert \initialized(&level.volume) && \initialized(&level.level_mm) && \initialized(&level.per_mille); */
    }
}

/* Points are missing, although there is a number of them. */
static void no_points(void)
{
    fathom_level_config_t tank;
    tank.volume = fathom_tank_table;
    tank.points = NULL;
    tank.point_count = Frama_C_unsigned_short_interval(1, POINTS);
    tank.capacity = any_32();
    tank.mounting_mm = any_16();
    tank.height_mm = any_height();
    tank.offset_mm = Frama_C_short_interval(INT16_MIN, INT16_MAX);
    const fathom_status_t status = fathom_level_check(&tank);
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
}

int main(void)
{
    any_memory(points, sizeof points);
    any_tank(NULL, any_16());
    any_tank(fathom_tank_upright, 0);
    any_tank(fathom_tank_upright, any_height());
    any_tank(fathom_tank_horizontal_cylinder, any_height());
    any_tank(fathom_tank_table, any_height());
    no_points();
    return 0;
}
