/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/hps167s_info.h"
#include "sensors/hps167s.h"

/* Reads the temperature (#4) between measurements (#5). The pace of the driver applies to all requests, so this file keeps
 * the interval of the measurements. Another request would replace the result of a measurement that was not polled, so the
 * temperature is read only while no measurement is in progress. */

enum { RESTING, MEASURING, READING_IT };

/* An older temperature is not reported. */
enum { PERIODS_SHOWN = 3 };

static uint32_t left_us(bool has_begun, uint32_t began_us, uint32_t period_us, uint32_t now)
{
    const uint32_t passed_us = fathom_elapsed_us(now, began_us);
    return has_begun && passed_us < period_us ? period_us - passed_us : 0;
}

static uint32_t until_asked_us(const driver_temperature_t *temperature, uint32_t now)
{
    return left_us(temperature->was_asked, temperature->asked_us, temperature->period_us, now);
}

static uint32_t until_measured_us(const driver_temperature_t *temperature, uint32_t now)
{
    return left_us(temperature->has_measured, temperature->measured_us, temperature->interval_us, now);
}

static void take(reader_t *reader, fathom_status_t status, const fathom_hps167s_temperature_t *read)
{
    driver_temperature_t *const temperature = &reader->temperature;
    if (status == FATHOM_OK) {
        temperature->dc = read->temperature_dc;
        temperature->read_us = driver_now_us(reader);
        temperature->is_known = true;
    } else if (status != FATHOM_ERR_PORT && !temperature->is_reported) {
        temperature->is_reported = true;
        reader->remark =
            "its temperature (#4) could not be read; it is measured all the same, and asked for its "
            "temperature again";
    }
}

/* Returns false while the read is in progress. */
static bool ask(reader_t *reader)
{
    fathom_hps167s_temperature_t read;
    const fathom_status_t status = fathom_hps167s_get_temperature(&reader->driver.hps167s, &read);
    if (status == FATHOM_PENDING) return false;
    take(reader, status, &read);
    reader->temperature.state = RESTING;
    return true;
}

static void begin_next(driver_temperature_t *temperature, uint32_t now)
{
    const bool is_due = until_measured_us(temperature, now) == 0;
    /* Alternately: a sensor that does not respond to #4 is measured all the same. */
    const bool has_turn = !temperature->was_last || !is_due;
    if (has_turn && until_asked_us(temperature, now) == 0) {
        temperature->state = READING_IT;
        temperature->asked_us = now;
        temperature->was_asked = true;
        temperature->was_last = true;
    } else if (is_due) {
        temperature->state = MEASURING;
        temperature->measured_us = now;
        temperature->has_measured = true;
        temperature->was_last = false;
    }
}

static fathom_status_t poll(void *ctx, fathom_sample_t *sample)
{
    reader_t *const reader = ctx;
    driver_temperature_t *const temperature = &reader->temperature;
    const uint32_t now = driver_now_us(reader);
    if (temperature->is_known &&
        fathom_elapsed_us(now, temperature->read_us) > PERIODS_SHOWN * temperature->period_us)
        temperature->is_known = false;
    if (temperature->state == READING_IT && !ask(reader)) return FATHOM_PENDING;
    if (temperature->state == RESTING) begin_next(temperature, now);
    if (temperature->state == READING_IT && !ask(reader)) return FATHOM_PENDING;
    if (temperature->state != MEASURING) {
        fathom_modbus_unit_poll(reader->unit);
        return FATHOM_PENDING;
    }
    const fathom_status_t status = fathom_poll(&temperature->measuring, sample);
    if (status != FATHOM_PENDING) temperature->state = RESTING;
    return status;
}

static uint32_t due_us(void *ctx)
{
    const reader_t *const reader = ctx;
    const driver_temperature_t *const temperature = &reader->temperature;
    if (temperature->state != RESTING) return fathom_due_us(&temperature->measuring, 1);
    const uint32_t now = driver_now_us(reader);
    const uint32_t ask_us = until_asked_us(temperature, now);
    const uint32_t measure_us = until_measured_us(temperature, now);
    return ask_us < measure_us ? ask_us : measure_us;
}

void hps167s_add_temperature(reader_t *reader, const reader_settings_t *settings)
{
    driver_temperature_t *const temperature = &reader->temperature;
    temperature->measuring = reader->sensor;
    temperature->period_us = settings->temperature_us;
    temperature->interval_us = settings->period_us;
    reader->sensor = (fathom_sensor_t){poll, due_us, reader};
}
