/* SPDX-License-Identifier: MIT */
#ifndef DRIVER_H
#define DRIVER_H

#include "assumptions.h"
#include "fathom/engine/internal/modbus_unit.h"
#include "fathom/engine/sensor.h"
#include "fathom/sensor/internal/dyp.h"

/* What the configs of the drivers have in common, with any value. a16_modbus.c has the transports that are refused. */

static const fathom_line_settings_t assumed_settings = {19200, FATHOM_PARITY_EVEN, 1};

static void any_modbus_config(fathom_modbus_config_t *config)
{
    config->line_settings = any_bool() ? &assumed_settings : NULL;
    config->period_us = any_32();
    config->timeout_us = any_32();
    config->command_timeout_us = any_32();
    config->backoff_us = any_32();
    config->address = any_8();
    config->address_zero = any_bool();
    config->retries = any_8();
}

static void any_window(fathom_dyp_window_t *window)
{
    window->min_mm = any_16();
    window->max_mm = any_16();
    window->value_fffd = any_8();
    window->value_fffe = any_8();
    window->value_ffff = any_8();
    window->value_0 = any_8();
}

/* Which probes an A05 has, as a mask; from 16 on they are refused. Those that begin at the same one stand together:
 * which is 0..5. */
static uint8_t any_probes(uint8_t which)
{
    switch (which) {
    case 0:
        return (uint8_t)(2 * any_8_in(0, 7) + 1);
    case 1:
        return (uint8_t)(4 * any_8_in(0, 3) + 2);
    case 2:
        return (uint8_t)(8 * any_8_in(0, 1) + 4);
    case 3:
        return 8;
    case 4:
        return 0;
    default:
        return any_8_in(16, UINT8_MAX);
    }
}

/* The two calls of a program's loop. */
static void any_poll(const fathom_sensor_t *sensor)
{
    fathom_sample_t sample;
    (void)fathom_poll(sensor, &sample);
    (void)fathom_due_us(sensor, 1);
}

#endif
