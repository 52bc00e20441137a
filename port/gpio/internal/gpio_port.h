/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_INTERNAL_GPIO_PORT_H
#define FATHOM_INTERNAL_GPIO_PORT_H

#include "fathom_gpio.h"

/* error.c: all set gpio->error and gpio->text and return the error. `code` is an errno. */
fathom_gpio_status_t fathom_gpio_fail(fathom_gpio_t *gpio, fathom_gpio_status_t error, const char *format,
                                      ...) __attribute__((format(printf, 3, 4)));
fathom_gpio_status_t fathom_gpio_fail_open(fathom_gpio_t *gpio, const char *path, int code);
fathom_gpio_status_t fathom_gpio_fail_system(fathom_gpio_t *gpio, const char *what, int code);
/* The line was refused. consumer: who has it; "": not known. */
fathom_gpio_status_t fathom_gpio_fail_request(fathom_gpio_t *gpio, const char *consumer, bool is_output,
                                              int code);
/* Of an open one: it is of no use any more. */
void fathom_gpio_fail_lost(fathom_gpio_t *gpio, const char *what, int code);

#endif
