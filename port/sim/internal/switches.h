/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SIM_SWITCHES_H
#define FATHOM_SIM_SWITCHES_H

#include "../a05.h"
#include "../a16.h"
#include "values.h"

/* Between a16.c and a16_switch.c, a05.c and a05_relay.c. */

/* The device is the first member. */
static inline fathom_sim_a05_t *fathom_sim_a05_of(fathom_sim_device_t *device)
{
    return (fathom_sim_a05_t *)(void *)device;
}

static inline fathom_sim_a16_t *fathom_sim_a16_of(fathom_sim_device_t *device)
{
    return (fathom_sim_a16_t *)(void *)device;
}

/* The switch output of an A16: the model's power_on and alarm. */
void fathom_sim_a16_switch_power_on(fathom_sim_device_t *device, uint32_t now_us);
void fathom_sim_a16_switch_alarm(fathom_sim_device_t *device, uint32_t now_us);

/* Registers 0x0205 and 0x0206 may have changed; it is obeyed at once. */
void fathom_sim_a16_switch_obey(fathom_sim_a16_t *a16);

/* An A05 with a relay hears nothing and sends nothing. */
void fathom_sim_a05_relay_init(fathom_sim_a05_t *a05, const fathom_sim_a05_config_t *config);

#endif
