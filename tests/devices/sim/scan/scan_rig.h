/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_SCAN_RIG_H
#define FATHOM_TESTS_SCAN_RIG_H

#include "suite.h"

#include "commands/scan/scan_walk.h"
#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/fault.h"
#include "sim/hps167s.h"
#include "sim/scene.h"
#include "sim/uart.h"

/* A scan of simulated devices on one pair, in simulated time; each request that leaves is looked at. */
enum { RIG_DEVICES = 8, RIG_FINDINGS = 300 };

typedef struct {
    fathom_sim_clock_t sim_clock;
    fathom_sim_line_t sim_line;
    fathom_sim_uart_t sim_uart;
    fathom_sim_a16_t a16[RIG_DEVICES];
    fathom_sim_a05_t a05[RIG_DEVICES];
    fathom_sim_hps167s_t hps[RIG_DEVICES];
    uint8_t a16s, a05s, hpss;

    fathom_uart_t uart; /* the listener's */
    fathom_uart_t inner;
    fathom_clock_t clock;
    listener_t listener;
    uint8_t frame[255];
    fathom_line_parts_t config;
    fathom_line_t line;
    scan_wire_t wire;

    uint32_t coarse_us; /* not 0: a loop that comes round so often */
    uint32_t waits_left;
    uint32_t passed_us; /* in all waits */
    uint32_t refused_baud;
    bool is_broken;
    uint32_t requests;
    uint32_t probed[SCAN_RATES][SCAN_PARITIES]; /* first requests, by the settings of the line */

    scan_plan_t plan;
    scan_tell_t tell;
    scan_walk_t walk;
    scan_finding_t findings[RIG_FINDINGS];
    uint16_t found;
    uint32_t unsupported;
    uint64_t progress_us;
} rig_t;

extern rig_t rig;

/* An empty line; the plan is the tool's default: 1..32 at the factory's two settings. */
void rig_begin(uint32_t start_us);

typedef fathom_sim_a16_config_t a16_config_t;
typedef fathom_sim_a05_config_t a05_config_t;
typedef fathom_sim_hps167s_config_t hps_config_t;
void rig_a16(a16_config_t config); /* mode 0: Modbus */
void rig_a05(a05_config_t config); /* mode 0: Modbus */
void rig_hps(hps_config_t config);
void rig_attach(fathom_sim_device_t *device);

/* All rates and parities, every address. */
void rig_plan_everything(void);

/* The walk, which ends well; and has found so many. */
void rig_walk(void);
void rig_finds(uint16_t count);

/* The finding at an address; NULL: none. Fails when there are two. */
const scan_finding_t *rig_find(uint8_t address);
void rig_expect_sensor(uint8_t address, fathom_model_t model, scan_mode_t mode,
                       const fathom_line_settings_t *line);

/* In Modbus, at the settings of the factory. */
void rig_expect(uint8_t address, fathom_model_t model);

/* No simulated device has been written to, or was met with the reset's address. */
void rig_expect_unharmed(void);

#endif
