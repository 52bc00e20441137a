/* SPDX-License-Identifier: MIT */
#include "sensors/a16.h"

static fathom_status_t end_pwm(reader_t *reader) { return fathom_a16_pwm_deinit(&reader->driver.a16_pwm); }

/* Each trigger returns one pulse (A16 1). */
bool a16_read_pwm(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_a16_pwm_t *const driver = &reader->driver.a16_pwm;
    const pins_t *const pins = &port->pins;
    const uint32_t cycle_us = settings->period_us > FATHOM_PULSE_DEFAULT_CYCLE_US ? settings->period_us : 0;
    const fathom_output_t output = fathom_output_pin(&pins->trigger);
    const fathom_a16_pwm_config_t config = {.pulse = {.cycle_us = cycle_us}, .window = settings->window};
    if (fathom_a16_pwm_init(driver, &pins->capture, &port->clock, &output, &config) != FATHOM_OK)
        return false;
    reader->sensor = fathom_a16_pwm_sensor(driver);
    reader->end = end_pwm;
    reader->sequence = &driver->sequence;
    reader->meter = &driver->meter;
    reader->pins = pins;
    reader->window = &driver->window;
    reader->period_us = &driver->meter.trigger.period_us;
    return true;
}

/* With factory settings "less than 1 meter" is a high level (A16 4). */
bool a16_read_switch(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_a16_switch_t *const driver = &reader->driver.a16_switch;
    const fathom_a16_switch_config_t config = {.timing = driver_contact_timing(port, settings),
                                               .negative = port->pins.wanted.near == PINS_NEAR_LOW};
    return fathom_a16_switch_init(driver, &port->pins.in, &port->clock, &config) == FATHOM_OK &&
           driver_open_contact(reader, &driver->base, fathom_a16_switch_sensor(driver));
}
