/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/a16_modbus.h"

#include "../common.h"

/*
 * The driver that reads the distances of an A16 by Modbus. dyp_modbus.c does the work; this file has the
 * registers and the times of an A16.
 */

/* Sister models respond within 520 ms (processed) and 120 ms (real-time). The rest is margin. */
#define PROCESSED_TIMEOUT_US 1000000uL
#define REAL_TIME_TIMEOUT_US 300000uL

const fathom_model_facts_t fathom_a16_modbus_model = {
    .min_mm = 1, .max_mm = FATHOM_A16_MAX_MM, .period_ms = 120, /* A16 3(2) */
};

fathom_status_t fathom_a16_modbus_init(fathom_a16_modbus_t *sensor, const fathom_modbus_t *transport,
                                       const fathom_a16_modbus_config_t *config)
{
    fathom_dyp_modbus_t *const base = &sensor->base;
    fathom_a16_modbus_config_t zeroed;
    const fathom_status_t status = fathom_modbus_unit_begin(&base->unit, transport, sensor, sizeof *sensor);
    if (status < 0) return status;
    config = config_or_zeroed(config, &zeroed, sizeof zeroed);
    if (config->value > FATHOM_REAL_TIME) return FATHOM_ERR_ARGUMENT;
    const bool is_real_time = config->value == FATHOM_REAL_TIME;
    base->first = is_real_time ? FATHOM_A16_REGISTER_REAL_TIME : FATHOM_A16_REGISTER_PROCESSED;
    base->count = 1;
    base->measurement.values = sensor->values;
    base->start_us = config->start_us;
    base->measurement.facts = fathom_dyp_facts_or(config->model, &fathom_a16_modbus_model);
    base->measurement.model = FATHOM_A16;
    base->measurement.first = 1;
    base->probes = 1;
    return fathom_dyp_modbus_init(base, transport, &config->modbus,
                                  is_real_time ? REAL_TIME_TIMEOUT_US : PROCESSED_TIMEOUT_US,
                                  fathom_dyp_us(base->measurement.facts->period_ms));
}

void fathom_a16_modbus_deinit(fathom_a16_modbus_t *sensor) { fathom_dyp_modbus_deinit(&sensor->base); }

void fathom_a16_modbus_power_on(fathom_a16_modbus_t *sensor) { fathom_dyp_modbus_power_on(&sensor->base); }
