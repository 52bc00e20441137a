/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "commands/sim/sim.h"
#include "output/words.h"

enum { MAX_MM = 65535, MAX_WORD = 24 };

/* What a sensor may report instead of a distance; the faults of the same name do it by chance. */
static const struct {
    uint8_t fault;
    int32_t value;
    bool is_optical; /* optical sensors report it */
    bool is_sonic;   /* ultrasonic sensors report it */
} conditions[] = {{FATHOM_SIM_FAULT_NO_TARGET, FATHOM_SIM_NO_TARGET, true, true},
                  {FATHOM_SIM_FAULT_INTERFERENCE, FATHOM_SIM_INTERFERENCE, false, true},
                  {FATHOM_SIM_FAULT_FAULT, FATHOM_SIM_FAULT, true, false}};
enum { CONDITIONS = sizeof conditions / sizeof conditions[0] };

static bool can_report(const sim_sensor_t *sensor, size_t condition)
{
    return sensor->model->has_optics ? conditions[condition].is_optical : conditions[condition].is_sonic;
}

static bool parse_value(const sim_sensor_t *sensor, const char *word, int32_t *value)
{
    uint32_t mm = 0;
    for (size_t i = 0; i != CONDITIONS; i++) {
        if (strcmp(word, fathom_sim_fault_name(conditions[i].fault)) != 0) continue;
        *value = conditions[i].value;
        return can_report(sensor, i);
    }
    if (!number_parse(word, 0, MAX_MM, &mm)) return false;
    *value = (int32_t)mm;
    return true;
}

static bool reject_value(const sim_sensor_t *sensor, const char *word, const origin_t *origin)
{
    char words[64] = "";
    for (size_t i = 0; i != CONDITIONS; i++)
        if (can_report(sensor, i)) list_add(words, sizeof words, fathom_sim_fault_name(conditions[i].fault));
    return reject(origin, "distance of %s is '%s'. It takes 0 to %d mm, %s.", sensor->model->name, word,
                  MAX_MM, words);
}

bool sim_set_distance(sim_sensor_t *sensor, const char *list, const origin_t *origin)
{
    sim_scene_t *const scene = &sensor->scene;
    uint8_t count = 0;
    int32_t value = 0;
    for (const char *rest = list; rest != NULL;) {
        char word[MAX_WORD];
        rest = next_word(rest, ',', word, sizeof word);
        if (count == sensor->model->probes)
            return reject(origin, "distance '%s' is more than the %u of %s.", list, sensor->model->probes,
                          sensor->model->name);
        if (!parse_value(sensor, word, &value)) return reject_value(sensor, word, origin);
        scene->fixed.value[count++] = value;
    }
    for (; count != SIM_PROBES; count++) scene->fixed.value[count] = value;
    scene->scene = fathom_sim_fixed(&scene->fixed);
    return true;
}

static int32_t moving_distance(void *ctx, uint8_t probe, uint32_t now_us)
{
    sim_scene_t *const scene = ctx;
    if (probe < 1 || probe > SIM_PROBES) return FATHOM_SIM_NO_TARGET;
    const fathom_sim_scene_t one = fathom_sim_moving(&scene->moving[probe - 1]);
    return one.distance(one.ctx, probe, now_us);
}

void sim_move(sim_sensor_t *sensor, uint32_t now_us)
{
    for (uint8_t i = 0; i != SIM_PROBES; i++) {
        fathom_sim_moving_t *const moving = &sensor->scene.moving[i];
        moving->from_mm = sensor->model->near_mm;
        moving->to_mm = sensor->model->far_mm;
        moving->period_us = 8000000u + i * 3000000u;
        moving->start_us = now_us - sensor->seed % moving->period_us;
    }
    sensor->scene.scene = (fathom_sim_scene_t){.distance = moving_distance, .ctx = &sensor->scene};
}
