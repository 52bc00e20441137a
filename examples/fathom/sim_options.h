/* SPDX-License-Identifier: MIT */
#ifndef SIM_OPTIONS_H
#define SIM_OPTIONS_H

#include "scenery.h"
#include "sensors.h"
#include "sim_faults.h"

/* What `fathom sim` was asked to do. */
typedef struct {
    const sensor_t *sensor;
    const sensor_mode_t *mode;
    const char *link; /* NULL: none */
    uint8_t address;
    uint32_t seed;
    scenery_t scene;
    sim_faults_t faults;
    bool wants_help;
} sim_options_t;

/* False after saying what is wrong with them. The options may not be moved then: the scene is in them. */
bool sim_options(sim_options_t *options, int argc, char **argv);

void sim_help(FILE *to);

#endif
