/* SPDX-License-Identifier: MIT */
#include "sensors/a05.h"

#include "sensors/dyp.h"

/* ---- reading ---- */

bool a05_read_auto(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_a05_auto_t *const driver = &reader->driver.a05_auto;
    const fathom_a05_auto_config_t config = {
        .select = fathom_output_line_break(&port->line),
        .stale_us = settings->timeout_us,
        .gap_us = PORT_STREAM_GAP_US,
        .window = settings->window,
        .probes = settings->probes,
    };
    if (fathom_a05_auto_init(driver, &port->line, &config) != FATHOM_OK) return false;
    (void)dyp_open_stream(reader, &driver->base, fathom_a05_auto_sensor(driver));
    return !settings->has_value || a05_select(reader, port, settings->value);
}

bool a05_read_modbus(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_a05_modbus_t *const driver = &reader->driver.a05_modbus;
    const fathom_a05_modbus_config_t config = {
        .modbus = driver_config(port, settings),
        .window = settings->window,
        .probes = settings->probes,
    };
    return fathom_a05_modbus_init(driver, &port->modbus, &config) == FATHOM_OK &&
           dyp_open_asked(reader, &driver->base, fathom_a05_modbus_sensor(driver));
}

bool a05_read_dyp(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_a05_dyp_t *const driver = &reader->driver.a05_dyp;
    const fathom_a05_dyp_config_t config = {
        .modbus = driver_config(port, settings),
        .window = settings->window,
        .probes = settings->probes,
    };
    return fathom_a05_dyp_init(driver, &port->line, &config) == FATHOM_OK &&
           dyp_open_asked(reader, &driver->base, fathom_a05_dyp_sensor(driver));
}

/* The contact (A05 4) goes to where the input's resistor does not pull; it is the normally open one, unless the user says
 * that near is the other level. */
bool a05_read_relay(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_a05_relay_t *const driver = &reader->driver.a05_relay;
    const pin_options_t *const wanted = &port->pins.wanted;
    const bool conducts_high = wanted->bias == FATHOM_GPIO_BIAS_PULL_DOWN;
    const bool is_normally_closed = wanted->near == (conducts_high ? PINS_NEAR_LOW : PINS_NEAR_HIGH);
    const fathom_a05_relay_config_t config = {
        .timing = driver_contact_timing(port, settings),
        .wiring = is_normally_closed ? FATHOM_A05_RELAY_NORMALLY_CLOSED : FATHOM_A05_RELAY_NORMALLY_OPEN,
        .level = conducts_high ? FATHOM_A05_RELAY_CONDUCTS_HIGH : FATHOM_A05_RELAY_CONDUCTS_LOW,
    };
    return fathom_a05_relay_init(driver, &port->pins.in, &port->clock, &config) == FATHOM_OK &&
           driver_open_contact(reader, &driver->base, fathom_a05_relay_sensor(driver));
}

/* ---- simulation ---- */

void a05_simulate(device_t *device, const device_settings_t *settings, uint8_t simulated_as)
{
    const uint32_t *const traits = settings->traits;
    const fathom_sim_a05_config_t config = {.address = settings->address,
                                            .address_zero = settings->address == 0,
                                            .mode = simulated_as,
                                            .exceptions = traits[DEVICE_EXCEPTIONS] != 0,
                                            .answers_broadcast = traits[DEVICE_ANSWERS_BROADCAST] != 0,
                                            .answers_from_new = traits[DEVICE_ANSWERS_FROM_NEW] != 0,
                                            .real_time = traits[DEVICE_REAL_TIME] != 0,
                                            .seed = settings->seed,
                                            .scene = settings->scene};
    fathom_sim_a05_init(&device->simulator.a05, &config);
    device->base = &device->simulator.a05.device;
}
