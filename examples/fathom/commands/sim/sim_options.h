/* SPDX-License-Identifier: MIT */
#ifndef SIM_OPTIONS_H
#define SIM_OPTIONS_H

#include "commands/sim/sim_faults.h"
#include "commands/sim/sim_scene.h"
#include "sensors/models.h"

enum { SIM_DEVICES = 64 };

typedef struct {
    const model_t *model;
    const model_mode_t *mode;
    fathom_line_settings_t line; /* its own */
    uint32_t seed;
    uint8_t address;
    uint32_t traits[DEVICE_TRAITS];
    sim_scene_t scene;
    sim_faults_t faults;
} sim_device_t;

/* What `fathom sim` was asked to do. */
typedef struct {
    const char *link; /* NULL: none */
    bool echo;
    bool counters;
    bool one_by_one; /* each is connected when those before it have left the address that they came with */
    bool wants_help;
    uint32_t count; /* of devices */
    sim_device_t devices[SIM_DEVICES];
} sim_options_t;

/* False after saying what is wrong with them. The options may not be moved then: the scenes are in them. */
bool sim_options(sim_options_t *options, int argc, char **argv);

#endif
