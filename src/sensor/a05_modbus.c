/* SPDX-License-Identifier: MIT */
/*
 * The driver of an A05 by Modbus. It computes the registers, the time-out and the period from the wanted probes;
 * dyp_modbus.c does the rest.
 */
#include "fathom/sensor/a05_modbus.h"

#include "../common.h"

/* Default time-out without the time that the probes need, in microseconds. */
#define RESPONSE_TIMEOUT_US 200000uL

enum { ALL_PROBES = 0x0F };

const fathom_model_facts_t fathom_a05_modbus_model = {
    .min_mm = 1, .max_mm = FATHOM_A05_MAX_MM, .period_ms = 100, /* A05 3(3) */
};

fathom_status_t fathom_a05_modbus_init(fathom_a05_modbus_t *sensor, const fathom_modbus_t *transport,
                                       const fathom_a05_modbus_config_t *config)
{
    fathom_dyp_modbus_t *const base = &sensor->base;
    fathom_a05_modbus_config_t zeroed;
    const fathom_status_t status = fathom_modbus_unit_begin(&base->unit, transport, sensor, sizeof *sensor);
    if (status < 0) return status;
    config = config_or_zeroed(config, &zeroed, sizeof zeroed);
    const bool is_alias = config->registers == FATHOM_A05_REGISTERS_ALIAS;
    if ((config->probes > ALL_PROBES) ||
        (!is_alias && (config->registers != FATHOM_A05_REGISTERS) && (config->registers != 0u)))
        return FATHOM_ERR_ARGUMENT;
    const uint16_t registers = is_alias ? FATHOM_A05_REGISTERS_ALIAS : FATHOM_A05_REGISTERS;
    const uint8_t probes = (config->probes != 0u) ? config->probes : ALL_PROBES;

    /* One request reads all registers from that of the first wanted probe to that of the last. */
    const uint8_t first = fathom_dyp_first_probe(probes);
    uint8_t count = 0;
    for (uint8_t rest = (uint8_t)(probes >> (first - 1u)); rest != 0u; rest >>= 1) {
        count++;
    }

    base->first = (uint16_t)(registers + first - 1u);
    base->count = count;
    base->measurement.values = sensor->values;
    base->start_us = config->start_us;
    base->measurement.facts = fathom_dyp_facts_or(config->model, &fathom_a05_modbus_model);
    base->measurement.model = FATHOM_A05;
    base->measurement.first = first;
    base->probes = probes;
    const uint32_t measuring_us = fathom_dyp_us(base->measurement.facts->period_ms) * count;
    return fathom_dyp_modbus_init(base, transport, &config->modbus, RESPONSE_TIMEOUT_US + measuring_us,
                                  measuring_us);
}

void fathom_a05_modbus_deinit(fathom_a05_modbus_t *sensor) { fathom_dyp_modbus_deinit(&sensor->base); }

bool fathom_a05_modbus_is_written(const fathom_a05_modbus_t *sensor) { return sensor->base.unit.is_written; }

void fathom_a05_modbus_cancel(fathom_a05_modbus_t *sensor) { fathom_dyp_modbus_deinit(&sensor->base); }

void fathom_a05_modbus_power_on(fathom_a05_modbus_t *sensor) { fathom_dyp_modbus_power_on(&sensor->base); }

fathom_status_t fathom_a05_modbus_get_address(fathom_a05_modbus_t *sensor, uint8_t *address)
{
    return fathom_dyp_modbus_get_address(&sensor->base, address);
}

fathom_status_t fathom_a05_modbus_set_address(fathom_a05_modbus_t *sensor, uint8_t address)
{
    return fathom_dyp_modbus_set_address(&sensor->base, address);
}

fathom_status_t fathom_a05_modbus_set_address_0(fathom_a05_modbus_t *sensor)
{
    return fathom_dyp_modbus_set_address_0(&sensor->base);
}
