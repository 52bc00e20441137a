/* SPDX-License-Identifier: MIT */
#include "ports/host.h"

#include <stddef.h>
#include <string.h>

enum { TRIGGER, ECHO, IN };

/* With edges, so that a change ends a sleep. A line without edges is sampled again and again. */
static fathom_gpio_status_t open_in(pins_t *pins, const char *chip, uint32_t number)
{
    const fathom_gpio_bias_t bias = (fathom_gpio_bias_t)pins->wanted.bias;
    const fathom_gpio_status_t status = fathom_gpio_open_edges(&pins->lines[IN], chip, number, bias);
    pins->wakes = status == FATHOM_GPIO_OK;
    return status == FATHOM_GPIO_ERR_UNSUPPORTED
               ? fathom_gpio_open_input(&pins->lines[IN], chip, number, bias)
               : status;
}

/* Nothing is driven before the inputs are open. The trigger is opened at its idle level, so that it triggers nothing. */
static bool open_lines(pins_t *pins, const char *chip)
{
    const pin_options_t *const wanted = &pins->wanted;
    fathom_gpio_t *const lines = pins->lines;
    return (wanted->in < 0 || open_in(pins, chip, (uint32_t)wanted->in) == FATHOM_GPIO_OK) &&
           (wanted->echo < 0 || fathom_gpio_open_edges(&lines[ECHO], chip, (uint32_t)wanted->echo,
                                                       (fathom_gpio_bias_t)wanted->bias) == FATHOM_GPIO_OK) &&
           (wanted->trigger < 0 || fathom_gpio_open_output(&lines[TRIGGER], chip, (uint32_t)wanted->trigger,
                                                           !wanted->idles_low) == FATHOM_GPIO_OK);
}

bool pins_open(void *ctx, const char *chip, const pin_options_t *wanted, pins_t *pins)
{
    fathom_gpio_t *const lines = pins->lines;
    memset(pins, 0, sizeof *pins);
    pins->wanted = *wanted;
    if (!open_lines(pins, chip)) {
        pins_close(ctx, pins);
        return false;
    }
    pins->fd = fathom_gpio_fd(&lines[wanted->echo >= 0 ? ECHO : IN]);
    pins->trigger = fathom_gpio_pin(&lines[TRIGGER]);
    pins->in = fathom_gpio_pin(&lines[IN]);
    pins->capture = fathom_gpio_capture(&lines[ECHO]);
    pins->missed = &lines[ECHO].edges.missed;
    pins->lost_events = &lines[ECHO].lost_events;
    return true;
}

void pins_close(void *ctx, pins_t *pins)
{
    (void)ctx;
    for (size_t i = 0; i != PINS_LINES; i++) fathom_gpio_close(&pins->lines[i]);
    pins->fd = -1;
}
