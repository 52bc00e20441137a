/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_FAKE_PIN_H
#define FATHOM_TESTS_FAKE_PIN_H

#include <stdbool.h>
#include <stdint.h>

#include "fake.h"

/*
 * A sensor that answers a trigger with a pulse, as its pins are seen: the trigger pin keeps when it fell and rose, and
 * the capture hands over pulses that the test has scheduled, when their end has come. Times are those of a fake_t,
 * which also has the break.
 */
enum { FAKE_PULSES = 32 };

typedef struct {
    uint32_t rise_us;
    uint32_t width_us;
} fake_pulse_t;

typedef struct {
    fake_t *fake;

    bool level; /* of the trigger */
    unsigned sets;
    unsigned falls;
    uint32_t fall_us; /* the last one */
    uint32_t low_us;  /* how long the last low lasted */
    bool has_fallen;
    uint32_t delay_us; /* the next fall comes so much later than set is called; once */
    uint32_t least_us; /* between two falls */
    uint32_t least_high_us;
    uint32_t rise_us;

    fake_pulse_t pulses[FAKE_PULSES];
    unsigned first;
    unsigned last;
    unsigned arms;
    uint32_t armed_us;
    bool stuck_high;
    bool take_fails;

    /* Each fall schedules a pulse of this width this much later; 0: none. */
    uint32_t response_width_us;
    uint32_t response_after_us;

    fathom_pin_t trigger;
    fathom_capture_t capture;
} fake_pin_t;

void fake_pin_init(fake_pin_t *pin, fake_t *fake);

/* A pulse that rises so long from now. In the order of time. */
void fake_pulse(fake_pin_t *pin, uint32_t in_us, uint32_t width_us);

#endif
