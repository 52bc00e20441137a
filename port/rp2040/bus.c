/* SPDX-License-Identifier: MIT */
/* A bus: a UART with the line on it and the sleep of its reader, set up by one call. */
#include "fathom/engine/modbus_client.h"
#include "fathom/engine/silence.h"
#include "fathom_rp2040.h"

/* Sets up the UART and the sleep, and names what a line that listens needs. The memory of the bus may have any content. */
static bool begin(fathom_rp2040_bus_t *bus, const fathom_rp2040_wiring_t *wiring,
                  const fathom_line_settings_t *settings)
{
    bus->idle.alarm = (uint8_t)((wiring->alarm + 1u) % FATHOM_RP2040_ALARMS);
    fathom_rp2040_idle_init(&bus->idle);
    bus->uart = fathom_rp2040_uart(&bus->port);
    bus->parts = (fathom_line_parts_t){.uart = &bus->uart,
                                       .clock = &fathom_rp2040_clock,
                                       .frame = bus->frame,
                                       .frame_size = sizeof bus->frame,
                                       .marks = fathom_line_marks};
    const fathom_rp2040_uart_config_t config = {.wiring = *wiring,
                                                .line = *settings,
                                                .request = bus->request,
                                                .request_size = sizeof bus->request,
                                                .idle = &bus->idle};
    return fathom_rp2040_uart_init(&bus->port, &config);
}

bool fathom_rp2040_bus_init(fathom_rp2040_bus_t *bus, const fathom_rp2040_wiring_t *wiring,
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

bool fathom_rp2040_bus_init_listening(fathom_rp2040_bus_t *bus, const fathom_rp2040_wiring_t *wiring,
                                      const fathom_line_settings_t *settings)
{
    bus->modbus = (fathom_modbus_t){0};
    return begin(bus, wiring, settings) && (fathom_line_init_listening(&bus->line, &bus->parts) == FATHOM_OK);
}

fathom_status_t fathom_rp2040_bus_read(fathom_rp2040_bus_t *bus, fathom_sensor_t sensor,
                                       fathom_sample_t *sample)
{
    return fathom_wait(&sensor, sample, fathom_rp2040_idle, &bus->idle);
}
