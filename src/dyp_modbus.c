/* SPDX-License-Identifier: MIT */
#include "fathom/dyp_modbus.h"

enum { ZERO_ADDRESS = 256 }; /* fathom_modbus_setting_t */

uint8_t fathom_dyp_modbus_place(uint8_t address, bool address_zero)
{
    if (address_zero) return address == 0 ? 0 : FATHOM_MODBUS_ANY_UNIT;
    return address != 0 ? address : 1;
}

fathom_status_t fathom_dyp_modbus_init(fathom_dyp_modbus_t *sensor, const fathom_modbus_t *modbus,
                                       const fathom_clock_t *clock, uint8_t address, uint16_t default_max_mm)
{
    const fathom_status_t status = fathom_dyp_answer_init(&sensor->answer, default_max_mm);
    sensor->question.values = sensor->answer.values;
    if (sensor->command_timeout_us == 0) sensor->command_timeout_us = FATHOM_DYP_DEFAULT_COMMAND_TIMEOUT_US;
    if (sensor->start_us == 0) sensor->start_us = FATHOM_DYP_DEFAULT_START_US;
    sensor->question.is_command = false;
    sensor->question.function = 0;
    return status < 0 ? status : fathom_modbus_unit_init(&sensor->unit, modbus, clock, address);
}

void fathom_dyp_modbus_deinit(fathom_dyp_modbus_t *sensor) { fathom_modbus_unit_cancel(&sensor->unit); }

void fathom_dyp_modbus_power_on(fathom_dyp_modbus_t *sensor)
{
    sensor->answer.left = 0;
    fathom_modbus_unit_power_on(&sensor->unit, sensor->start_us);
}

/* ---- commands ---- */

static void describe(const fathom_dyp_modbus_t *sensor, uint16_t address, uint16_t *value,
                     fathom_modbus_question_t *question)
{
    *question = sensor->question; /* pace, back-off and line settings are the same */
    question->timeout_us = sensor->command_timeout_us;
    question->values = value;
    question->first = address;
    question->count = 1;
    question->is_command = true;
}

fathom_status_t fathom_dyp_modbus_get(fathom_dyp_modbus_t *sensor, uint16_t address, uint16_t *value)
{
    fathom_modbus_question_t question;
    describe(sensor, address, &sensor->setting, &question);
    const fathom_status_t status = fathom_modbus_unit_ask(&sensor->unit, &question);
    if (status == FATHOM_READY) *value = sensor->setting;
    return status;
}

fathom_status_t fathom_dyp_modbus_address(fathom_dyp_modbus_t *sensor, uint8_t *address)
{
    uint16_t value = 0;
    const fathom_status_t status = fathom_dyp_modbus_get(sensor, FATHOM_DYP_REGISTER_ADDRESS, &value);
    if (status != FATHOM_READY) return status;
    if (value > UINT8_MAX) return FATHOM_ERR_MALFORMED;
    *address = (uint8_t)value;
    return status;
}

/* What a setting reads: which register of which sensor. */
typedef struct {
    fathom_dyp_modbus_t *sensor;
    uint16_t address;
} place_t;

static fathom_status_t read(void *driver, uint32_t *value)
{
    const place_t *const place = driver;
    uint16_t found = 0;
    const fathom_status_t status = fathom_dyp_modbus_get(place->sensor, place->address, &found);
    *value = found;
    return status;
}

static fathom_status_t set(fathom_dyp_modbus_t *sensor, uint16_t address, uint16_t value,
                           uint16_t new_address, bool is_readable)
{
    place_t place = {sensor, address};
    const fathom_modbus_unit_t *const unit = &sensor->unit;
    if (address == FATHOM_DYP_REGISTER_ADDRESS && unit->is_blind) return FATHOM_ERR_ARGUMENT;
    if (unit->address == FATHOM_MODBUS_BROADCAST && unit->setting == 0) return FATHOM_ERR_ARGUMENT;
    fathom_modbus_question_t write;
    fathom_modbus_setting_t setting;
    describe(sensor, address, &value, &write);
    write.retries = 0;
    write.function = FATHOM_MODBUS_WRITE_SINGLE_REGISTER;
    setting.read = is_readable ? read : NULL;
    setting.driver = &place;
    setting.write = &write;
    setting.value = value;
    setting.settings = NULL;
    setting.address = new_address;
    return fathom_modbus_set(&sensor->unit, &setting);
}

