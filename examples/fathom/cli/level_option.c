/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <string.h>

#include "cli/command.h"
#include "cli/key_list.h"
#include "cli/options.h"
#include "cli/result_options.h"

static const char name[] = "level";

static bool take_mm(const char *value, uint16_t *mm)
{
    uint32_t number = 0;
    if (!number_parse(value, 1, UINT16_MAX, &number)) return false;
    *mm = (uint16_t)number;
    return true;
}

static bool take_mounting(void *ctx, const char *value)
{
    return take_mm(value, &((results_config_t *)ctx)->tank.mounting_mm);
}

static bool take_height(void *ctx, const char *value)
{
    return take_mm(value, &((results_config_t *)ctx)->tank.height_mm);
}

static bool take_capacity(void *ctx, const char *value)
{
    return number_parse(value, 1, UINT32_MAX, &((results_config_t *)ctx)->tank.capacity);
}

static bool take_shape(void *ctx, const char *value)
{
    static const struct {
        const char *name;
        fathom_tank_volume_t volume;
    } shapes[] = {{"upright", fathom_tank_upright},
                  {"horizontal-cylinder", fathom_tank_horizontal_cylinder},
                  {"table", fathom_tank_table}};
    for (size_t i = 0; i != sizeof shapes / sizeof shapes[0]; i++) {
        if (strcmp(value, shapes[i].name) != 0) continue;
        ((results_config_t *)ctx)->tank.volume = shapes[i].volume;
        return true;
    }
    return false;
}

/* LEVEL:VOLUME */
static bool take_point(const char *text, fathom_level_point_t *point)
{
    char word[16];
    uint32_t level_mm = 0;
    const char *const volume = next_word(text, ':', word, sizeof word);
    if (volume == NULL || !number_parse(word, 0, UINT16_MAX, &level_mm) ||
        !number_parse(volume, 0, UINT32_MAX, &point->volume))
        return false;
    point->level_mm = (uint16_t)level_mm;
    return true;
}

static bool take_points(void *ctx, const char *value)
{
    results_config_t *const config = ctx;
    config->tank.points = config->points;
    for (const char *at = value; at != NULL;) {
        char point[32];
        at = next_word(at, '/', point, sizeof point);
        if (config->tank.point_count == RESULTS_POINTS ||
            !take_point(point, &config->points[config->tank.point_count++]))
            return false;
    }
    return true;
}

static bool take_offset(void *ctx, const char *value)
{
    const bool is_below = value[0] == '-';
    uint32_t mm = 0;
    if (!number_parse(is_below ? value + 1 : value, 0, INT16_MAX, &mm)) return false;
    ((results_config_t *)ctx)->tank.offset_mm = (int16_t)(is_below ? -(int32_t)mm : (int32_t)mm);
    return true;
}

static const key_row_t keys[] = {
    {"mounting", "the mm from the tank's bottom to the sensor's face, from 1 to 65535", take_mounting, true},
    {"height", "the level in mm at which the tank is full, from 1 to 65535", take_height, true},
    {"capacity", "the volume of the full tank, a whole number from 1 to 4294967295 in any unit",
     take_capacity, false},
    {"shape", "upright, horizontal-cylinder or table", take_shape, false},
    {"points", "up to 32 of LEVEL:VOLUME, the level in mm, such as 500:400/1500:4000/2000:5000", take_points,
     false},
    {"offset", "the mm that are added to each distance, from -32767 to 32767", take_offset, false},
};

/* Up to which point is the table as fathom_level_check wants it? */
static bool check_points(const results_config_t *config, const char *command)
{
    fathom_level_config_t tank = config->tank;
    for (tank.point_count = tank.point_count > 1 ? 2 : 1; tank.point_count <= config->tank.point_count;
         tank.point_count++) {
        const fathom_level_point_t *const last = &config->points[tank.point_count - 1];
        if (fathom_level_check(&tank) == FATHOM_OK) continue;
        (void)usage_error(command,
                          "--%s: points= at %u:%" PRIu32
                          ": level and volume grow from point to point, and a full tank has a volume",
                          name, last->level_mm, last->volume);
        return false;
    }
    return true;
}

bool level_option(results_config_t *config, const char *command, const char *text)
{
    fathom_level_config_t *const tank = &config->tank;
    tank->volume = fathom_tank_upright;
    config->has_level = true;
    if (!key_list(command, name, text, keys, sizeof keys / sizeof keys[0], config)) return false;
    const bool is_table = tank->volume == fathom_tank_table;
    if (is_table == (tank->points != NULL) && is_table == (tank->capacity == 0))
        return !is_table || check_points(config, command);
    (void)usage_error(command,
                      is_table ? "--%s: shape=table takes points=, of which the last one is the full tank, "
                                 "and no capacity="
                               : "--%s: capacity= is missing, or there are points=, which only shape=table "
                                 "takes",
                      name);
    return false;
}
