/* SPDX-License-Identifier: MIT */
#include "sim/sim_scene.h"

#include <string.h>

#include "shared/command.h"
#include "shared/options.h"

enum { MAX_VALUE = 65535, MAX_WORD = 16 };

static bool parse_value(const sensor_t *sensor, const char *word, int32_t *value)
{
    uint32_t number = 0;
    if (strcmp(word, "no-target") == 0)
        *value = FATHOM_SIM_NO_TARGET;
    else if (strcmp(word, "interference") == 0 && !sensor->has_optics)
        *value = FATHOM_SIM_INTERFERENCE;
    else if (strcmp(word, "fault") == 0 && sensor->has_optics)
        *value = FATHOM_SIM_FAULT;
    else if (number_parse(word, 0, MAX_VALUE, &number))
        *value = (int32_t)number;
    else
        return false;
    return true;
}

bool scenery_fixed(scenery_t *scenery, const char *command, const sensor_t *sensor, const char *list)
{
    uint8_t count = 0;
    int32_t value = 0;
    for (const char *at = list;; at++) {
        const size_t length = strcspn(at, ",");
        char word[MAX_WORD] = "";
        if (length < sizeof word) memcpy(word, at, length);
        if (count == sensor->probes) {
            (void)usage_error(command, "--distance '%s' is more than the %u of %s", list, sensor->probes,
                              sensor->name);
            return false;
        }
        if (!parse_value(sensor, word, &value)) {
            (void)usage_error(command, "--distance takes 0..%d mm, no-target or %s, not '%.*s'", MAX_VALUE,
                              sensor->has_optics ? "fault" : "interference", (int)length, at);
            return false;
        }
        scenery->fixed.value[count++] = value;
        at += length;
        if (*at == '\0') break;
    }
    for (; count != SCENERY_PROBES; count++) scenery->fixed.value[count] = value;
    scenery->scene = fathom_sim_fixed(&scenery->fixed);
    return true;
}

static int32_t moving_distance(void *ctx, uint8_t probe, uint32_t now_us)
{
    scenery_t *const scenery = ctx;
    if (probe < 1 || probe > SCENERY_PROBES) return FATHOM_SIM_NO_TARGET;
    const fathom_sim_scene_t one = fathom_sim_moving(&scenery->moving[probe - 1]);
    return one.distance(one.ctx, probe, now_us);
}

void scenery_moving(scenery_t *scenery, const sensor_t *sensor, uint32_t seed, uint32_t now_us)
{
    for (uint8_t i = 0; i != SCENERY_PROBES; i++) {
        fathom_sim_moving_t *const moving = &scenery->moving[i];
        moving->from_mm = sensor->near_mm;
        moving->to_mm = sensor->far_mm;
        moving->period_us = 8000000u + i * 3000000u;
        moving->start_us = now_us - seed % moving->period_us;
    }
    scenery->scene.distance = moving_distance;
    scenery->scene.ctx = scenery;
}