fathom_status_t fathom_dyp_modbus_set(fathom_dyp_modbus_t *sensor, uint16_t address, uint16_t value)
{
    return set(sensor, address, value, 0, true);
}

fathom_status_t fathom_dyp_modbus_write(fathom_dyp_modbus_t *sensor, uint16_t address, uint16_t value)
{
    if (sensor->unit.setting == 0 && !sensor->unit.is_blind) {
        sensor->unit.is_written = false; /* nor will it be before that is answered */
        uint8_t own;
        const fathom_status_t status = fathom_dyp_modbus_address(sensor, &own);
        if (status != FATHOM_READY) return status;
    }
    return set(sensor, address, value, 0, false);
}

fathom_status_t fathom_dyp_modbus_set_address(fathom_dyp_modbus_t *sensor, uint8_t address)
{
    if (address == FATHOM_MODBUS_BROADCAST || address == FATHOM_MODBUS_ANY_UNIT) return FATHOM_ERR_ARGUMENT;
    return set(sensor, FATHOM_DYP_REGISTER_ADDRESS, address, address, true);
}

fathom_status_t fathom_dyp_modbus_set_address_to_0(fathom_dyp_modbus_t *sensor)
{
    return set(sensor, FATHOM_DYP_REGISTER_ADDRESS, 0, ZERO_ADDRESS, true);
}

/* ---- who is there ---- */

fathom_status_t fathom_dyp_modbus_find(fathom_dyp_modbus_find_t *find, const fathom_modbus_t *modbus,
                                       uint8_t *address)
{
    fathom_modbus_request_t *const request = &find->request;
    if (!find->is_asked) {
        request->exchange.timeout_us = FATHOM_DYP_DEFAULT_COMMAND_TIMEOUT_US;
        fathom_modbus_read_holding_registers(&request->message, FATHOM_MODBUS_ANY_UNIT,
                                             FATHOM_DYP_REGISTER_ADDRESS, 1, &find->value);
        const fathom_status_t status = modbus->submit(modbus->ctx, request);
        if (status != FATHOM_PENDING) return status;
        find->is_asked = true;
    }
    (void)modbus->poll(modbus->ctx); /* a broken port ends the request */
    const fathom_status_t status = (fathom_status_t)request->exchange.status;
    if (status == FATHOM_PENDING) return status;
    find->is_asked = false;
    if (status != FATHOM_READY) return status;
    const uint16_t found =
        request->message.head[0] != FATHOM_MODBUS_ANY_UNIT ? request->message.head[0] : find->value;
    if (found >= FATHOM_MODBUS_ANY_UNIT) return FATHOM_ERR_MALFORMED;
    *address = (uint8_t)found;
    return status;
}

void fathom_dyp_modbus_find_cancel(fathom_dyp_modbus_find_t *find, const fathom_modbus_t *modbus)
{
    if (find->is_asked) modbus->cancel(modbus->ctx, &find->request);
    find->is_asked = false;
}

/* ---- measuring ---- */

static fathom_status_t poll(void *ctx, fathom_sample_t *sample)
{
    fathom_dyp_modbus_t *const sensor = ctx;
    const fathom_status_t next = fathom_dyp_next(&sensor->answer, sample);
    if (next != FATHOM_PENDING) return next;
    const fathom_status_t status = fathom_modbus_unit_ask(&sensor->unit, &sensor->question);
    if (status != FATHOM_READY) return status;
    sensor->answer.unit = sensor->unit.address; /* it may have moved, and a move may have been given up */
    fathom_dyp_answer(&sensor->answer, sensor->probes, sensor->unit.heard_us);
    return fathom_dyp_next(&sensor->answer, sample);
}

static uint32_t due_us(void *ctx)
{
    const fathom_dyp_modbus_t *const sensor = ctx;
    return sensor->answer.left != 0 ? 0 : fathom_modbus_unit_due_us(&sensor->unit);
}

fathom_sensor_t fathom_dyp_modbus_sensor(fathom_dyp_modbus_t *sensor)
{
    fathom_sensor_t handle;
    handle.poll = poll;
    handle.due_us = due_us;
    handle.ctx = sensor;
    return handle;
}
