/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "ports/pins.h"

bool pins_open(pins_t *pins, const char *chip, const pin_options_t *wanted, fathom_posix_uart_t *port)
{
    (void)pins;
    (void)wanted;
    memset(port, 0, sizeof *port);
    port->error = FATHOM_POSIX_ERR_UNSUPPORTED;
    (void)snprintf(
        port->text, sizeof port->text,
        "%.100s: this fathom was built without linux/gpio.h of Linux 5.10 or later, which pins need", chip);
    return false;
}

void pins_close(pins_t *pins, fathom_posix_uart_t *port)
{
    (void)pins;
    (void)port;
}

void pins_look(const pins_t *pins, fathom_posix_uart_t *port)
{
    (void)pins;
    (void)port;
}
