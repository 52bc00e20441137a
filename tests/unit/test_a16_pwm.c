/* SPDX-License-Identifier: MIT */
#include "drivers.h"
#include "fake_pin.h"
#include "fathom/sensor/a16_pwm.h"

/* What widths mean; test_driver_contract.c has the rest. */

static fake_t fake;
static fake_pin_t pin;
static fathom_a16_pwm_config_t config;
static fathom_output_t output;
static fathom_a16_pwm_t a16;
static fathom_sensor_t sensor;
static fathom_sample_t last;

static void start(void)
{
    fake_init(&fake);
    fake_pin_init(&pin, &fake);
    pin.response_after_us = 110 * MS;
    memset(&a16, 0x5A, sizeof a16);
    assert_int_equal(fathom_a16_pwm_init(&a16, &pin.capture, &fake.clock, &output, &config), FATHOM_OK);
    sensor = fathom_a16_pwm_sensor(&a16);
}

static int set_up(void **state)
{
    output = fathom_output_pin(&pin.trigger);
    config = (fathom_a16_pwm_config_t){0};
    start();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* Runs until a cycle has brought something. One that begins before that has a pulse of this width, or none. */
static fathom_status_t cycle(uint32_t width_us)
{
    fathom_status_t status = FATHOM_PENDING;
    pin.response_width_us = width_us;
    for (unsigned polls = 0; status == FATHOM_PENDING; polls++) {
        assert_true(polls < 100);
        fake.now_us += 20 * MS;
        status = checked_poll(&sensor, &last);
    }
    pin.response_width_us = 0;
    return status;
}

static void is(fathom_status_t status, uint8_t kind, uint32_t raw, uint16_t mm)
{
    assert_int_equal(status, FATHOM_OK);
    assert_int_equal(last.kind, kind);
    assert_int_equal(last.raw, raw);
    assert_int_equal(last.distance_mm, mm);
}

/* Of the first cycle. */
static void measures(uint32_t width_us, fathom_status_t status)
{
    start();
    assert_int_equal(cycle(width_us), status);
}

static void reads(uint32_t width_us, uint8_t kind, uint16_t mm)
{
    start();
    is(cycle(width_us), kind, width_us, mm);
}

TEST(no_target_and_faults_are_samples_without_a_distance)
{
    reads(10000, FATHOM_TARGET, 1739);
    reads(94000, FATHOM_NO_TARGET, 0);
    reads(105001, FATHOM_FAULT, 0);
    start();
    pin.stuck_high = true;
    is(cycle(0), FATHOM_FAULT, 0, 0);
}

TEST(samples_are_numbered_and_errors_are_not)
{
    unsigned no_responses = 0;
    for (unsigned i = 1; i <= 4; i++) {
        fathom_status_t status;
        while ((status = cycle(10000)) == FATHOM_ERR_NO_RESPONSE) no_responses++;
        assert_int_equal(status, FATHOM_OK);
        assert_int_equal(last.sequence, i);
        if (i != 1) assert_int_equal(cycle(0), FATHOM_ERR_NO_RESPONSE);
    }
    assert_int_equal(no_responses, 2); /* the cycles that had begun without one */
}

TEST(a_window_of_the_users_own_is_kept_and_refusals_are_counted)
{
    config.window.min_mm = 1739;
    config.window.max_mm = 1740;
    measures(10000, FATHOM_OK);
    measures(10003, FATHOM_OK);            /* 1739.65 */
    measures(9996, FATHOM_ERR_MALFORMED);  /* 1738.4 */
    measures(10009, FATHOM_ERR_MALFORMED); /* 1740.7 */
    assert_int_equal(a16.implausible, 1);
    measures(94000, FATHOM_OK); /* no distance */
    a16.implausible = UINT16_MAX;
    while (cycle(10009) != FATHOM_ERR_MALFORMED) assert_true(pin.falls < 5);
    assert_int_equal(a16.implausible, UINT16_MAX);
}

/* "window: ... 0: 1 and ...". width * 4 / 23: 2 us are 0.35 mm, 3 us 0.52; 572 us are 99.48 mm, 573 us 99.65. */
TEST(distances_from_1_mm_are_believed_and_the_nearest_is_an_option)
{
    config.pulse.noise_us = 1; /* or short pulses would be none */
    measures(2, FATHOM_ERR_MALFORMED);
    assert_int_equal(a16.implausible, 1);
    reads(3, FATHOM_TARGET, 1);
    config.window.min_mm = 100;
    measures(572, FATHOM_ERR_MALFORMED);
    reads(573, FATHOM_TARGET, 100);
}

TEST(the_whole_range_is_in_the_default_windows)
{
    config.pulse.no_target_us = 94000;
    reads(2700, FATHOM_TARGET, 470);    /* 469.6 */
    reads(93999, FATHOM_TARGET, 16348); /* 16347.7 */
    config.in_air = true;
    config.air_dc = 850;
    reads(93999, FATHOM_TARGET, 17992); /* 382.81 * 46.9995 = 17991.9 */
}

TEST(the_temperature_of_the_air_is_an_option_that_may_change)
{
    config.air_dc = 200; /* without in_air it means nothing */
    reads(10000, FATHOM_TARGET, 1739);
    config.in_air = true;
    reads(10000, FATHOM_TARGET, 1717); /* 343.42 m/s * 5 ms */
    start();
    a16.air_dc = -400;
    is(cycle(10000), FATHOM_TARGET, 10000, 1535); /* 307.06 m/s * 5 ms */
}

/* Each of the engine's options reaches it. */
TEST(the_options_of_the_pulse_are_the_drivers)
{
    config.pulse.noise_us = 11000;
    reads(10000, FATHOM_UNKNOWN, 0);
    assert_int_equal(a16.meter.noises, 1);
    config.pulse.noise_us = 0;
    config.pulse.no_target_us = 9000;
    reads(10000, FATHOM_NO_TARGET, 0);
    config.pulse.stuck_us = 9500;
    reads(10000, FATHOM_FAULT, 0);
    config.pulse.no_target_us = config.pulse.stuck_us = 0;
    config.pulse.cycle_us = 400 * MS;
    config.pulse.low_us = 50 * MS;
    start();
    for (unsigned i = 0; i != 2000; i++) {
        fake.now_us += 1 * MS;
        fathom_poll(&sensor, &last);
    }
    assert_int_equal(pin.falls, 5);
    assert_int_equal(pin.least_us, 400 * MS);
    assert_int_equal(pin.low_us, 50 * MS);
}

TEST(it_is_due_as_its_engine_is)
{
    for (unsigned i = 0; i != 2; i++) {
        assert_int_equal(fathom_due_us(&sensor, 1), 2 * MS);
        fake.now_us += 2 * MS;
        fathom_poll(&sensor, &last);
    }
    fake.now_us += 100 * MS;
    assert_int_equal(fathom_due_us(&sensor, 1), 119 * MS);
}
