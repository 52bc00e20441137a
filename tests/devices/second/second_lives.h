/* SPDX-License-Identifier: MIT */
/* What a driver is made to do with one device, from its power-on to its power-off; second_judge.h judges it. */
#ifndef SECOND_LIVES_H
#define SECOND_LIVES_H

#include "second_judge.h"

typedef void (*life_t)(rig_t *rig);

/* The one device on a line is asked for its address at FF. */
void find_by_modbus(rig_t *rig, const fathom_sensor_t *any);

void life_a16_auto(rig_t *rig);
void life_a16_controlled(rig_t *rig);
void life_a16_rs232(rig_t *rig);
void life_a16_rs485(rig_t *rig);
void life_a16_pwm(rig_t *rig);
void life_a16_switch(rig_t *rig);
void life_a05_relay(rig_t *rig);
void life_a05_uart(rig_t *rig);
void life_a05_rs485(rig_t *rig);
void life_a05_dyp(rig_t *rig);
void life_hps167s(rig_t *rig);
void life_hps167s_auto(rig_t *rig);
void life_hps167(rig_t *rig);
void life_hps167_continuous(rig_t *rig);

#endif
