/* SPDX-License-Identifier: MIT */
#include "ports/pins.h"

#include <stdio.h>
#include <string.h>

enum { TRIGGER, ECHO, IN, LINES };

/* As a serial port would say it, to which the commands listen. */
static fathom_posix_status_t as_posix(fathom_gpio_status_t status)
{
    switch (status) {
    case FATHOM_GPIO_OK:
        return FATHOM_POSIX_OK;
    case FATHOM_GPIO_ERR_ARGUMENT:
        return FATHOM_POSIX_ERR_ARGUMENT;
    case FATHOM_GPIO_ERR_NOT_FOUND:
        return FATHOM_POSIX_ERR_NOT_FOUND;
    case FATHOM_GPIO_ERR_PERMISSION:
        return FATHOM_POSIX_ERR_PERMISSION;
    case FATHOM_GPIO_ERR_IN_USE:
        return FATHOM_POSIX_ERR_IN_USE;
    case FATHOM_GPIO_ERR_NOT_A_CHIP:
        return FATHOM_POSIX_ERR_NOT_A_TTY;
    case FATHOM_GPIO_ERR_NO_LINE: /* to wait for it makes no sense */
        return FATHOM_POSIX_ERR_REFUSED;
    case FATHOM_GPIO_ERR_UNSUPPORTED:
        return FATHOM_POSIX_ERR_UNSUPPORTED;
    case FATHOM_GPIO_ERR_LOST:
        return FATHOM_POSIX_ERR_LOST;
    default:
        return FATHOM_POSIX_ERR_SYSTEM;
    }
}

static void take_error(const fathom_gpio_t *line, fathom_posix_uart_t *port)
{
    port->error = as_posix(fathom_gpio_error(line));
    (void)snprintf(port->text, sizeof port->text, "%s", fathom_gpio_error_text(line));
}

static bool open_trigger(pins_t *pins, const char *chip, uint32_t number)
{
    fathom_gpio_t *const line = &pins->lines[TRIGGER];
    if (fathom_gpio_open_output(line, chip, number, true) != FATHOM_GPIO_OK) return false;
    pins->trigger = fathom_gpio_pin(line);
    return true;
}

static bool open_echo(pins_t *pins, const char *chip, uint32_t number)
{
    fathom_gpio_t *const line = &pins->lines[ECHO];
    if (fathom_gpio_open_edges(line, chip, number, (fathom_gpio_bias_t)pins->wanted.bias) != FATHOM_GPIO_OK)
        return false;
    pins->capture = fathom_gpio_capture(line);
    pins->missed = &line->edges.missed;
    pins->lost_events = &line->lost_events;
    return true;
}

/* With edges, so that a change ends a sleep; a line that does not tell them is looked at again and again. */
static bool open_in(pins_t *pins, const char *chip, uint32_t number)
{
    const fathom_gpio_bias_t bias = (fathom_gpio_bias_t)pins->wanted.bias;
    fathom_gpio_t *const line = &pins->lines[IN];
    fathom_gpio_status_t status = fathom_gpio_open_edges(line, chip, number, bias);
    pins->wakes = status == FATHOM_GPIO_OK;
    if (status == FATHOM_GPIO_ERR_UNSUPPORTED) status = fathom_gpio_open_input(line, chip, number, bias);
    if (status != FATHOM_GPIO_OK) return false;
    pins->in = fathom_gpio_pin(line);
    return true;
}

static bool open_lines(pins_t *pins, const char *chip, const pin_options_t *wanted, fathom_posix_uart_t *port)
{
    const int32_t numbers[LINES] = {wanted->trigger, wanted->echo, wanted->in};
    bool (*const opens[LINES])(pins_t *, const char *, uint32_t) = {open_trigger, open_echo, open_in};
    for (size_t i = LINES; i != 0; i--) { /* nothing is driven before the inputs are there */
        if (numbers[i - 1] < 0 || opens[i - 1](pins, chip, (uint32_t)numbers[i - 1])) continue;
        take_error(&pins->lines[i - 1], port);
        return false;
    }
    return true;
}

bool pins_open(pins_t *pins, const char *chip, const pin_options_t *wanted, fathom_posix_uart_t *port)
{
    memset(pins, 0, sizeof *pins);
    memset(port, 0, sizeof *port);
    port->fd = -1;
    (void)snprintf(port->path, sizeof port->path, "%s", chip);
    pins->wanted = *wanted;
    if (!open_lines(pins, chip, wanted, port)) {
        pins_close(pins, port);
        return false;
    }
    port->fd = fathom_gpio_fd(&pins->lines[wanted->echo >= 0 ? ECHO : IN]);
    port->is_open = true;
    return true;
}

void pins_close(pins_t *pins, fathom_posix_uart_t *port)
{
    for (size_t i = 0; i != LINES; i++) fathom_gpio_close(&pins->lines[i]);
    port->is_open = false;
    port->fd = -1;
}

void pins_look(const pins_t *pins, fathom_posix_uart_t *port)
{
    for (size_t i = 0; i != LINES; i++) {
        if (!pins->lines[i].is_lost) continue;
        take_error(&pins->lines[i], port);
        port->is_lost = true;
    }
}
