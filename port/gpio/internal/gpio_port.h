/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_INTERNAL_GPIO_PORT_H
#define FATHOM_INTERNAL_GPIO_PORT_H

#include "fathom_gpio.h"

/* error.c: each function sets gpio->error and gpio->text and returns the error. `code` is an errno. */
fathom_gpio_status_t fathom_gpio_fail(fathom_gpio_t *gpio, fathom_gpio_status_t error, const char *format,
                                      ...) __attribute__((format(printf, 3, 4)));
fathom_gpio_status_t fathom_gpio_fail_open(fathom_gpio_t *gpio, const char *path, int code);
fathom_gpio_status_t fathom_gpio_fail_system(fathom_gpio_t *gpio, const char *what, int code);
/* For a line that the kernel refused. `consumer` is the program or driver that uses it; "" if that is not known. */
fathom_gpio_status_t fathom_gpio_fail_request(fathom_gpio_t *gpio, const char *consumer, bool is_output,
                                              int code);
/* For an open pin that can no longer be used. */
void fathom_gpio_fail_lost(fathom_gpio_t *gpio, const char *what, int code);

#endif
