/* SPDX-License-Identifier: MIT */
/* A bus: USART0 with the line on it, set up by one call. */
#include "fathom/engine/modbus_client.h"
#include "fathom/engine/silence.h"
#include "fathom_avr.h"

/* Sets up USART0, and names what a line that listens needs. The memory of the bus may have any content. */
static bool begin(fathom_avr_bus_t *bus, const fathom_avr_pin_t *driver,
                  const fathom_line_settings_t *settings)
{
    fathom_avr_usart_config_t config = {
        .request = bus->request, .request_size = sizeof bus->request, .line = *settings};
    if (driver != NULL) config.driver = *driver;
    const fathom_line_parts_t parts = {.uart = &fathom_avr_usart0,
                                       .clock = &fathom_avr_clock,
                                       .frame = bus->frame,
                                       .frame_size = sizeof bus->frame,
                                       .marks = fathom_line_marks};
    bus->parts = parts;
    return fathom_avr_usart0_init(&config);
}

bool fathom_avr_bus_init(fathom_avr_bus_t *bus, const fathom_avr_pin_t *driver,
                         const fathom_line_settings_t *settings)
{
    if (!begin(bus, driver, settings)) return false;
    bus->settings = *settings;
    bus->parts.line_settings = &bus->settings;
    bus->parts.silence_us = fathom_silence_us(settings);
    bus->parts.find_echo = fathom_line_find_echo;
    bus->parts.senders = &fathom_line_senders;
    const bool is_ready = fathom_line_init(&bus->line, &bus->parts) == FATHOM_OK;
    bus->modbus = fathom_modbus_client(&bus->line);
    return is_ready;
}

bool fathom_avr_bus_init_listening(fathom_avr_bus_t *bus, const fathom_line_settings_t *settings)
{
    bus->modbus = (fathom_modbus_t){0};
    return begin(bus, NULL, settings) && (fathom_line_init_listening(&bus->line, &bus->parts) == FATHOM_OK);
}

fathom_status_t fathom_avr_bus_read(fathom_sensor_t sensor, fathom_sample_t *sample)
{
    return fathom_wait(&sensor, sample, fathom_avr_idle, NULL);
}
