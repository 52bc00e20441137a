/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SIM_A16_H
#define FATHOM_SIM_A16_H

#include <stdbool.h>
#include <stdint.h>

#include "device.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A16, one ultrasonic probe, 9600 8N1.
 *
 * Automatic: FF H L SUM every 100 ms (A16 2, 5; the datasheet prints no period). The first Modbus command
 * to its address or to 0xFF ends that until power-off (A16 5(0), 6(3)).
 * Modbus (A16 6): function 03, one register a read:
 *   0x0100 processed distance, 0x0101 real-time distance (here the scene at the moment of the answer, both),
 *   0x0200 address, 0x0205 polarity, 0x0206 threshold, 0x0207 data type
 * and function 06 of 0x0200, 0x00..0xFE: echoed from the old address, obeyed at once. Everything else is
 * silence: the datasheet knows no exceptions. 0xFF is obeyed and not answered.
 * Not yet: 06 of 0x0202, 0x0205, 0x0206, 0x0207; PWM, controlled and switch output.
 */
typedef enum {
    FATHOM_SIM_A16_AUTO = 1,   /* RS-232: automatic, then Modbus (A16 5) */
    FATHOM_SIM_A16_MODBUS = 2, /* RS-485: Modbus only (A16 5) */
    FATHOM_SIM_A16_UART = 3    /* automatic for ever, hears nothing (A16 2) */
} fathom_sim_a16_mode_t;

/* Zero means the default. Copied by init; what the scene and the faults point at stays the caller's. */
typedef struct {
    uint8_t unit;                      /* Modbus address; default 1 */
    uint8_t mode;                      /* fathom_sim_a16_mode_t; must be given */
    bool exceptions;                   /* answers 01, 02 or 03 where the default is silence */
    bool answers_broadcast;            /* answers 0xFF, from its own address */
    uint16_t threshold_mm;             /* register 0x0206; default 1000 (A16 4(2)) */
    uint32_t seed;                     /* of the spread of the answer times; any */
    fathom_sim_scene_t scene;          /* probe 1; no target when empty */
    const fathom_sim_faults_t *faults; /* NULL: none */
    uint32_t period_us;                /* of automatic frames, from start to start; default 100 ms */
    uint32_t start_us;                 /* from power-on, silent and deaf; default none */
    uint32_t linger_us;                /* automatic frames still come for so long after the first command;
                                          default 150 ms; 1: none that has not begun */
    uint32_t realtime_us;              /* longest from the end of a request to the answer: 0x0101; 120 ms */
    uint32_t processed_us;             /* 0x0100; 520 ms (neither is in the datasheet) */
    uint32_t settings_us;              /* the other registers; 20 ms */
} fathom_sim_a16_config_t;

typedef struct {
    fathom_sim_device_t device; /* for fathom_sim_attach; device.counters */
    uint32_t realtime_us;
    uint32_t processed_us;
    uint32_t settings_us;
    uint16_t threshold_mm;
    uint8_t polarity;  /* 0x0205; 1 from the factory */
    uint8_t data_type; /* 0x0207; 0 processed */
    bool exceptions;
} fathom_sim_a16_t;

void fathom_sim_a16_init(fathom_sim_a16_t *a16, const fathom_sim_a16_config_t *config);

#ifdef __cplusplus
}
#endif

#endif
