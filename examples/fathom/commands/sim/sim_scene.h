/* SPDX-License-Identifier: MIT */
#ifndef SIM_SCENE_H
#define SIM_SCENE_H

#include "sensors/models.h"
#include "sim/scene.h"

enum { SIM_SCENE_PROBES = 4 };

/* What a simulated sensor sees. It may not be moved while one looks at it. */
typedef struct {
    fathom_sim_scene_t scene;
    fathom_sim_fixed_t fixed;
    fathom_sim_moving_t moving[SIM_SCENE_PROBES];
} sim_scene_t;

/* A list such as "1000,2000,no-target". False after saying what is wrong with it. */
bool sim_scene_fixed(sim_scene_t *scene, const char *command, const model_t *model, const char *list);

/* Something that moves, each probe's at another speed. */
void sim_scene_moving(sim_scene_t *scene, const model_t *model, uint32_t seed, uint32_t now_us);

#endif
