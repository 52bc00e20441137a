/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/a16_settings.h"

/*
 * The commands and settings of an A16 by Modbus. Each function names its register and checks its range;
 * dyp_modbus.c sends the requests.
 */

void fathom_a16_modbus_cancel(fathom_a16_modbus_t *sensor) { fathom_dyp_modbus_deinit(&sensor->base); }

bool fathom_a16_modbus_is_written(const fathom_a16_modbus_t *sensor) { return sensor->base.unit.is_written; }

fathom_status_t fathom_a16_modbus_write_next_unchecked(fathom_a16_modbus_t *sensor)
{
    return fathom_modbus_write_next_unchecked(&sensor->base.unit);
}

fathom_status_t fathom_a16_modbus_measure(fathom_a16_modbus_t *sensor, fathom_dyp_value_t value,
                                          fathom_sample_t *sample)
{
    if ((unsigned)value > FATHOM_REAL_TIME) return FATHOM_ERR_ARGUMENT;
    const uint16_t address =
        (value == FATHOM_REAL_TIME) ? FATHOM_A16_REGISTER_REAL_TIME : FATHOM_A16_REGISTER_PROCESSED;
    const fathom_status_t status = fathom_dyp_modbus_get_register(&sensor->base, address, sensor->values);
    if (status != FATHOM_OK) return status;
    sensor->base.measurement.address = sensor->base.unit.address;
    fathom_dyp_measurement_set(&sensor->base.measurement, 1, fathom_modbus_unit_heard_us(&sensor->base.unit));
    return fathom_dyp_measurement_next(&sensor->base.measurement, sample);
}

fathom_status_t fathom_a16_modbus_get_temperature(fathom_a16_modbus_t *sensor, int16_t *temperature_dc)
{
    const fathom_model_facts_t *const facts = sensor->base.measurement.facts;
    uint16_t value = 0;
    if (facts == NULL) return FATHOM_ERR_ARGUMENT; /* init did not run, or failed */
    if ((facts->registers & FATHOM_HAS_TEMPERATURE) == 0u) return FATHOM_ERR_UNSUPPORTED;
    const fathom_status_t status =
        fathom_dyp_modbus_get_register(&sensor->base, FATHOM_A16_REGISTER_TEMPERATURE, &value);
    if (status != FATHOM_OK) return status;
    const int32_t dc = value; /* a two's complement of 16 bits */
    *temperature_dc = (int16_t)((dc <= INT16_MAX) ? dc : (dc - 65536));
    return status;
}

fathom_status_t fathom_a16_modbus_get_address(fathom_a16_modbus_t *sensor, uint8_t *address)
{
    return fathom_dyp_modbus_get_address(&sensor->base, address);
}

fathom_status_t fathom_a16_modbus_set_address(fathom_a16_modbus_t *sensor, uint8_t address)
{
    return fathom_dyp_modbus_set_address(&sensor->base, address);
}

fathom_status_t fathom_a16_modbus_set_address_0(fathom_a16_modbus_t *sensor)
{
    return fathom_dyp_modbus_set_address_0(&sensor->base);
}

fathom_status_t fathom_a16_modbus_set_operating_mode(fathom_a16_modbus_t *sensor,
                                                     fathom_a16_operating_mode_t mode)
{
    if ((unsigned)mode > FATHOM_A16_AUTOMATIC) return fathom_modbus_refuse_argument(&sensor->base.unit);
    return fathom_dyp_modbus_write_register(&sensor->base, FATHOM_A16_REGISTER_OPERATING_MODE,
                                            (uint16_t)mode);
}

/* Reads a register whose value is 0 or 1. */
static fathom_status_t get_choice(fathom_a16_modbus_t *sensor, uint16_t address, uint16_t *value)
{
    uint16_t found = 0;
    const fathom_status_t status = fathom_dyp_modbus_get_register(&sensor->base, address, &found);
    if (status != FATHOM_OK) return status;
    if (found > 1u) return FATHOM_ERR_MALFORMED;
    *value = found;
    return status;
}

static fathom_status_t set_choice(fathom_a16_modbus_t *sensor, uint16_t address, unsigned value)
{
    if (value > 1u) return fathom_modbus_refuse_argument(&sensor->base.unit);
    return fathom_dyp_modbus_set_register(&sensor->base, address, (uint16_t)value);
}

fathom_status_t fathom_a16_modbus_get_switch_polarity(fathom_a16_modbus_t *sensor,
                                                      fathom_a16_polarity_t *polarity)
{
    uint16_t value = 0;
    const fathom_status_t status = get_choice(sensor, FATHOM_A16_REGISTER_SWITCH_POLARITY, &value);
    if (status == FATHOM_OK) *polarity = (fathom_a16_polarity_t)value;
    return status;
}

fathom_status_t fathom_a16_modbus_set_switch_polarity(fathom_a16_modbus_t *sensor,
                                                      fathom_a16_polarity_t polarity)
{
    return set_choice(sensor, FATHOM_A16_REGISTER_SWITCH_POLARITY, (unsigned)polarity);
}

fathom_status_t fathom_a16_modbus_get_switch_threshold_mm(fathom_a16_modbus_t *sensor, uint16_t *threshold_mm)
{
    return fathom_dyp_modbus_get_register(&sensor->base, FATHOM_A16_REGISTER_SWITCH_THRESHOLD, threshold_mm);
}

fathom_status_t fathom_a16_modbus_set_switch_threshold_mm(fathom_a16_modbus_t *sensor, uint16_t threshold_mm)
{
    if ((threshold_mm == 0u) || (threshold_mm > FATHOM_A16_MAX_MM))
        return fathom_modbus_refuse_argument(&sensor->base.unit);
    return fathom_dyp_modbus_set_register(&sensor->base, FATHOM_A16_REGISTER_SWITCH_THRESHOLD, threshold_mm);
}

fathom_status_t fathom_a16_modbus_get_automatic_value(fathom_a16_modbus_t *sensor, fathom_dyp_value_t *value)
{
    uint16_t found = 0;
    const fathom_status_t status = get_choice(sensor, FATHOM_A16_REGISTER_AUTOMATIC_VALUE, &found);
    if (status == FATHOM_OK) *value = (fathom_dyp_value_t)found;
    return status;
}

fathom_status_t fathom_a16_modbus_set_automatic_value(fathom_a16_modbus_t *sensor, fathom_dyp_value_t value)
{
    return set_choice(sensor, FATHOM_A16_REGISTER_AUTOMATIC_VALUE, (unsigned)value);
}
