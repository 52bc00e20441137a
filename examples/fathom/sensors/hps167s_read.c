/* SPDX-License-Identifier: MIT */
#include "sensors/hps167s.h"

/* ---- limits ---- */

/* Returns the limits of the user; NULL: none. */
static fathom_hps167s_limits_t *limits_of(reader_t *reader, const reader_settings_t *settings)
{
    reader->limits.min_mm = settings->window.min_mm;
    reader->limits.max_mm = settings->window.max_mm;
    return settings->window.max_mm != 0 ? &reader->limits : NULL;
}

/* ---- mode modbus ---- */

bool hps167s_read_modbus(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_hps167s_t *const driver = &reader->driver.hps167s;
    fathom_hps167s_config_t config = {
        .modbus = driver_config(port, settings),
    };
    /* The pace of the driver applies to the temperature as well. */
    if (settings->temperature_us != 0) config.modbus.period_us = 0;
    fathom_hps167s_limits_t *const limits = limits_of(reader, settings);
    if (fathom_hps167s_init(driver, &port->modbus, &config) != FATHOM_OK) return false;
    if (limits != NULL && fathom_hps167s_set_limits(driver, limits) != FATHOM_OK) return false;
    reader->sensor = fathom_hps167s_sensor(driver);
    reader->unit = &driver->unit;
    reader->period_us = &driver->unit.pace_us;
    reader->sequence = &driver->sequence;
    reader->values = driver->measurement;
    reader->value_count = FATHOM_HPS167S_MEASUREMENT_COUNT;
    if (settings->temperature_us != 0) hps167s_add_temperature(reader, settings);
    return true;
}

/* ---- mode auto ---- */

static void count(reader_t *reader, uint8_t counter, uint32_t more)
{
    uint16_t *const frames = &reader->unasked_frames[counter];
    *frames = (uint16_t)(more < (uint32_t)(UINT16_MAX - *frames) ? *frames + more : UINT16_MAX);
}

/* Moves a counter of the driver into a counter of a stream. */
static void take(reader_t *reader, uint8_t counter, uint16_t *from)
{
    count(reader, counter, *from);
    *from = 0;
}

/* Polls the driver and fills in the counters of a stream. */
static fathom_status_t poll_auto(void *ctx, fathom_sample_t *sample)
{
    reader_t *const reader = ctx;
    fathom_hps167s_auto_t *const driver = &reader->unasked;
    const fathom_sensor_t sensor = fathom_hps167s_auto_sensor(driver);
    const fathom_status_t status = fathom_poll(&sensor, sample);
    const bool is_frame = status == FATHOM_OK || status == FATHOM_ERR_MALFORMED;
    const bool is_late = status == FATHOM_ERR_STALE || status == FATHOM_ERR_CHECKSUM;
    const uint32_t frames = driver->missed + (is_frame ? 1u : 0u);
    count(reader, FATHOM_STREAM_FRAMES, frames);
    count(reader, FATHOM_STREAM_BYTES, FATHOM_HPS167S_FRAME_LENGTH * frames + driver->dropped_bytes);
    count(reader, FATHOM_STREAM_STALES, is_late ? 1u : 0u);
    take(reader, FATHOM_STREAM_MISSED, &driver->missed);
    take(reader, FATHOM_STREAM_DROPPED_BYTES, &driver->dropped_bytes);
    take(reader, FATHOM_STREAM_DAMAGED, &driver->damaged);
    return status;
}

static uint32_t due_us_auto(void *ctx)
{
    reader_t *const reader = ctx;
    const fathom_sensor_t sensor = fathom_hps167s_auto_sensor(&reader->unasked);
    return fathom_due_us(&sensor, 1);
}

bool hps167s_read_auto(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_hps167s_auto_t *const driver = &reader->unasked;
    const fathom_hps167s_auto_config_t config = {
        .stale_us = settings->timeout_us,
        .address = settings->address,
    };
    fathom_hps167s_limits_t *const limits = limits_of(reader, settings);
    if (fathom_hps167s_auto_init(driver, &port->line, &config) != FATHOM_OK) return false;
    if (limits != NULL && fathom_hps167s_auto_set_limits(driver, limits) != FATHOM_OK) return false;
    reader->sensor = (fathom_sensor_t){poll_auto, due_us_auto, reader};
    reader->frames = reader->unasked_frames;
    reader->sequence = &driver->sequence;
    reader->values = driver->registers;
    reader->value_count = FATHOM_HPS167S_MEASUREMENT_COUNT;
    return true;
}
