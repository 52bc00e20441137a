/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_LEVEL_H
#define FATHOM_LEVEL_H

#include <stddef.h>
#include <stdint.h>

#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * From the distance of a sensor that looks down into a tank to the level in it, per mille of the height, and the volume
 * by the tank's shape: whole numbers. It has no state.
 *
 *   static const fathom_level_config_t tank = {
 *       .volume = fathom_tank_horizontal_cylinder, .mounting_mm = 2100, .height_mm = 2000, .capacity = 5000};
 *   fathom_level_t level;
 *   if (sample.kind == FATHOM_TARGET && fathom_level(&tank, sample.distance_mm, &level) == FATHOM_READY)
 *       show(level.level_mm, level.volume);
 *
 * A sample that is no distance is no level: "no target" may be an empty tank, or one whose surface is too near.
 *
 * Level = mounting_mm - (distance + offset_mm). What is below the bottom counts as at the bottom, and what is over
 * height_mm as full; level_mm alone says how far. "To the nearest" is exact; of two that are as near it is the upper
 * one.
 */

typedef struct fathom_level_config fathom_level_config_t;

/* The volume at a level of 0..height_mm: one of those below, which alone is then in the image, or the caller's own. It
 * does not shrink when the level grows. */
typedef uint32_t (*fathom_tank_volume_t)(const fathom_level_config_t *tank, uint16_t level_mm);

/* The volume grows with the level, to the nearest: an upright cylinder, a box, a sump. */
uint32_t fathom_tank_upright(const fathom_level_config_t *tank, uint16_t level_mm);

/*
 * It lies, with flat ends; height_mm is its inner diameter. The error is at most 0.0431 per mille of the capacity and half
 * a unit, at any height and level; empty is 0, and half full and full are exact. (Where the ends bulge, as those of
 * most tanks, a table is nearer.)
 */
uint32_t fathom_tank_horizontal_cylinder(const fathom_level_config_t *tank, uint16_t level_mm);

/* By points, between which the volume grows with the level, to the nearest. Below the first one it grows so from 0 at the
 * bottom; over the last one it is that of the last one. */
uint32_t fathom_tank_table(const fathom_level_config_t *tank, uint16_t level_mm);

/* At this level the tank has this volume. */
typedef struct {
    uint32_t volume;
    uint16_t level_mm;
} fathom_level_point_t;

struct fathom_level_config {
    fathom_tank_volume_t volume; /* the tank's shape */
    /* For fathom_tank_table: both members grow from point to point; the first one may be at a level of 0 or have a volume
     * of 0. */
    const fathom_level_point_t *points;
    size_t point_count;
    uint32_t capacity;    /* volume of the full tank, in any unit: litres; not for fathom_tank_table */
    uint16_t mounting_mm; /* from the tank's bottom to the face of the sensor, 1..65535 */
    uint16_t height_mm;   /* the level at which the tank is full, 1..65535 */
    int16_t offset_mm;    /* added to each distance */
};

typedef struct {
    uint32_t volume; /* in the unit of the config */
    /* from the bottom; below 0 and over height_mm: the sensor sees farther or nearer than that */
    int32_t level_mm;
    uint16_t per_mille; /* of height_mm, to the nearest, 0..1000 */
} fathom_level_t;

/* FATHOM_READY, or FATHOM_ERR_ARGUMENT: no volume function, a mounting or a height of 0, points that do not grow, or a
 * full tank whose volume is 0: without a capacity, or without points. To be called once, for a config that is not
 * written by hand. */
fathom_status_t fathom_level_check(const fathom_level_config_t *config);

/* FATHOM_READY, or FATHOM_ERR_ARGUMENT: no volume function, or a height of 0; then *out is untouched. */
fathom_status_t fathom_level(const fathom_level_config_t *config, uint16_t distance_mm, fathom_level_t *out);

#ifdef __cplusplus
}
#endif

#endif
