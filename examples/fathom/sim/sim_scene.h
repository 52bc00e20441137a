/* SPDX-License-Identifier: MIT */
#ifndef SIM_SCENE_H
#define SIM_SCENE_H

#include "models/models.h"
#include "sim/scene.h"

enum { SCENERY_PROBES = 4 };

/* What a simulated sensor sees. It may not be moved while one looks at it. */
typedef struct {
    fathom_sim_scene_t scene;
    fathom_sim_fixed_t fixed;
    fathom_sim_moving_t moving[SCENERY_PROBES];
} scenery_t;

/* A list such as "1000,2000,no-target". False after saying what is wrong with it. */
bool scenery_fixed(scenery_t *scenery, const char *command, const sensor_t *sensor, const char *list);

/* Something that moves, each probe's at another speed. */
void scenery_moving(scenery_t *scenery, const sensor_t *sensor, uint32_t seed, uint32_t now_us);

#endif
