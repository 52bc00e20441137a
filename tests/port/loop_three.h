/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_LOOP_THREE_H
#define FATHOM_TESTS_LOOP_THREE_H

#include "loop_fake.h"

/* The fixture of the loop's tests in simulated time: three sources that are not added yet, and memory for two sensors. */

static fake_source_t one, two, three;
static fake_sensor_t first, second;

static int set_up(void **state)
{
    (void)fake_set_up(state);
    fake_source(&one);
    fake_source(&two);
    fake_source(&three);
    return 0;
}

static void add(fake_source_t *source) { fathom_loop_add(&fake.loop, &source->source); }
static void step(void) { fathom_loop_step(&fake.loop, FATHOM_NO_DEADLINE); }

#endif
