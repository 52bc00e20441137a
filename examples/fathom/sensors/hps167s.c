/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/hps167s_info.h"
#include "sensors/driver.h"

/* Reading and simulating the HPS-167S. */

/* The limits of the user; those that are 0 become the driver's. */
static fathom_hps167s_limits_t *limits_of(reader_t *reader, const reader_settings_t *settings)
{
    reader->limits.min_mm = settings->window.min_mm;
    reader->limits.max_mm = settings->window.max_mm;
    return &reader->limits;
}

static fathom_status_t get_temperature(reader_t *reader, int16_t *dc)
{
    fathom_hps167s_temperature_t read;
    const fathom_status_t status = fathom_hps167s_get_temperature(&reader->driver.hps167s, &read);
    if (status == FATHOM_OK) *dc = read.temperature_dc;
    return status;
}

/* ---- mode modbus ---- */

static bool read_modbus(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_hps167s_t *const driver = &reader->driver.hps167s;
    fathom_hps167s_config_t config = {.modbus = driver_config(port, settings)};
    /* The pace of the driver applies to the temperature as well. */
    if (settings->temperature_us != 0) config.modbus.period_us = 0;
    if (fathom_hps167s_init(driver, &port->modbus, &config) != FATHOM_OK ||
        fathom_hps167s_set_limits(driver, limits_of(reader, settings)) != FATHOM_OK)
        return false;
    reader->sensor = fathom_hps167s_sensor(driver);
    reader->unit = &driver->unit;
    reader->next_baud = &driver->next_baud;
    reader->period_us = &driver->unit.pace_us;
    reader->sequence = &driver->sequence;
    reader->values = driver->measurement;
    reader->value_count = FATHOM_HPS167S_MEASUREMENT_COUNT;
    if (settings->temperature_us != 0) driver_add_temperature(reader, settings, get_temperature);
    return true;
}

static void listen_unasked(reader_t *reader)
{
    (void)fathom_hps167s_auto_init(&reader->unasked, reader->line, NULL);
    fathom_hps167s_auto_follow(&reader->unasked, &reader->driver.hps167s);
}

/* ---- mode auto ---- */

static void count(reader_t *reader, uint8_t counter, uint32_t more)
{
    uint16_t *const frames = &reader->unasked_frames[counter];
    *frames = (uint16_t)(more < (uint32_t)(UINT16_MAX - *frames) ? *frames + more : UINT16_MAX);
}

/* Polls the driver and moves its counters into those of a stream. */
static fathom_status_t poll_auto(void *ctx, fathom_sample_t *sample)
{
    reader_t *const reader = ctx;
    fathom_hps167s_auto_t *const driver = &reader->unasked;
    const fathom_status_t status = fathom_hps167s_auto_poll(driver, sample);
    const bool is_frame = status == FATHOM_OK || status == FATHOM_ERR_MALFORMED;
    const bool is_late = status == FATHOM_ERR_STALE || status == FATHOM_ERR_CHECKSUM;
    const uint32_t frames = driver->missed + (is_frame ? 1u : 0u);
    count(reader, FATHOM_STREAM_FRAMES, frames);
    count(reader, FATHOM_STREAM_BYTES, FATHOM_HPS167S_FRAME_LENGTH * frames + driver->dropped_bytes);
    count(reader, FATHOM_STREAM_STALES, is_late ? 1u : 0u);
    count(reader, FATHOM_STREAM_MISSED, driver->missed);
    count(reader, FATHOM_STREAM_DROPPED_BYTES, driver->dropped_bytes);
    count(reader, FATHOM_STREAM_DAMAGED, driver->damaged);
    driver->missed = driver->dropped_bytes = driver->damaged = 0;
    return status;
}

static uint32_t due_us_auto(void *ctx)
{
    reader_t *const reader = ctx;
    return fathom_hps167s_auto_due_us(&reader->unasked);
}

static bool read_auto(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_hps167s_auto_t *const driver = &reader->unasked;
    const fathom_hps167s_auto_config_t config = {.stale_us = settings->timeout_us,
                                                 .address = settings->address};
    if (fathom_hps167s_auto_init(driver, &port->line, &config) != FATHOM_OK ||
        fathom_hps167s_auto_set_limits(driver, limits_of(reader, settings)) != FATHOM_OK)
        return false;
    reader->sensor = (fathom_sensor_t){poll_auto, due_us_auto, reader};
    reader->frames = reader->unasked_frames;
    reader->sequence = &driver->sequence;
    reader->values = driver->registers;
    reader->value_count = FATHOM_HPS167S_MEASUREMENT_COUNT;
    return true;
}

