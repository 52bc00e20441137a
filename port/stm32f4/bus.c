/* SPDX-License-Identifier: MIT */
/* A bus: a USART with the line on it, set up by one call. */
#include "fathom/engine/modbus_client.h"
#include "fathom/engine/silence.h"
#include "fathom_stm32f4.h"

/* Sets up the USART, and names what a line that listens needs. The memory of the bus may have any content. */
static bool begin(fathom_stm32f4_bus_t *bus, const fathom_stm32f4_usart_config_t *wiring,
                  const fathom_line_settings_t *settings)
{
    fathom_stm32f4_usart_config_t config = *wiring;
    config.line = *settings;
    config.request = bus->request;
    config.request_size = sizeof bus->request;
    bus->uart = fathom_stm32f4_usart(&bus->port);
    bus->parts = (fathom_line_parts_t){.uart = &bus->uart,
                                       .clock = &fathom_stm32f4_clock,
                                       .frame = bus->frame,
                                       .frame_size = sizeof bus->frame,
                                       .marks = fathom_line_marks};
    return fathom_stm32f4_usart_init(&bus->port, &config);
}

bool fathom_stm32f4_bus_init(fathom_stm32f4_bus_t *bus, const fathom_stm32f4_usart_config_t *wiring,
                             const fathom_line_settings_t *settings)
{
    if (!begin(bus, wiring, settings)) return false;
    bus->settings = *settings;
    bus->parts.line_settings = &bus->settings;
    bus->parts.silence_us = fathom_silence_us(settings);
    bus->parts.find_echo = fathom_line_find_echo;
    bus->parts.senders = &fathom_line_senders;
    const bool is_ready = fathom_line_init(&bus->line, &bus->parts) == FATHOM_OK;
    bus->modbus = fathom_modbus_client(&bus->line);
    return is_ready;
}

bool fathom_stm32f4_bus_init_listening(fathom_stm32f4_bus_t *bus, const fathom_stm32f4_usart_config_t *wiring,
                                       const fathom_line_settings_t *settings)
{
    bus->modbus = (fathom_modbus_t){0};
    return begin(bus, wiring, settings) && (fathom_line_init_listening(&bus->line, &bus->parts) == FATHOM_OK);
}

fathom_status_t fathom_stm32f4_bus_read(fathom_stm32f4_bus_t *bus, fathom_sensor_t sensor,
                                        fathom_sample_t *sample)
{
    fathom_stm32f4_idle_t idle = {&bus->port, 1};
    return fathom_wait(&sensor, sample, fathom_stm32f4_idle, &idle);
}
