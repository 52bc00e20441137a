/* SPDX-License-Identifier: MIT */
/*
 * A bus: a port with the line on it, set up by one call. The loop uses the same parts for its lines.
 */
#define _POSIX_C_SOURCE 200809L /* nanosleep */
#include <string.h>
#include <time.h>

#include "fathom/engine/modbus_client.h"
#include "internal/posix_port.h"

/* USB adapters hold bytes back for up to 16 ms, in the middle of a frame too. */
enum { GAP_US = 25000 };

/* How long a read takes if the port was gone before it, so that a program that goes on does not use a whole processor. */
enum { PAUSE_S = 1 };

void fathom_posix_bus_set_up(fathom_posix_bus_t *bus, const fathom_uart_t *uart,
                             const fathom_line_settings_t *settings)
{
    bus->uart = *uart;
    bus->settings = *settings;
    bus->clock = fathom_posix_clock();
    bus->parts.uart = &bus->uart;
    bus->parts.clock = &bus->clock;
    bus->parts.frame = bus->frame;
    bus->parts.frame_size = sizeof bus->frame;
    bus->parts.find_echo = fathom_line_find_echo;
    bus->parts.count = fathom_line_count;
    bus->parts.counters = bus->counters;
    bus->parts.senders = &fathom_line_senders;
    bus->parts.masters = &fathom_line_masters;
    bus->parts.silence_us = settings->baud >= 9600u
                                ? fathom_silence_us(settings)
                                : FATHOM_T3_5_US(settings->baud, fathom_character_bits(settings));
    bus->parts.gap_us = GAP_US;
    bus->parts.line_settings = &bus->settings;
    /* The line accepts each silence of 588 baud and more, and the port has no rate below 1200. */
    (void)fathom_line_init(&bus->line, &bus->parts);
    bus->modbus = fathom_modbus_client(&bus->line);
}

fathom_posix_status_t fathom_posix_bus_open(fathom_posix_bus_t *bus, const char *path,
                                            const fathom_line_settings_t *settings)
{
    if (bus == NULL) return FATHOM_POSIX_ERR_ARGUMENT;
    memset(bus, 0, sizeof *bus);
    const fathom_posix_status_t status = fathom_posix_open(&bus->port, path, settings);
    const fathom_uart_t uart = fathom_posix_uart(&bus->port);
    if (status == FATHOM_POSIX_OK) fathom_posix_bus_set_up(bus, &uart, settings);
    return status;
}

void fathom_posix_bus_close(fathom_posix_bus_t *bus)
{
    if (bus != NULL) fathom_posix_close(&bus->port);
}

const char *fathom_posix_bus_error(const fathom_posix_bus_t *bus)
{
    return fathom_posix_error_text(&bus->port);
}

fathom_status_t fathom_posix_bus_read(fathom_posix_bus_t *bus, fathom_sensor_t sensor,
                                      fathom_sample_t *sample)
{
    if (!bus->port.is_open || bus->port.is_lost) (void)nanosleep(&(struct timespec){.tv_sec = PAUSE_S}, NULL);
    return fathom_wait(&sensor, sample, fathom_posix_wait, &bus->port);
}
