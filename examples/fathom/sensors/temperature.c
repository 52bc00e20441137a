/* SPDX-License-Identifier: MIT */
#include "sensors/driver.h"

/*
 * Reads the temperature between measurements. The pace of the driver applies to all requests, so this file keeps the
 * interval of the measurements. Another request would replace the result of a measurement that was not polled, so the
 * temperature is read only while no measurement is in progress.
 */

/* An older temperature is not reported. */
enum { PERIODS_SHOWN = 3 };

static uint32_t left_us(const driver_temperature_t *temperature, driver_turn_t turn, uint32_t now)
{
    const uint32_t period_us = temperature->period_us[turn];
    const uint32_t passed_us = fathom_elapsed_us(now, temperature->began_us[turn]);
    return temperature->has_begun[turn] && passed_us < period_us ? period_us - passed_us : 0;
}

/* Alternately if both are due: a sensor whose temperature fails is measured all the same. Returns false if none is. */
static bool begin_turn(driver_temperature_t *temperature, uint32_t now)
{
    driver_turn_t turn = temperature->last == TURN_TEMPERATURE ? TURN_MEASUREMENT : TURN_TEMPERATURE;
    if (left_us(temperature, turn, now) != 0) turn = temperature->last;
    if (left_us(temperature, turn, now) != 0) return false;
    temperature->turn = temperature->last = (uint8_t)turn;
    temperature->began_us[turn] = now;
    temperature->has_begun[turn] = true;
    return true;
}

static void read_temperature(reader_t *reader, uint32_t now)
{
    driver_temperature_t *const temperature = &reader->temperature;
    const fathom_status_t status = temperature->get(reader, &temperature->dc);
    if (status == FATHOM_PENDING) return;
    temperature->turn = TURN_NONE;
    if (status == FATHOM_OK) {
        temperature->read_us = now;
        temperature->is_known = true;
    } else if (status != FATHOM_ERR_PORT && !temperature->is_reported) {
        temperature->is_reported = true;
        reader->remark = "its temperature could not be read; it is measured all the same, and asked for its "
                         "temperature again";
    }
}

static fathom_status_t poll_turns(void *ctx, fathom_sample_t *sample)
{
    reader_t *const reader = ctx;
    driver_temperature_t *const temperature = &reader->temperature;
    const uint32_t now = driver_now_us(reader);
    if (fathom_elapsed_us(now, temperature->read_us) >
        PERIODS_SHOWN * temperature->period_us[TURN_TEMPERATURE])
        temperature->is_known = false;
    if (temperature->turn == TURN_NONE && !begin_turn(temperature, now))
        fathom_modbus_unit_poll(reader->unit);
    if (temperature->turn == TURN_TEMPERATURE) read_temperature(reader, now);
    if (temperature->turn != TURN_MEASUREMENT) return FATHOM_PENDING;
    const fathom_status_t status = fathom_poll(&temperature->measuring, sample);
    if (status != FATHOM_PENDING) temperature->turn = TURN_NONE;
    return status;
}

static uint32_t due_us_turns(void *ctx)
{
    const reader_t *const reader = ctx;
    const driver_temperature_t *const temperature = &reader->temperature;
    if (temperature->turn != TURN_NONE) return fathom_due_us(&temperature->measuring, 1);
    const uint32_t now = driver_now_us(reader);
    const uint32_t read_us = left_us(temperature, TURN_TEMPERATURE, now);
    const uint32_t measure_us = left_us(temperature, TURN_MEASUREMENT, now);
    return read_us < measure_us ? read_us : measure_us;
}

void driver_add_temperature(reader_t *reader, const reader_settings_t *settings,
                            driver_get_temperature_t *get)
{
    reader->temperature.get = get;
    reader->temperature.measuring = reader->sensor;
    reader->temperature.period_us[TURN_TEMPERATURE] = settings->temperature_us;
    reader->temperature.period_us[TURN_MEASUREMENT] = settings->period_us;
    reader->temperature.turn = TURN_NONE;
    reader->sensor = (fathom_sensor_t){poll_turns, due_us_turns, reader};
}
