/* SPDX-License-Identifier: MIT */
#include "commands/sim/sim_scene.h"

#include <string.h>

#include "cli/command.h"
#include "cli/options.h"

enum { MAX_VALUE = 65535, MAX_WORD = 16 };

static bool parse_value(const model_t *model, const char *word, int32_t *value)
{
    uint32_t number = 0;
    if (strcmp(word, "no-target") == 0)
        *value = FATHOM_SIM_NO_TARGET;
    else if (strcmp(word, "interference") == 0 && !model->has_optics)
        *value = FATHOM_SIM_INTERFERENCE;
    else if (strcmp(word, "fault") == 0 && model->has_optics)
        *value = FATHOM_SIM_FAULT;
    else if (number_parse(word, 0, MAX_VALUE, &number))
        *value = (int32_t)number;
    else
        return false;
    return true;
}

bool sim_scene_fixed(sim_scene_t *scene, const char *command, const model_t *model, const char *list)
{
    uint8_t count = 0;
    int32_t value = 0;
    for (const char *at = list;; at++) {
        const size_t length = strcspn(at, ",");
        char word[MAX_WORD] = "";
        if (length < sizeof word) memcpy(word, at, length);
        if (count == model->probes) {
            (void)usage_error(command, "--distance '%s' is more than the %u of %s", list, model->probes,
                              model->name);
            return false;
        }
        if (!parse_value(model, word, &value)) {
            (void)usage_error(command, "--distance takes 0..%d mm, no-target or %s, not '%.*s'", MAX_VALUE,
                              model->has_optics ? "fault" : "interference", (int)length, at);
            return false;
        }
        scene->fixed.value[count++] = value;
        at += length;
        if (*at == '\0') break;
    }
    for (; count != SIM_SCENE_PROBES; count++) scene->fixed.value[count] = value;
    scene->scene = fathom_sim_fixed(&scene->fixed);
    return true;
}

static int32_t moving_distance(void *ctx, uint8_t probe, uint32_t now_us)
{
    sim_scene_t *const scene = ctx;
    if (probe < 1 || probe > SIM_SCENE_PROBES) return FATHOM_SIM_NO_TARGET;
    const fathom_sim_scene_t one = fathom_sim_moving(&scene->moving[probe - 1]);
    return one.distance(one.ctx, probe, now_us);
}

void sim_scene_moving(sim_scene_t *scene, const model_t *model, uint32_t seed, uint32_t now_us)
{
    for (uint8_t i = 0; i != SIM_SCENE_PROBES; i++) {
        fathom_sim_moving_t *const moving = &scene->moving[i];
        moving->from_mm = model->near_mm;
        moving->to_mm = model->far_mm;
        moving->period_us = 8000000u + i * 3000000u;
        moving->start_us = now_us - seed % moving->period_us;
    }
    scene->scene.distance = moving_distance;
    scene->scene.ctx = scene;
}
