/* SPDX-License-Identifier: MIT */
#include "fathom/processing/level.h"

/* The level and the volume in a tank. All divisions round to the nearest, in 32 bits. */

static uint32_t to_nearest(uint32_t number, uint32_t divisor) { return (number + (divisor / 2u)) / divisor; }

/*
 * amount * part / whole to the nearest; part <= whole. The product has up to 48 bits, so amount is split into what
 * `whole` divides and a rest below it: rest * part + whole / 2 is at most 65534 * 65535 + 32767 < 2^32.
 */
static uint32_t share(uint32_t amount, uint16_t part, uint16_t whole)
{
    return (amount / whole * part) + to_nearest(amount % whole * part, whole);
}

uint32_t fathom_tank_upright(const fathom_level_config_t *tank, uint16_t level_mm)
{
    return share(tank->capacity, level_mm, tank->height_mm);
}

#define ONE  UINT32_C(65536)
#define HALF UINT32_C(32768)

/*
 * x: the level's part of the diameter, in 1/65536; the upper half is the lower one upside down. The part of the area is
 * (acos(1 - 2x) - (1 - 2x) * sqrt(4x - 4x^2)) / pi. It begins as x^1.5, which neither lines nor polynomials follow
 * well, but the square of its quotient by x is almost straight: area = x * sqrt(x * g), where with z = 1 - 2x
 *
 *   g = 2 + z * (0.9084 - z / 32)
 *
 * 2 makes the half exact. With 0.9084, 29768 / 32768, the greatest error is least: 0.0431 per mille of the whole, the
 * roundings of x and of each step included. z is in 1/32768, g in 1/16384.
 */
static uint32_t area_below(uint16_t x)
{
    const uint16_t z = (uint16_t)(HALF - x);
    const uint16_t slope = (uint16_t)(29768u - (z / 32u));
    const uint16_t g = (uint16_t)(HALF + (((uint32_t)z * slope) >> 16));
    const uint32_t square = (uint32_t)x * g;
    uint16_t root = 0;
    for (uint16_t bit = 0x8000u; bit != 0u; bit = (uint16_t)(bit / 2u)) {
        const uint16_t next = (uint16_t)(root + bit);
        if (((uint32_t)next * next) <= square) root = next;
    }
    return ((uint32_t)x * root) >> 15;
}

uint32_t fathom_tank_horizontal_cylinder(const fathom_level_config_t *tank, uint16_t level_mm)
{
    const uint32_t x = to_nearest(ONE * level_mm, tank->height_mm);
    const uint32_t area = (x > HALF) ? (ONE - area_below((uint16_t)(ONE - x))) : area_below((uint16_t)x);
    return (tank->capacity / ONE * area) + (((tank->capacity % ONE * area) + HALF) / ONE);
}

uint32_t fathom_tank_table(const fathom_level_config_t *tank, uint16_t level_mm)
{
    uint32_t volume = 0;
    uint16_t from_mm = 0;
    for (size_t i = 0; i < tank->point_count; i++) {
        const uint32_t to = tank->points[i].volume;
        const uint16_t to_mm = tank->points[i].level_mm;
        if (level_mm < to_mm)
            return volume + share(to - volume, (uint16_t)(level_mm - from_mm), (uint16_t)(to_mm - from_mm));
        volume = to;
        from_mm = to_mm;
    }
    return volume;
}

fathom_status_t fathom_level_check(const fathom_level_config_t *config)
{
    const fathom_level_point_t *const points = config->points;
    if ((config->volume == NULL) || (config->mounting_mm == 0u) || (config->height_mm == 0u) ||
        ((points == NULL) && (config->point_count != 0u)))
        return FATHOM_ERR_ARGUMENT;
    for (size_t i = 1; i < config->point_count; i++)
        if ((points[i].level_mm <= points[i - 1u].level_mm) || (points[i].volume <= points[i - 1u].volume))
            return FATHOM_ERR_ARGUMENT;
    return (config->volume(config, config->height_mm) != 0u) ? FATHOM_OK : FATHOM_ERR_ARGUMENT;
}

fathom_status_t fathom_level_from_distance(const fathom_level_config_t *config, uint16_t distance_mm,
                                           fathom_level_t *out)
{
    const uint16_t height_mm = config->height_mm;
    const int32_t level_mm = (int32_t)config->mounting_mm - (int32_t)distance_mm - config->offset_mm;
    if ((config->volume == NULL) || (height_mm == 0u)) return FATHOM_ERR_ARGUMENT;
    uint16_t inside_mm = 0;
    if (level_mm > 0) inside_mm = (level_mm < (int32_t)height_mm) ? (uint16_t)level_mm : height_mm;
    out->volume = config->volume(config, inside_mm);
    out->level_mm = level_mm;
    /* Without the factor 64 GCC uses a signed division, which costs 484 more bytes on a Cortex-M0+. */
    out->per_mille = (uint16_t)to_nearest(UINT32_C(64000) * inside_mm, UINT32_C(64) * height_mm);
    return FATHOM_OK;
}
