/* SPDX-License-Identifier: MIT */
#ifndef DEVICES_H
#define DEVICES_H

#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/hps167s.h"

typedef struct {
    uint8_t address;
    uint32_t baud; /* 0: the factory's; only a sensor that can be set to another rate looks at it */
    uint32_t seed;
    fathom_sim_scene_t scene;
} device_settings_t;

/* Any simulated sensor. */
typedef struct {
    fathom_sim_device_t *base; /* for fathom_sim_attach */
    union {
        fathom_sim_a16_t a16;
        fathom_sim_a05_t a05;
        fathom_sim_hps167s_t hps167s;
    } model;
} device_t;

typedef void (*device_init_t)(device_t *device, const device_settings_t *settings);

void device_a16_auto(device_t *device, const device_settings_t *settings);
void device_a16_modbus(device_t *device, const device_settings_t *settings);
void device_a05_auto(device_t *device, const device_settings_t *settings);
void device_a05_modbus(device_t *device, const device_settings_t *settings);
void device_a05_dyp(device_t *device, const device_settings_t *settings);
void device_hps167s(device_t *device, const device_settings_t *settings);

#endif
