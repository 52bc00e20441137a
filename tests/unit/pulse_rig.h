/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_PULSE_RIG_H
#define FATHOM_TESTS_PULSE_RIG_H

#include "fake_pin.h"
#include "fathom/pulse.h"

/* A meter on fake pins, with what its polls said. */
#define MS ((int32_t)1000) /* an int may have 16 bits */

typedef struct {
    fake_t fake;
    fake_pin_t pin;
    fathom_pulse_config_t config; /* the test's to change before it starts anew */
    fathom_pulse_meter_t meter;
    fathom_pulse_reading_t last;
    unsigned readings;
    unsigned no_answers;
} pulse_rig_t;

extern pulse_rig_t stand;

/* For cmocka: the default config with a pin, at 1000 us. */
int pulse_rig_set_up(void **state);

/* All but the config begins anew, at this time. */
void pulse_rig_start(uint32_t now_us);

/* Polls once; without a reading none may be written. */
fathom_status_t pulse_rig_poll(void);

void pulse_rig_run(uint32_t for_us, uint32_t step_us);

/* To the trigger, which comes 2 ms after the start. */
void pulse_rig_run_to_trigger(void);

#endif
