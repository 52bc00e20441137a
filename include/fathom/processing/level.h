/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_LEVEL_H
#define FATHOM_LEVEL_H

#include <stddef.h>
#include <stdint.h>

#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Converts the distance of a sensor above a tank to the level and the volume in the tank.
 *
 * The level is in millimetres and in per mille of the height. The volume follows from the shape of the tank. The
 * functions use whole numbers and have no state. include/COST.md has the size in the row `level`; a program links only
 * the shape that it names.
 *
 * @code
 * static const fathom_level_config_t tank = {
 *     .volume = fathom_tank_horizontal_cylinder, .mounting_mm = 2100, .height_mm = 2000, .capacity = 5000};
 * fathom_level_t level;
 * if (sample.kind == FATHOM_TARGET && fathom_level_from_distance(&tank, sample.distance_mm, &level) == FATHOM_OK)
 *     show(level.level_mm, level.volume);
 * @endcode
 *
 * A sample of another kind than FATHOM_TARGET has no distance, so it has no level. FATHOM_NO_TARGET may be an empty
 * tank, or a tank whose surface is too near.
 *
 * Level = mounting_mm - (distance + offset_mm). A level below the bottom counts as 0, and a level above `height_mm` as
 * full; `level_mm` alone shows by how much. "To the nearest" is exact; of two equally near values it is the upper one.
 */

/** @brief The configuration of a tank (struct fathom_level_config). */
typedef struct fathom_level_config fathom_level_config_t;

/**
 * @brief Returns the volume at a level of 0 to `height_mm`.
 *
 * Use one of the functions below, or your own. The volume must not shrink if the level grows.
 */
typedef uint32_t (*fathom_tank_volume_t)(const fathom_level_config_t *tank, uint16_t level_mm);

/**
 * @brief Returns the volume of an upright tank: a cylinder, a box, a sump. The volume grows with the level.
 *
 * @param tank      The configuration.
 * @param level_mm  The level in millimetres, 0 to `height_mm`.
 * @return The volume in the unit of `capacity`, to the nearest.
 */
uint32_t fathom_tank_upright(const fathom_level_config_t *tank, uint16_t level_mm);

/**
 * @brief Returns the volume of a lying cylinder with flat ends; `height_mm` is its inner diameter.
 *
 * The error is at most 0.0431 per mille of the capacity and half a unit, at any height and level. Empty is 0; half full
 * and full are exact. The ends of most tanks bulge; a table is more exact for them.
 *
 * @param tank      The configuration.
 * @param level_mm  The level in millimetres, 0 to `height_mm`.
 * @return The volume in the unit of `capacity`.
 */
uint32_t fathom_tank_horizontal_cylinder(const fathom_level_config_t *tank, uint16_t level_mm);

/**
 * @brief Returns the volume by a table of points.
 *
 * Between two points the volume grows evenly with the level. Below the first point it grows from 0 at the bottom. Above
 * the last point it is the volume of the last point.
 *
 * @param tank      The configuration.
 * @param level_mm  The level in millimetres, 0 to `height_mm`.
 * @return The volume in the unit of the points, to the nearest.
 */
uint32_t fathom_tank_table(const fathom_level_config_t *tank, uint16_t level_mm);

/** @brief A point of a table: at this level the tank has this volume. */
typedef struct {
    uint32_t volume;   /**< The volume in any unit, the same for all points. */
    uint16_t level_mm; /**< The level above the bottom, 0 to 65535 mm. */
} fathom_level_point_t;

/** @brief The configuration of a tank. May be const. Each function reads it during its call only. */
struct fathom_level_config {
    fathom_tank_volume_t volume; /**< The tank's shape. Required. */
    /** For fathom_tank_table(): `point_count` points. Both members grow from point to point; the first point may have a
     * level of 0 or a volume of 0. NULL only if `point_count` is 0. */
    const fathom_level_point_t *points;
    size_t point_count; /**< Number of points. */
    uint32_t
        capacity; /**< Volume of the full tank in any unit, 1..4294967295. Not used by fathom_tank_table(). */
    uint16_t mounting_mm; /**< From the tank's bottom to the face of the sensor, 1..65535 mm. */
    uint16_t height_mm;   /**< Level at which the tank is full, 1..65535 mm. */
    int16_t offset_mm;    /**< Added to each distance, -32768..32767 mm. */
};

/** @brief The result of fathom_level_from_distance(). */
typedef struct {
    uint32_t volume; /**< In the unit of the configuration. */
    int32_t
        level_mm; /**< From the bottom; below 0 or above `height_mm` if the distance is beyond the tank. */
    uint16_t per_mille; /**< Of `height_mm`, to the nearest, 0..1000. */
} fathom_level_t;

/**
 * @brief Checks a configuration. Call it once for a configuration that is not written by hand.
 *
 * @param config  The configuration.
 * @retval FATHOM_OK            Each member is inside its range.
 * @retval FATHOM_ERR_ARGUMENT  There is no volume function, `mounting_mm` or `height_mm` is 0, the points do not
 *                              grow, or the volume of the full tank is 0 because there is no capacity, or there are
 *                              no points.
 */
fathom_status_t fathom_level_check(const fathom_level_config_t *config);

/**
 * @brief Converts a distance to a level and a volume.
 *
 * @param config       The configuration.
 * @param distance_mm  The distance in millimetres, 0 to 65535, of a sample FATHOM_TARGET.
 * @param out          Written with FATHOM_OK only.
 * @retval FATHOM_OK            `*out` is the level.
 * @retval FATHOM_ERR_ARGUMENT  There is no volume function, or `height_mm` is 0, as in zeroed memory.
 */
fathom_status_t fathom_level_from_distance(const fathom_level_config_t *config, uint16_t distance_mm,
                                           fathom_level_t *out);

#ifdef __cplusplus
}
#endif

#endif
