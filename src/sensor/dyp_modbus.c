/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/internal/dyp_modbus.h"

#include "../common.h"

enum { ZERO_ADDRESS = 256 }; /* fathom_modbus_setting_t */
enum { WRITES = 64 };        /* Added to the id of a register: the id of its write. */

/* ---- Initialisation ---- */

fathom_status_t fathom_dyp_modbus_init(fathom_dyp_modbus_t *sensor, const fathom_modbus_t *transport,
                                       const fathom_modbus_config_t *config, uint32_t timeout_us,
                                       uint32_t pace_us)
{
    enum { OVERHEAD = 5 }; /* of a response: address, function, byte count and CRC */
    sensor->start_us = or_default(sensor->start_us, FATHOM_DYP_DEFAULT_START_US);
    if (fathom_dyp_are_valid(sensor->measurement.facts) && (sensor->start_us <= FATHOM_MAX_DURATION_US) &&
        fathom_modbus_unit_has_room(transport, (uint8_t)(OVERHEAD + (2u * sensor->count))) &&
        (fathom_modbus_unit_init(&sensor->unit, transport, config, timeout_us, pace_us) == FATHOM_OK))
        return FATHOM_OK;
    clear(sensor, sizeof *sensor);
    return FATHOM_ERR_ARGUMENT;
}

void fathom_dyp_modbus_deinit(fathom_dyp_modbus_t *sensor) { fathom_modbus_unit_cancel(&sensor->unit); }

void fathom_dyp_modbus_power_on(fathom_dyp_modbus_t *sensor)
{
    sensor->measurement.left = 0;
    fathom_modbus_unit_power_on(&sensor->unit, sensor->start_us);
}

/* ---- commands ---- */

/* By what registers differ: they are 0010.., 0100.. and 0200... */
static uint8_t id_of(uint16_t address)
{
    return (uint8_t)(FATHOM_MODBUS_COMMAND | ((address >> 4) & 0x30u) | (address & 0x0Fu));
}

static uint8_t write_id(uint16_t address) { return (uint8_t)(id_of(address) + WRITES); }

fathom_status_t fathom_dyp_modbus_look(fathom_dyp_modbus_t *sensor, uint16_t address, uint16_t *value)
{
    fathom_modbus_unit_request_t request;
    request.values = &sensor->found;
    request.first = address;
    request.last = 1;
    request.function = FATHOM_MODBUS_READ_HOLDING_REGISTERS;
    request.id = id_of(address);
    const fathom_status_t status = fathom_modbus_command(&sensor->unit, &request);
    if (status == FATHOM_OK) *value = sensor->found;
    return status;
}

fathom_status_t fathom_dyp_modbus_get_register(fathom_dyp_modbus_t *sensor, uint16_t address, uint16_t *value)
{
    fathom_modbus_unit_poll(&sensor->unit);
    return fathom_dyp_modbus_look(sensor, address, value);
}

fathom_status_t fathom_dyp_modbus_get_address(fathom_dyp_modbus_t *sensor, uint8_t *address)
{
    uint16_t value = 0;
    const fathom_status_t status =
        fathom_dyp_modbus_get_register(sensor, FATHOM_DYP_REGISTER_ADDRESS, &value);
    if (status != FATHOM_OK) return status;
    if (value > UINT8_MAX) return FATHOM_ERR_MALFORMED;
    *address = (uint8_t)value;
    return status;
}

static fathom_status_t read(const fathom_modbus_setting_t *setting, uint32_t *value)
{
    fathom_dyp_modbus_t *const sensor = setting->driver;
    const fathom_status_t status = fathom_dyp_modbus_look(sensor, setting->write.first, &sensor->found);
    *value = sensor->found;
    return status;
}

void fathom_dyp_modbus_describe(fathom_dyp_modbus_t *sensor, fathom_modbus_setting_t *setting,
                                uint16_t address, uint16_t value)
{
    setting->driver = sensor;
    setting->write.values = NULL;
    setting->write.first = address;
    setting->write.last = value;
    setting->write.function = FATHOM_MODBUS_WRITE_SINGLE_REGISTER;
    setting->write.id = write_id(address);
    setting->value = value;
    setting->line_settings = NULL;
    setting->address = 0;
}

typedef fathom_status_t (*read_t)(const fathom_modbus_setting_t *setting, uint32_t *value);

static fathom_status_t set(fathom_dyp_modbus_t *sensor, uint16_t address, uint16_t value, read_t its_read)
{
    fathom_modbus_unit_t *const unit = &sensor->unit;
    const bool is_address = address == FATHOM_DYP_REGISTER_ADDRESS;
    fathom_modbus_setting_t setting;
    if (is_address && fathom_modbus_is_next_unchecked(unit)) return fathom_modbus_refuse_argument(unit);
    if ((unit->address == FATHOM_MODBUS_BROADCAST) && (unit->setting == 0u))
        return fathom_modbus_refuse_argument(unit);
    fathom_dyp_modbus_describe(sensor, &setting, address, value);
    setting.read = its_read;
    if (is_address) setting.address = (value != 0u) ? value : ZERO_ADDRESS;
    return fathom_modbus_set(unit, &setting);
}

