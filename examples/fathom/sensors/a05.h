/* SPDX-License-Identifier: MIT */
#ifndef A05_H
#define A05_H

#include "sensors/driver.h"

/* What the row of the A05 consists of (models.c). */

extern const setting_t a05_settings[];

bool a05_read_auto(reader_t *reader, port_t *port, const reader_settings_t *settings);
bool a05_read_modbus(reader_t *reader, port_t *port, const reader_settings_t *settings);
bool a05_read_dyp(reader_t *reader, port_t *port, const reader_settings_t *settings);
bool a05_read_relay(reader_t *reader, port_t *port, const reader_settings_t *settings);

/* Of mode auto: selects these values at the next power-on, for which it waits. Returns false, with a refusal, if the
 * port cannot. */
bool a05_select(reader_t *reader, port_t *port, uint8_t value);

void a05_simulate(device_t *device, const device_settings_t *settings, uint8_t simulated_as);

#endif
