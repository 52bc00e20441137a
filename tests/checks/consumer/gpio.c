/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "fathom_gpio.h"

/* The port of pins is installed with what it needs: it says that this is no chip. */
int main(void)
{
    static fathom_gpio_t pin;
    if (fathom_gpio_open_output(&pin, "/dev/null", 17, true) != FATHOM_GPIO_ERR_NOT_A_CHIP) return 1;
    printf("%.*s\n", (int)strcspn(fathom_gpio_error_text(&pin), ";"), fathom_gpio_error_text(&pin));
    return 0;
}
