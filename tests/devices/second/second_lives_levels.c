/* SPDX-License-Identifier: MIT */
#include "second_lives.h"

#include "suite.h"

enum { SETTLED_US = 10000000 };

static const second_scene_t there[] = {
    {{754, 1500, 1500, 1500}},   {{3000, 3000, 3000, 3000}},
    {{1000, 1000, 1000, 1000}},  {{SECOND_NOTHING, SECOND_NOTHING, SECOND_NOTHING, 900}},
    {{15000, 2000, 2000, 2000}}, {{523, 1200, 999, 1200}}};
enum { THERE = sizeof there / sizeof there[0] };

static void live(rig_t *rig, const char *name, const fathom_sensor_t *any)
{
    for (size_t i = 0; i < THERE; i++) {
        second_scene(&rig->device, &there[i], rig->now_us);
        judge_poll(name, any, 12, SETTLED_US);
    }
}

void life_a16_pwm(rig_t *rig)
{
    fathom_a16_pwm_t sensor;
    fathom_capture_t capture = fathom_edges_capture(&rig->edges);
    const fathom_output_t trigger = fathom_output_break(&rig->uart);
    rig_power(rig, true);
    assert_int_equal(fathom_a16_pwm_init(&sensor, &capture, &rig->clock, &trigger, NULL), FATHOM_OK);
    fathom_sensor_t any = fathom_a16_pwm_sensor(&sensor);
    live(rig, "a16_pwm", &any);
    fathom_a16_pwm_deinit(&sensor);
}

void life_a16_switch(rig_t *rig)
{
    fathom_a16_switch_t sensor;
    fathom_a16_switch_config_t config = {.timing = {.period_us = 700000}};
    rig_power(rig, true);
    assert_int_equal(fathom_a16_switch_init(&sensor, &rig->pin, &rig->clock, &config), FATHOM_OK);
    fathom_sensor_t any = fathom_a16_switch_sensor(&sensor);
    live(rig, "a16_switch", &any);
}

void life_a05_relay(rig_t *rig)
{
    fathom_a05_relay_t sensor;
    fathom_a05_relay_config_t config = {.timing = {.period_us = 700000}};
    rig_power(rig, true);
    assert_int_equal(fathom_a05_relay_init(&sensor, &rig->pin, &rig->clock, &config), FATHOM_OK);
    fathom_sensor_t any = fathom_a05_relay_sensor(&sensor);
    live(rig, "a05_relay", &any);
}
