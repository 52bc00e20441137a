/* SPDX-License-Identifier: MIT */
#ifndef A16_H
#define A16_H

#include "sensors/driver.h"

/* What the row of the A16 consists of (models.c). */

extern const setting_t a16_settings[];

bool a16_read_auto(reader_t *reader, port_t *port, const reader_settings_t *settings);
bool a16_read_modbus(reader_t *reader, port_t *port, const reader_settings_t *settings);
bool a16_read_controlled(reader_t *reader, port_t *port, const reader_settings_t *settings);
bool a16_read_pwm(reader_t *reader, port_t *port, const reader_settings_t *settings);
bool a16_read_switch(reader_t *reader, port_t *port, const reader_settings_t *settings);

void a16_simulate(device_t *device, const device_settings_t *settings, uint8_t simulated_as);

#endif