/* ---- an HPS-167 with a UART ---- */

static fathom_status_t end_uart(reader_t *reader)
{
    fathom_hps167_uart_t *const driver = &reader->driver.hps167_uart;
    const fathom_status_t status = fathom_hps167_uart_stop(driver);
    if (status != FATHOM_PENDING && status != FATHOM_ERR_BUSY) fathom_hps167_uart_deinit(driver);
    return status == FATHOM_ERR_BUSY ? FATHOM_PENDING : status;
}

/* It measures continuously, from one request on. */
static bool read_uart(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_hps167_uart_t *const driver = &reader->driver.hps167_uart;
    const fathom_hps167_uart_config_t config = {.stale_us = settings->timeout_us, .continuous = true};
    if (fathom_hps167_uart_init(driver, &port->line, &config) != FATHOM_OK ||
        fathom_hps167_uart_set_limits(driver, limits_of(reader, settings)) != FATHOM_OK)
        return false;
    reader->sensor = fathom_hps167_uart_sensor(driver);
    reader->end = end_uart;
    reader->sequence = &driver->sequence;
    reader->values = driver->registers;
    reader->value_count = FATHOM_HPS167S_MEASUREMENT_COUNT;
    return true;
}

/* ---- the modes, and their simulation ---- */

enum {
    SIMULATED_MODBUS = 1,
    SIMULATED_AUTO, /* it sends each measurement without a request */
    SIMULATED_UART
};

const model_mode_t hps167_uart_mode = {"uart",
                                       "no datasheet",
                                       .reads = FATHOM_MODE_0A,
                                       .takes = READER_TAKES_WINDOW,
                                       .simulated_as = SIMULATED_UART,
                                       .read = read_uart};

const model_mode_t hps167s_modes[MODEL_MODES] = {
    {"modbus", "HPS 3", "Modbus", .reads = FATHOM_MODE_MODBUS, .is_modbus = true, .has_address = true,
     .takes = READER_TAKES_WINDOW | READER_TAKES_TEMPERATURE, .simulated_as = SIMULATED_MODBUS,
     .read = read_modbus, .listen_unasked = listen_unasked},
    {"auto", "HPS 3 #15", .has_address = true, .takes = READER_TAKES_WINDOW, .simulated_as = SIMULATED_AUTO,
     .read = read_auto},
};

static uint8_t warm_up_says(const uint32_t *traits)
{
    if (traits[DEVICE_WARM_UP_ABNORMAL] != 0) return FATHOM_SIM_HPS167S_ABNORMAL;
    return traits[DEVICE_WARM_UP_REFUSES] != 0 ? FATHOM_SIM_HPS167S_EXCEPTION : FATHOM_SIM_HPS167S_SILENCE;
}

void hps167s_simulate(device_t *device, const device_settings_t *settings, uint8_t simulated_as)
{
    const uint32_t unasked_us = simulated_as == SIMULATED_AUTO ? FATHOM_HPS167S_MIN_PERIOD_US : 0;
    const uint32_t *const traits = settings->traits;
    const fathom_sim_hps167s_config_t config = {
        .address = settings->address,
        .baud_code = fathom_hps167s_baud_code(settings->baud),
        .warm_up_s = (uint8_t)traits[DEVICE_WARM_UP],
        .warm_up_says = warm_up_says(traits),
        .wrong_length = traits[DEVICE_COUNT_EXCEPTION] != 0 ? FATHOM_MODBUS_ILLEGAL_DATA_VALUE : 0,
        .no_termination = traits[DEVICE_NO_TERMINATION] != 0,
        .no_auto_output = traits[DEVICE_NO_OUTPUT] != 0,
        .baud_at_power_on = traits[DEVICE_BAUD_LATER] != 0,
        .offset_adds = traits[DEVICE_OFFSET_ADDS] != 0,
        .reconnect_ms = traits[DEVICE_RECONNECT],
        .no_baud_code = traits[DEVICE_NO_BAUD_CODE] != 0,
        .answers_from_new = traits[DEVICE_ANSWERS_FROM_NEW] != 0,
        .unasked_us = traits[DEVICE_UNASKED] != 0 ? traits[DEVICE_UNASKED] : unasked_us,
        .number = settings->number,
        .seed = settings->seed,
        .scene = settings->scene};
    const fathom_sim_hps167_config_t uart_config = {.seed = settings->seed, .scene = settings->scene};
    if (simulated_as == SIMULATED_UART)
        fathom_sim_hps167_init(&device->hps167, &uart_config);
    else
        fathom_sim_hps167s_init(&device->hps167s, &config);
}
