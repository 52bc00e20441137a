/* SPDX-License-Identifier: MIT */
#include "contact_rig.h"
#include "fathom/a05_relay.h"

#define MS ((int32_t)1000) /* an int may have 16 bits */
enum { START_US = 1000 };

static fathom_a05_relay_config_t config;
static fathom_a05_relay_t relay;

static void start(bool level)
{
    pins_start(START_US);
    pins.level = level;
    config.pin = &pins.pin;
    config.clock = &pins.fake.clock;
    memset(&relay, 0x5A, sizeof relay);
    assert_int_equal(fathom_a05_relay_init(&relay, &config), FATHOM_READY);
    pins.sensor = fathom_a05_relay_sensor(&relay);
}

static int set_up(void **state)
{
    memset(&config, 0, sizeof config);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* The kind that this level is read as. */
static uint8_t read_as(bool level)
{
    start(level);
    pins_run(20 * MS, 1000);
    assert_int_equal(pins.samples, 1);
    assert_int_equal(pins.sample.raw, level);
    return pins.sample.kind;
}

/* A05 4(1): closed, and so conducting, when a probe has something nearer than the threshold. */
TEST(a_normally_open_contact_that_conducts_is_near)
{
    assert_int_equal(read_as(false), FATHOM_NEAR);
    assert_int_equal(read_as(true), FATHOM_FAR);
    config.wiring = FATHOM_A05_RELAY_NORMALLY_OPEN;
    config.level = FATHOM_A05_RELAY_CONDUCTS_LOW;
    assert_int_equal(read_as(false), FATHOM_NEAR);
    assert_int_equal(read_as(true), FATHOM_FAR);
    config.level = FATHOM_A05_RELAY_CONDUCTS_HIGH;
    assert_int_equal(read_as(false), FATHOM_FAR);
    assert_int_equal(read_as(true), FATHOM_NEAR);
}

TEST(a_normally_closed_contact_that_conducts_is_far)
{
    config.wiring = FATHOM_A05_RELAY_NORMALLY_CLOSED;
    assert_int_equal(read_as(false), FATHOM_FAR);
    assert_int_equal(read_as(true), FATHOM_NEAR);
    config.level = FATHOM_A05_RELAY_CONDUCTS_HIGH;
    assert_int_equal(read_as(false), FATHOM_NEAR);
    assert_int_equal(read_as(true), FATHOM_FAR);
}

TEST(a_sample_says_who_and_when_and_has_no_distance)
{
    start(true);
    pins_run(50 * MS, 1000);
    pins_turn(3 * MS);
    pins_run(50 * MS, 1000);
    pins_expect(2, FATHOM_NEAR);
    assert_int_equal(pins.sample.time_us, START_US + 53 * MS);
    assert_int_equal(pins.sample.model, FATHOM_A05);
    assert_int_equal(pins.sample.unit, 0);
    assert_int_equal(pins.sample.probe, 1);
    assert_int_equal(pins.sample.distance_mm, 0);
}

TEST(the_times_are_options)
{
    config.timing.settle_us = 30000;
    config.timing.period_us = 400000;
    config.timing.look_us = 3000;
    config.timing.stale_us = 60000;
    start(true);
    assert_int_equal(fathom_due_us(&pins.sensor, 1), 3000);
    pins_run(29 * MS, 1000);
    assert_int_equal(pins.samples, 0);
    pins_run(1 * MS, 1000);
    assert_int_equal(pins.samples, 1);
    pins_run(399 * MS, 1000);
    assert_int_equal(pins.samples, 1);
    pins_run(1 * MS, 1000);
    pins_expect(2, FATHOM_FAR);
    for (uint32_t i = 0; i != 100; i++) pins_turn((i + 1) * MS);
    pins_run(60 * MS, 1000);
    assert_int_equal(pins.stales, 0);
    pins_run(1 * MS, 1000);
    assert_int_equal(pins.stales, 1);
}

TEST(a_config_without_sense_is_refused)
{
    start(true);
    config.wiring = 3;
    assert_int_equal(fathom_a05_relay_init(&relay, &config), FATHOM_ERR_ARGUMENT);
    config.wiring = 0;
    config.level = 3;
    assert_int_equal(fathom_a05_relay_init(&relay, &config), FATHOM_ERR_ARGUMENT);
    config.level = 0;
    config.clock = NULL;
    assert_int_equal(fathom_a05_relay_init(&relay, &config), FATHOM_ERR_ARGUMENT);
    config.clock = &pins.fake.clock;
    config.pin = NULL;
    assert_int_equal(fathom_a05_relay_init(&relay, &config), FATHOM_ERR_ARGUMENT);
}
