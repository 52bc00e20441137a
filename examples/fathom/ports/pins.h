/* SPDX-License-Identifier: MIT */
#ifndef PINS_H
#define PINS_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"
#include "fathom_gpio.h"

/* Lines of a GPIO chip to which a sensor is connected instead of a serial port. */

/* The level of `in` that means that something is near. */
typedef enum {
    PINS_NEAR_USUAL = 0, /* with factory settings */
    PINS_NEAR_LOW = 1,
    PINS_NEAR_HIGH = 2
} pins_near_t;

/* Numbers of lines; -1: none. */
typedef struct {
    int32_t trigger; /* to the sensor's RX; an output */
    uint32_t chip;   /* of a serial port: 1 + the number of the chip that has the trigger; 0: no trigger */
    int32_t echo;    /* from the sensor's TX: pulses */
    int32_t in;      /* a switch, or the contact of a relay */
    uint8_t bias;    /* of the inputs; fathom_gpio_bias_t */
    uint8_t near;    /* pins_near_t */
} pin_options_t;

enum { PINS_LINES = 3 };

/* The lines that were named, open. A reader uses what the host has set. */
typedef struct {
    fathom_pin_t trigger;     /* high */
    fathom_capture_t capture; /* of echo */
    fathom_pin_t in;
    bool wakes; /* a change of `in` ends a sleep */
    pin_options_t wanted;
    volatile uint8_t *missed;        /* edges that must have been missed (edges.h); NULL: not counted */
    uint32_t *lost_events;           /* for which the kernel's queue had no place; NULL: not counted */
    int fd;                          /* that wakes the reader; -1: none */
    fathom_gpio_t lines[PINS_LINES]; /* of a chip of this machine: trigger, echo, in */
} pins_t;

/* Opens the lines of a chip of this machine. If that fails, returns false, and one of `lines` has the error. Do not
 * move *pins. */
bool pins_open(pins_t *pins, const char *chip, const pin_options_t *wanted);
void pins_close(pins_t *pins);

#endif
