/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <string.h>

#include "cli/rows.h"
#include "output/words.h"

/* ---- --level ---- */

static const char shapes[] = "upright horizontal-cylinder table";

static bool parse_shape(const char *text, void *member)
{
    static const fathom_tank_volume_t volumes[] = {fathom_tank_upright, fathom_tank_horizontal_cylinder,
                                                   fathom_tank_table};
    uint32_t n = 0;
    if (!word_find(shapes, text, &n)) return false;
    *(fathom_tank_volume_t *)member = volumes[n];
    return true;
}

/* LEVEL:VOLUME */
static bool parse_point(const char *text, fathom_level_point_t *point)
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

static bool parse_points(const char *text, void *member)
{
    results_config_t *const config = member;
    config->tank.points = config->points;
    for (const char *at = text; at != NULL;) {
        char point[32];
        at = next_word(at, '/', point, sizeof point);
        if (config->tank.point_count == RESULTS_POINTS ||
            !parse_point(point, &config->points[config->tank.point_count++]))
            return false;
    }
    return true;
}

#define TANK(member) AT(results_config_t, tank.member)
static const option_t level_keys[] = {
    {"mounting", "MM", "Distance from the tank's bottom to the sensor's face", KIND_NUMBER, .min = 1,
     .max = UINT16_MAX, TANK(mounting_mm), .is_required = true},
    {"height", "MM", "Level at which the tank is full", KIND_NUMBER, .min = 1, .max = UINT16_MAX,
     TANK(height_mm), .is_required = true},
    {"capacity", "VOLUME", "Volume of the full tank, in any unit", KIND_NUMBER, .min = 1, .max = UINT32_MAX,
     TANK(capacity)},
    {"shape", "SHAPE", "Shape of the tank (upright)", KIND_CUSTOM, .words = shapes, .parse = parse_shape,
     TANK(volume)},
    {"points", "LEVEL:VOLUME/...", "Volumes of shape=table at levels in mm, at most 32", KIND_CUSTOM,
     .takes = "at most 32 of LEVEL:VOLUME, such as 500:400/1500:4000", .parse = parse_points},
    {"offset", "MM", "Distance to add to each reading", KIND_SIGNED, .max = INT16_MAX, TANK(offset_mm)},
    {.name = NULL},
};

/* Rejects the first point at which the table is not as fathom_level_check() wants it. */
static bool check_points(const results_config_t *config, const origin_t *origin)
{
    fathom_level_config_t tank = config->tank;
    for (tank.point_count = tank.point_count > 1 ? 2 : 1; tank.point_count <= config->tank.point_count;
         tank.point_count++) {
        const fathom_level_point_t *const last = &config->points[tank.point_count - 1];
        if (fathom_level_check(&tank) != FATHOM_OK)
            return reject(origin,
                          "points is wrong at %u:%" PRIu32
                          ". Level and volume grow from point to point, and the full tank has a volume.",
                          last->level_mm, last->volume);
    }
    return true;
}

static bool check_level(void *structure, const origin_t *origin)
{
    results_config_t *const config = structure;
    fathom_level_config_t *const tank = &config->tank;
    if (tank->volume == NULL) tank->volume = fathom_tank_upright;
    const bool is_table = tank->volume == fathom_tank_table;
    if (is_table && (tank->points == NULL || tank->capacity != 0))
        return reject(origin, "shape=table takes points= and no capacity=. The last point is the full tank.");
    if (!is_table && tank->points != NULL) return reject(origin, "points= is for shape=table.");
    if (!is_table && tank->capacity == 0) return reject(origin, "capacity is missing.");
    return !is_table || check_points(config, origin);
}

/* ---- --alarm ---- */

/* near<ON[/OFF] or far>ON[/OFF] */
static bool parse_when(const char *text, void *member)
{
    static const char near[] = "near<";
    static const char far[] = "far>";
    fathom_alarm_config_t *const alarm = member;
    const bool is_near = strncmp(text, near, sizeof near - 1) == 0;
    char word[32];
    uint32_t on_mm = 0;
    uint32_t off_mm = 0;
    if (!is_near && strncmp(text, far, sizeof far - 1) != 0) return false;
    const char *const rest =
        next_word(text + (is_near ? sizeof near : sizeof far) - 1, '/', word, sizeof word);
    if (!number_parse(word, 1, UINT16_MAX, &on_mm) ||
        !number_parse(rest != NULL ? rest : word, 1, UINT16_MAX, &off_mm))
        return false;
    alarm->when = is_near ? FATHOM_NEAR : FATHOM_FAR;
    alarm->on_mm = (uint16_t)on_mm;
    alarm->off_mm = (uint16_t)off_mm;
    return true;
}

