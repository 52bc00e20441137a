/* SPDX-License-Identifier: MIT */
#ifndef PINS_H
#define PINS_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"
#include "fathom_gpio.h"
#include "fathom_posix.h"

/* The lines of a GPIO chip that a sensor hangs on instead of a serial port. */

/* Which level of `in` means that something is near. */
typedef enum {
    PINS_NEAR_USUAL = 0, /* as the sensor comes from the factory */
    PINS_NEAR_LOW = 1,
    PINS_NEAR_HIGH = 2
} pins_near_t;

/* Which they are; -1: none. */
typedef struct {
    int32_t trigger; /* to the sensor's RX; an output */
    int32_t echo;    /* from its TX: pulses */
    int32_t in;      /* a switch, or a relay's contact */
    uint8_t bias;    /* of the inputs; fathom_gpio_bias_t */
    uint8_t near;    /* pins_near_t */
} pin_options_t;

/* Open ones: those that were named. What a reader takes of them is whatever the host has filled in. */
typedef struct {
    fathom_pin_t trigger;     /* high */
    fathom_capture_t capture; /* of echo */
    fathom_pin_t in;
    bool wakes; /* a change of `in` ends a sleep */
    pin_options_t wanted;
    volatile uint8_t *missed; /* edges that must have been missed (edges.h); NULL: not counted */
    uint32_t *lost_events;    /* that the kernel's queue had no place for; NULL: likewise */
    fathom_gpio_t lines[3];   /* of a chip of this machine: trigger, echo, in */
} pins_t;

/* Opens them on a chip of this machine. False: *port has the error and its text; else *port stands in for the input, as
 * tcp.h has it. *pins may not be moved. */
bool pins_open(pins_t *pins, const char *chip, const pin_options_t *wanted, fathom_posix_uart_t *port);
void pins_close(pins_t *pins, fathom_posix_uart_t *port);

/* Has the chip gone? Then *port is lost. To be called after each poll. */
void pins_look(const pins_t *pins, fathom_posix_uart_t *port);

#endif
