/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_CONTACT_RIG_H
#define FATHOM_TESTS_CONTACT_RIG_H

#include <string.h>

#include "suite.h"

#include "fake.h"
#include "fathom/engine/sensor.h"

/* A pin whose level the test sets or plans, a clock, and a driver that looks at it, with what its polls said. */
enum { CONTACT_EDGES = 128 };

typedef struct {
    fake_t fake;
    fathom_pin_t pin;
    bool level;
    uint32_t edges_us[CONTACT_EDGES]; /* planned, in the order of time */
    unsigned edges;
    unsigned edge;          /* the next one */
    fathom_sensor_t sensor; /* the test's */
    fathom_sample_t sample; /* the last one */
    unsigned samples;
    unsigned stales;
    unsigned ports;
} pins_t;

extern pins_t pins;

/* All begins anew at this time, with the pin low. */
void pins_start(uint32_t now_us);

/* The level turns in_us from now. */
void pins_turn(uint32_t in_us);

/* Polls the driver once; without a sample it must not write one. */
fathom_status_t pins_poll(void);

/* Time goes on in steps, with one poll after each. */
void pins_run(uint32_t for_us, uint32_t step_us);

/* So many samples so far, the last of this kind. */
void pins_expect(unsigned samples, uint8_t kind);

#endif