#define ALARM(member) AT(fathom_alarm_config_t, member)
static const option_t alarm_keys[] = {
    {"when", "near<ON/OFF", "Thresholds in mm: near<ON/OFF or far>ON/OFF", KIND_CUSTOM, .parse = parse_when,
     .takes = "near<ON/OFF or far>ON/OFF, from 1 to 65535 mm, such as near<500/600", .is_required = true,
     .is_first = true},
    {"unknown", "on|off", "State while the distance is unknown", KIND_CHOICE, .words = "on off",
     .min = FATHOM_ALARM_ON, ALARM(if_unknown), .is_required = true},
    {"no-response", "on|off", "State while the sensor does not respond", KIND_CHOICE, .words = "on off",
     .min = FATHOM_ALARM_ON, ALARM(if_no_response), .is_required = true},
    {"hold", "MS/MS", "Time before the alarm switches on, and off", KIND_PAIR, .max = MAX_UNKNOWN_MS,
     .scale = 1000, ALARM(on_hold_us)},
    {"unknown-after", "MS", "Time without a distance until it is unknown", KIND_NUMBER, .min = 1,
     .max = MAX_UNKNOWN_MS, .scale = 1000, ALARM(unknown_us)},
    {"no-target", "far|unknown", "Meaning of a reading without a target (far)", KIND_CHOICE,
     .words = "far unknown", ALARM(no_target_is_unknown)},
    {.name = NULL},
};

static bool check_alarm(void *structure, const origin_t *origin)
{
    const fathom_alarm_config_t *const config = structure;
    fathom_alarm_t alarm;
    if (fathom_alarm_init(&alarm, config) == FATHOM_OK) return true;
    return reject(origin,
                  "the alarm cannot switch off at %u mm after it is on at %u mm. With near, OFF is the "
                  "greater distance; with far, the smaller one.",
                  config->off_mm, config->on_mm);
}

/* ---- the options ---- */

const option_t result_rows[] = {
    {"median", "N", "Print the median of N readings, 3 to 15", KIND_NUMBER, GROUP_PROCESSING,
     .min = FATHOM_MEDIAN_MIN_COUNT, .max = FATHOM_MEDIAN_MAX_COUNT, AT(results_config_t, median)},
    {"gate", "MM", "Drop readings MM or more off the median", KIND_NUMBER, GROUP_PROCESSING, .min = 1,
     .max = UINT16_MAX, AT(results_config_t, gate_mm), .needs = "median"},
    {"level", "KEYS", "Print level and volume of a tank", KIND_KEYS, GROUP_PROCESSING, .keys = level_keys,
     HAS(results_config_t, has_level), .check = check_level},
    {"alarm", "KEYS", "Print only changes of an alarm", KIND_KEYS, GROUP_PROCESSING, .keys = alarm_keys,
     AT(results_config_t, alarm), HAS(results_config_t, has_alarm), .check = check_alarm},
    {.name = NULL},
};

/* A median or an alarm that does not outlast the interval would never know a distance. */
static bool outlasts(const char *what, uint32_t unknown_us, uint32_t interval_us, const origin_t *origin)
{
    const char *const mark = origin->file == NULL ? "--" : "";
    if (unknown_us > interval_us) return true;
    return reject(origin,
                  "%sinterval is %" PRIu32 " ms, but %s%s knows nothing after %" PRIu32
                  " ms without a reading. Choose a shorter interval.",
                  mark, interval_us / 1000u, mark, what, unknown_us / 1000u);
}

bool results_finish(results_config_t *results, uint32_t interval_us, const origin_t *origin)
{
    enum { INTERVALS = 3 };
    const uint64_t intervals_us = (uint64_t)INTERVALS * interval_us;
    const uint32_t most_us = MAX_UNKNOWN_MS * 1000u;
    results->unknown_us = intervals_us < most_us ? (uint32_t)intervals_us : most_us;
    if (results->unknown_us < FATHOM_MEDIAN_DEFAULT_UNKNOWN_US)
        results->unknown_us = FATHOM_MEDIAN_DEFAULT_UNKNOWN_US;
    if (results->alarm.unknown_us == 0) results->alarm.unknown_us = results->unknown_us;
    return (results->median == 0 || outlasts("median", results->unknown_us, interval_us, origin)) &&
           (!results->has_alarm || outlasts("alarm", results->alarm.unknown_us, interval_us, origin));
}
