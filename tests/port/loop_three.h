/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_LOOP_THREE_H
#define FATHOM_TESTS_LOOP_THREE_H

#include "loop_fake.h"
#include "suite.h"

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

static inline void add_due(fake_source_t *source, uint32_t due_us)
{
    source->due_us = due_us;
    add(source);
}

/* Adds `one` and its sensors. */
static inline void add_with_sensor(void)
{
    add(&one);
    fake_sensor(&first, &one);
}
static inline void add_with_sensors(void)
{
    add_with_sensor();
    fake_sensor(&second, &one);
}

/* A step, which ends so long after the beginning. */
static inline void step_to(uint64_t us)
{
    step();
    assert_int_equal(fake_elapsed_us(), us);
}

/* A step in which `one` is lost. */
static inline void lose_one(void)
{
    one.is_lost = true;
    step();
}

static inline void expect_polls(unsigned of_one, unsigned of_two)
{
    assert_int_equal(one.polls, of_one);
    assert_int_equal(two.polls, of_two);
}

#endif
