/* SPDX-License-Identifier: MIT */
#include "sensors/a16.h"

#include "sensors/dyp.h"

/* ---- reading ---- */

/* RX becomes high again. */
static fathom_status_t end_auto(reader_t *reader) { return fathom_a16_auto_deinit(&reader->driver.a16_auto); }

static fathom_status_t end_controlled(reader_t *reader)
{
    return fathom_a16_controlled_deinit(&reader->driver.a16_controlled);
}

/* The level of the port's TX at the module's RX selects the value (A16 2(2)). */
bool a16_read_auto(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_a16_auto_t *const driver = &reader->driver.a16_auto;
    fathom_a16_auto_config_t config = {
        .stale_us = settings->timeout_us,
        .gap_us = PORT_STREAM_GAP_US,
        .window = settings->window,
        .value = settings->value,
    };
    if (settings->has_value) {
        driver_end_break(port);
        config.select = fathom_output_line_break(&port->line);
    }
    if (settings->value == FATHOM_REAL_TIME && !driver_has_break(reader, port)) return false;
    if (fathom_a16_auto_init(driver, &port->line, &config) != FATHOM_OK) return false;
    reader->end = end_auto;
    return dyp_open_stream(reader, &driver->base, fathom_a16_auto_sensor(driver));
}

/* The trigger is a GPIO line, or a break of the port, whose TX is the module's RX. */
bool a16_read_controlled(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_a16_controlled_t *const driver = &reader->driver.a16_controlled;
    const fathom_output_t trigger = port->settings.pins.chip != 0 ? fathom_output_pin(&port->pins.trigger)
                                                                  : fathom_output_line_break(&port->line);
    const fathom_a16_controlled_config_t config = {
        .period_us = settings->period_us,
        .gap_us = PORT_STREAM_GAP_US,
        .window = settings->window,
    };
    if (fathom_a16_controlled_init(driver, &port->line, &trigger, &config) != FATHOM_OK) return false;
    reader->sensor = fathom_a16_controlled_sensor(driver);
    reader->end = end_controlled;
    reader->frames = driver->stream.counters;
    reader->values = driver->values;
    reader->value_count = 1;
    reader->response = &driver->measurement;
    reader->window = &driver->measurement.window;
    reader->sequence = &driver->measurement.sequence;
    reader->period_us = &driver->trigger.period_us;
    return true;
}

bool a16_read_modbus(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_a16_modbus_t *const driver = &reader->driver.a16_modbus;
    const fathom_a16_modbus_config_t config = {
        .modbus = driver_config(port, settings),
        .window = settings->window,
        .value = settings->value,
    };
    return fathom_a16_modbus_init(driver, &port->modbus, &config) == FATHOM_OK &&
           dyp_open_asked(reader, &driver->base, fathom_a16_modbus_sensor(driver));
}

/* ---- simulation ---- */

void a16_simulate(device_t *device, const device_settings_t *settings, uint8_t simulated_as)
{
    const uint32_t *const traits = settings->traits;
    const fathom_sim_a16_config_t config = {.address = settings->address,
                                            .address_zero = settings->address == 0,
                                            .mode = simulated_as,
                                            .exceptions = traits[DEVICE_EXCEPTIONS] != 0,
                                            .answers_broadcast = traits[DEVICE_ANSWERS_BROADCAST] != 0,
                                            .answers_from_new = traits[DEVICE_ANSWERS_FROM_NEW] != 0,
                                            .real_time = traits[DEVICE_REAL_TIME] != 0,
                                            .seed = settings->seed,
                                            .scene = settings->scene};
    fathom_sim_a16_init(&device->simulator.a16, &config);
    device->base = &device->simulator.a16.device;
}
