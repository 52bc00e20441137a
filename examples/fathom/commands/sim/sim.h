/* SPDX-License-Identifier: MIT */
#ifndef SIM_H
#define SIM_H

#include <stdio.h>

#include "sensors/models.h"
#include "sim/fault.h"
#include "sim/scene.h"
#include "sim/sim.h"

enum { SIM_SENSORS = 64, SIM_PROBES = 4 };

/* What a simulated sensor measures. The address of a scene may not change while a simulation runs. */
typedef struct {
    fathom_sim_scene_t scene;
    fathom_sim_fixed_t fixed;
    fathom_sim_moving_t moving[SIM_PROBES];
} sim_scene_t;

/* One --fault. */
typedef struct {
    uint8_t kind;
    uint32_t chance_ppm;
    uint32_t at_frame; /* from 1; 0: any frame */
} sim_fault_t;

typedef struct {
    const model_t *model;
    const model_mode_t *mode;
    fathom_line_settings_t line;
    uint32_t seed;
    uint8_t address;
    uint32_t traits[DEVICE_TRAITS];
    sim_scene_t scene;
    uint8_t fault_count;
    sim_fault_t faults[FATHOM_SIM_FAULT_RULES];
} sim_sensor_t;

typedef struct {
    const char *link; /* NULL: none */
    bool echo;
    bool counters;
    bool one_by_one; /* connects each sensor when the sensor before it has left its first address */
    bool wants_help;
    uint32_t count; /* of sensors */
    sim_sensor_t sensors[SIM_SENSORS];
} sim_options_t;

/* Returns false after a usage error. The scenes are in *options, so the options may not be moved. */
bool sim_options(sim_options_t *options, int argc, char **argv);
void sim_help(FILE *to);

/* ---- the keys of a sensor: distance=, baud=, with=, fault= ---- */

/* Each of these returns false after a usage error. */
bool sim_set_distance(sim_sensor_t *sensor, const char *list);
bool sim_add_trait(sim_sensor_t *sensor, const char *text);
bool sim_add_fault(sim_sensor_t *sensor, const char *text);

/* Makes the target of each probe move to and fro, each at another speed. */
void sim_move(sim_sensor_t *sensor, uint32_t now_us);

/* Returns true if the sensor can have the trait that `text` names. */
bool sim_can_have_trait(const sim_sensor_t *sensor, const char *text);

/* Returns true if the sensor can have this kind of fault. */
bool sim_can_have_fault(const sim_sensor_t *sensor, uint8_t kind);

/* Reads a decimal such as 18.5 with up to `places` digits behind its point as a whole number: 18500 with 3 places.
 * Returns false if the first `length` bytes of `text` are no such number from `min` to `max`. */
bool sim_decimal(const char *text, size_t length, uint32_t places, uint32_t min, uint32_t max,
                 uint32_t *number);

/* The tables of the help. */
void sim_print_traits(FILE *to);
void sim_print_faults(FILE *to);

/* ---- what the command prints ---- */

/* Prints which sensors the line has and how to read them. port: the name to open. */
void sim_announce(FILE *to, const sim_options_t *options, const char *port);

/* Prints a JSON object of sensor i: its place on the command line, its present address and rate, its counters, and the
 * collisions on the line. */
void sim_print_counters(FILE *to, const sim_options_t *options, uint32_t i, const fathom_sim_device_t *device,
                        const fathom_sim_line_t *line);

#endif