fathom_status_t fathom_dyp_modbus_set_register(fathom_dyp_modbus_t *sensor, uint16_t address, uint16_t value)
{
    fathom_modbus_unit_poll(&sensor->unit);
    return set(sensor, address, value, read);
}

fathom_status_t fathom_dyp_modbus_write_register(fathom_dyp_modbus_t *sensor, uint16_t address,
                                                 uint16_t value)
{
    const fathom_modbus_unit_t *const unit = &sensor->unit;
    fathom_modbus_unit_poll(&sensor->unit);
    if ((unit->setting != 0u) && (unit->setting != write_id(address)) &&
        !fathom_modbus_command_give_way(&sensor->unit))
        return FATHOM_ERR_BUSY;
    if ((unit->setting == 0u) && !unit->is_blind) {
        sensor->unit.is_written = false; /* nor will it be before this read has ended */
        const fathom_status_t status =
            fathom_dyp_modbus_look(sensor, FATHOM_DYP_REGISTER_ADDRESS, &sensor->found);
        if (status != FATHOM_OK) return status;
    }
    return set(sensor, address, value, NULL);
}

fathom_status_t fathom_dyp_modbus_set_address(fathom_dyp_modbus_t *sensor, uint8_t address)
{
    if ((address == FATHOM_MODBUS_BROADCAST) || (address == FATHOM_MODBUS_ANY_UNIT))
        return fathom_modbus_refuse_argument(&sensor->unit);
    return fathom_dyp_modbus_set_register(sensor, FATHOM_DYP_REGISTER_ADDRESS, address);
}

fathom_status_t fathom_dyp_modbus_set_address_0(fathom_dyp_modbus_t *sensor)
{
    return fathom_dyp_modbus_set_register(sensor, FATHOM_DYP_REGISTER_ADDRESS, 0);
}

/* ---- the address of the one device on a line ---- */

fathom_status_t fathom_dyp_modbus_find(fathom_dyp_modbus_find_t *find, const fathom_modbus_t *transport,
                                       uint8_t *address)
{
    fathom_modbus_request_t *const request = &find->request;
    if (!find->is_asked) {
        request->transaction.timeout_us = FATHOM_MODBUS_DEFAULT_COMMAND_TIMEOUT_US;
        fathom_modbus_read_holding_registers(&request->message, FATHOM_MODBUS_ANY_UNIT,
                                             FATHOM_DYP_REGISTER_ADDRESS, 1, &find->value);
        const fathom_status_t status = transport->submit(transport->line, request);
        if (status != FATHOM_PENDING) return status;
        find->is_asked = true;
    }
    (void)fathom_line_poll(transport->line); /* A broken port ends the request. */
    fathom_status_t status = (fathom_status_t)request->transaction.status;
    if (status == FATHOM_PENDING) {
        if (fathom_line_is_queued(transport->line, &request->transaction)) return status;
        status = FATHOM_ERR_CANCELLED; /* The line was initialised again. */
    }
    find->is_asked = false;
    if (status != FATHOM_OK) return status;
    const uint16_t found =
        (request->message.head[0] != FATHOM_MODBUS_ANY_UNIT) ? request->message.head[0] : find->value;
    if (found >= FATHOM_MODBUS_ANY_UNIT) return FATHOM_ERR_MALFORMED;
    *address = (uint8_t)found;
    return status;
}

void fathom_dyp_modbus_find_cancel(fathom_dyp_modbus_find_t *find, const fathom_modbus_t *transport)
{
    if (find->is_asked) fathom_line_cancel(transport->line, &find->request.transaction);
    find->is_asked = false;
}

/* ---- measuring ---- */

fathom_status_t fathom_dyp_modbus_sensor_poll(void *ctx, fathom_sample_t *sample)
{
    fathom_dyp_modbus_t *const sensor = ctx;
    fathom_dyp_measurement_t *const measurement = &sensor->measurement;
    fathom_modbus_unit_t *const unit = &sensor->unit;
    if (measurement->left == 0u) {
        fathom_modbus_unit_poll(unit);
        const fathom_status_t status =
            fathom_modbus_unit_measure(unit, sensor->first, sensor->count, measurement->values);
        if (status != FATHOM_OK) return status;
        measurement->address = unit->address; /* it may have moved, and a move may have been given up */
        fathom_dyp_measurement_set(measurement, sensor->probes, fathom_modbus_unit_heard_us(unit));
    }
    return fathom_dyp_measurement_next(measurement, sample);
}

uint32_t fathom_dyp_modbus_sensor_due_us(void *ctx)
{
    const fathom_dyp_modbus_t *const sensor = ctx;
    return (sensor->measurement.left != 0u) ? 0u : fathom_modbus_unit_due_us(&sensor->unit);
}
