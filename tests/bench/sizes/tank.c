/* SPDX-License-Identifier: MIT */
#include "programs.h"

/* a16_auto with what is made of its readings. `tank` is the loop of the README's program for a microcontroller. */

static uint16_t window[5];
static fathom_median_t median;
static fathom_alarm_t alarm;

fathom_sensor_t a16_auto_alarm_begin(void)
{
    static const fathom_alarm_config_t config = {.when = FATHOM_NEAR,
                                                 .on_mm = 500,
                                                 .off_mm = 600,
                                                 .if_unknown = FATHOM_ALARM_ON,
                                                 .if_no_response = FATHOM_ALARM_ON};
    fathom_alarm_init(&alarm, &config);
    return a16_auto_begin();
}

void a16_auto_alarm_use(const fathom_sample_t *sample)
{
    a16_auto_use(sample);
    outcome = fathom_alarm_add_sample(&alarm, sample);
    outcome = fathom_alarm_add_status(&alarm, FATHOM_PENDING, clock.now_us(clock.ctx));
    outcome = fathom_alarm_is_on(&alarm);
}

fathom_sensor_t a16_auto_median_begin(void)
{
    static const fathom_median_config_t config = {.window = window, .count = 5, .gate_mm = 300};
    fathom_median_init(&median, &config);
    return a16_auto_begin();
}

static bool steady(const fathom_sample_t *sample, fathom_sample_t *out)
{
    a16_auto_use(sample);
    outcome = fathom_median_advance(&median, clock.now_us(clock.ctx));
    return fathom_median_add_sample(&median, sample, out);
}

void a16_auto_median_use(const fathom_sample_t *sample)
{
    fathom_sample_t out;
    if (steady(sample, &out)) outcome = out.distance_mm;
}

static void show(const fathom_sample_t *sample, const fathom_level_config_t *config)
{
    fathom_sample_t out;
    fathom_level_t tank;
    if (steady(sample, &out) && out.kind == FATHOM_TARGET &&
        fathom_level_from_distance(config, out.distance_mm, &tank) == FATHOM_OK)
        level = tank.volume > 4500;
}

fathom_sensor_t tank_begin(void) { return a16_auto_median_begin(); }

void tank_use(const fathom_sample_t *sample)
{
    static const fathom_level_config_t config = {
        .volume = fathom_tank_upright, .capacity = 5000, .mounting_mm = 2300, .height_mm = 2000};
    show(sample, &config);
}

fathom_sensor_t tank_lying_begin(void) { return a16_auto_median_begin(); }

void tank_lying_use(const fathom_sample_t *sample)
{
    static const fathom_level_config_t config = {
        .volume = fathom_tank_horizontal_cylinder, .capacity = 5000, .mounting_mm = 2300, .height_mm = 2000};
    show(sample, &config);
}

fathom_sensor_t tank_table_begin(void) { return a16_auto_median_begin(); }

void tank_table_use(const fathom_sample_t *sample)
{
    static const fathom_level_point_t points[] = {{400, 500}, {4000, 1500}, {5000, 2000}};
    static const fathom_level_config_t config = {.volume = fathom_tank_table,
                                                 .points = points,
                                                 .point_count = 3,
                                                 .mounting_mm = 2300,
                                                 .height_mm = 2000};
    show(sample, &config);
}
