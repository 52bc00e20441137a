/* SPDX-License-Identifier: MIT */
#include <poll.h>
#include <stddef.h>

#include "ports/port.h"

/* The driver of a GPIO chip. */

static fathom_status_t fail(port_t *port, const fathom_gpio_t *line)
{
    const fathom_gpio_status_t error = fathom_gpio_error(line);
    return port_set_error(port,
                          error == FATHOM_GPIO_ERR_LOST        ? PORT_LOST
                          : error == FATHOM_GPIO_ERR_NOT_FOUND ? PORT_ABSENT
                                                               : PORT_FAILED,
                          fathom_gpio_error_text(line));
}

fathom_status_t port_open_pins(port_t *port, const char *chip)
{
    const host_t *const host = port->host;
    const fathom_gpio_t *line = port->pins.lines;
    if (host->open_pins(host->ctx, chip, &port->settings.pins, &port->pins)) return FATHOM_OK;
    while (fathom_gpio_error(line) == FATHOM_GPIO_OK && line != &port->pins.lines[PINS_LINES - 1]) line++;
    return fail(port, line);
}

static fathom_status_t open_chip(port_t *port) { return port_open_pins(port, port->settings.path); }

static fathom_status_t poll_chip(port_t *port)
{
    for (size_t i = 0; i != PINS_LINES; i++)
        if (port->pins.lines[i].is_lost) return fail(port, &port->pins.lines[i]);
    return FATHOM_OK;
}

static void close_chip(port_t *port) { port->host->close_pins(port->host->ctx, &port->pins); }

static int chip_fd(const port_t *port) { return port->pins.fd; }

static short chip_events(const port_t *port)
{
    (void)port;
    return POLLIN;
}

const port_driver_t port_chip = {open_chip, poll_chip, close_chip, chip_fd, chip_events};
