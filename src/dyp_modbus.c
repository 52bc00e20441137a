/* SPDX-License-Identifier: MIT */
#include "fathom/dyp_modbus.h"

fathom_status_t fathom_dyp_modbus_init(fathom_dyp_modbus_t *sensor, const fathom_modbus_t *modbus,
                                       const fathom_clock_t *clock, uint8_t address, uint16_t default_max_mm)
{
    const fathom_status_t status = fathom_dyp_answer_init(&sensor->answer, default_max_mm);
    sensor->question.values = sensor->answer.values;
    sensor->question.is_command = false;
    sensor->question.function = 0;
    sensor->answer.unit = address;
    return status < 0 ? status : fathom_modbus_unit_init(&sensor->unit, modbus, clock, address);
}

void fathom_dyp_modbus_deinit(fathom_dyp_modbus_t *sensor) { fathom_modbus_unit_cancel(&sensor->unit); }

static fathom_status_t poll(void *ctx, fathom_sample_t *sample)
{
    fathom_dyp_modbus_t *const sensor = ctx;
    const fathom_status_t next = fathom_dyp_next(&sensor->answer, sample);
    if (next != FATHOM_PENDING) return next;
    const fathom_status_t status = fathom_modbus_unit_ask(&sensor->unit, &sensor->question);
    if (status != FATHOM_READY) return status;
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
