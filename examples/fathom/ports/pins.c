/* SPDX-License-Identifier: MIT */
#include "ports/pins.h"

#include <stddef.h>
#include <string.h>

enum { TRIGGER, ECHO, IN };

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

/* With edges, so that a change ends a sleep. A line without edges is sampled again and again. */
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

bool pins_open(pins_t *pins, const char *chip, const pin_options_t *wanted)
{
    const int32_t numbers[PINS_LINES] = {wanted->trigger, wanted->echo, wanted->in};
    bool (*const opens[PINS_LINES])(pins_t *, const char *, uint32_t) = {open_trigger, open_echo, open_in};
    memset(pins, 0, sizeof *pins);
    pins->wanted = *wanted;
    pins->fd = -1;
    for (size_t i = PINS_LINES; i != 0; i--) { /* Nothing is driven before the inputs are open. */
        if (numbers[i - 1] < 0 || opens[i - 1](pins, chip, (uint32_t)numbers[i - 1])) continue;
        pins_close(pins);
        return false;
    }
    pins->fd = fathom_gpio_fd(&pins->lines[wanted->echo >= 0 ? ECHO : IN]);
    return true;
}

/* The error of a line stays after this. */
void pins_close(pins_t *pins)
{
    for (size_t i = 0; i != PINS_LINES; i++) fathom_gpio_close(&pins->lines[i]);
    pins->fd = -1;
}
