/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_SETTINGS_H
#define FATHOM_TESTS_SETTINGS_H

#include <stdint.h>

#include "fathom/fathom.h"
#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/hps167s.h"

/* The sensors and modes that are soaked, and what their papers and headers say of them. */

typedef enum {
    SOAK_A16_AUTO,
    SOAK_A16_TIGHT, /* frames without pauses: no gap is ever seen */
    SOAK_A05_AUTO,
    SOAK_A05_TIGHT,
    SOAK_A16_PROCESSED,
    SOAK_A16_REAL_TIME,
    SOAK_A05_MODBUS,
    SOAK_A05_DYP,
    SOAK_A05_DYP_ONE, /* its third probe alone */
    SOAK_HPS167S,
    SOAK_SETTINGS
} soak_setting_t;

/* What vouches for a frame. */
typedef enum { SOAK_GAP, SOAK_NO_GAP, SOAK_CRC, SOAK_SUM } soak_proof_t;

typedef struct {
    const char *name;
    uint8_t proof;        /* soak_proof_t */
    uint8_t model;        /* fathom_model_t */
    uint8_t first;        /* probe */
    uint8_t probes;       /* samples a response or frame */
    uint8_t length;       /* bytes of it */
    uint16_t char_us;     /* of one byte */
    uint16_t least_mm;    /* what the scene gives: least_mm..least_mm + span_mm - 1 */
    uint16_t span_mm;     /* no multiple of 7 */
    uint32_t period_us;   /* asked: from request to request, at least; else from frame to frame */
    uint32_t timeout_us;  /* asked: first byte; else: without a good frame it is stale */
    uint32_t response_us; /* asked: the longest that the simulator takes */
} soak_facts_t;

extern const soak_facts_t soak_facts[SOAK_SETTINGS];

bool soak_is_asked(uint8_t setting);

/* What can be changed of a driver, to see what it is good for. 0: as ever. */
typedef struct {
    uint32_t stale_us, backoff_us;
    uint16_t gap_us, max_mm;
    uint8_t retries;
    uint8_t echo; /* FATHOM_LINE_ECHO_... */
} soak_options_t;

typedef union {
    fathom_sim_a16_t a16;
    fathom_sim_a05_t a05;
    fathom_sim_hps167s_t hps167s;
} soak_device_t;

typedef union {
    fathom_a16_auto_t a16_auto;
    fathom_a05_auto_t a05_auto;
    fathom_a16_modbus_t a16_modbus;
    fathom_a05_modbus_t a05_modbus;
    fathom_a05_dyp_t a05_dyp;
    fathom_hps167s_t hps167s;
} soak_driver_t;

/* The simulated sensor with this address and scene. */
fathom_sim_device_t *soak_device_init(soak_device_t *device, uint8_t setting, uint8_t address,
                                      const fathom_sim_scene_t *scene, uint32_t seed);

/* Its driver on `line`. The line outlives it. */
fathom_sensor_t soak_driver_init(soak_driver_t *driver, uint8_t setting, uint8_t address, fathom_line_t *line,
                                 const fathom_modbus_t *modbus, const soak_options_t *options);

/* The counters of a driver; NULL where it has none of the kind. */
const fathom_modbus_unit_t *soak_unit_of(const soak_driver_t *driver, uint8_t setting);
fathom_stream_t *soak_stream_of(soak_driver_t *driver, uint8_t setting);
uint16_t soak_implausible(const soak_driver_t *driver, uint8_t setting);

#endif
