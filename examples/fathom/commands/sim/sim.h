/* SPDX-License-Identifier: MIT */
#ifndef SIM_H
#define SIM_H

#include "cli/command.h"
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

/* Texts of an option that can be given several times. */
typedef struct {
    uint8_t count;
    const char *text[FATHOM_SIM_FAULT_RULES];
} sim_texts_t;

/* Options that apply to all sensors that can have them, or keys behind a sensor. */
typedef struct {
    const char *distance; /* NULL: the target moves */
    uint32_t baud;        /* 0: of the factory */
    sim_texts_t with;
    sim_texts_t faults;
} sim_keys_t;

typedef struct {
    const char *link; /* NULL: none */
    bool has_echo;
    bool has_counters;
    bool one_by_one; /* connects each sensor when the sensor before it has left its first address */
    uint32_t seed;
    sim_keys_t keys; /* of all sensors */
} sim_settings_t;

extern const option_table_t sim_tables[];

/* The sensors of a line. */
typedef struct {
    uint32_t count;
    sim_sensor_t sensors[SIM_SENSORS];
} sim_site_t;

/* Reads the words of the sensors with their keys. Returns false after rejecting one. The scenes are in *site, so the site
 * may not be moved. */
bool sim_sensors(sim_site_t *site, const arguments_t *arguments);

/* ---- the keys of a sensor ---- */

/* Each of these returns false after rejecting the text. */
bool sim_set_distance(sim_sensor_t *sensor, const char *list, const origin_t *origin);
bool sim_add_trait(sim_sensor_t *sensor, const char *text, const origin_t *origin);
bool sim_add_fault(sim_sensor_t *sensor, const char *text, const origin_t *origin);

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

/* The names of all traits and faults, for option_t.list. */
const char *sim_trait_name(size_t n);
const char *sim_fault_name(size_t n);

/* The tables of `fathom help faults`. */
void sim_print_traits(FILE *to);
void sim_print_faults(FILE *to);

/* ---- what the command prints ---- */

/* Prints which sensors the line has and how to read them. port: the name to open. */
void sim_announce(FILE *to, const sim_site_t *site, bool one_by_one, const char *port);

/* Prints a JSON object of sensor i: its place on the command line, its present address and rate, its counters, and the
 * collisions on the line. */
void sim_print_counters(FILE *to, const sim_site_t *site, uint32_t i, const fathom_sim_device_t *device,
                        const fathom_sim_line_t *line);

#endif
