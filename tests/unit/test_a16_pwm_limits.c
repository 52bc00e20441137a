/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake_pin.h"
#include "fathom/sensor/a16_pwm.h"

/* a16_pwm.h: the window, and all members of a sample. */

static fake_t fake;
static fake_pin_t pin;
static fathom_a16_pwm_config_t config;
static fathom_a16_pwm_t a16;
static fathom_sensor_t sensor;
static fathom_sample_t sample;

static fathom_status_t init(void)
{
    const fathom_output_t output = fathom_output_pin(&pin.trigger);
    return fathom_a16_pwm_init(&a16, &pin.capture, &fake.clock, &output, &config);
}

static int set_up(void **state)
{
    fake_init(&fake);
    fake_pin_init(&pin, &fake);
    pin.response_after_us = 100000;
    memset(&config, 0, sizeof config);
    config.pulse.noise_us = 1; /* or short pulses would be none */
    memset(&a16, 0x5A, sizeof a16);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* What comes of a pulse of this width. */
static fathom_status_t pulse_of(uint32_t width_us)
{
    assert_int_equal(init(), FATHOM_OK);
    sensor = fathom_a16_pwm_sensor(&a16);
    pin.response_width_us = width_us;
    for (unsigned polls = 0; polls != 100; polls++) {
        memset(&sample, 0xFF, sizeof sample);
        fake.now_us += 10000;
        const fathom_status_t status = fathom_poll(&sensor, &sample);
        if (status != FATHOM_PENDING) return status;
    }
    fail_msg("nothing in 1 s");
    return FATHOM_PENDING;
}

/* "window: ... 0: 1 and ...". width * 4 / 23: 2 us are 0.35 mm, 3 us 0.52 mm, which is 1 mm. */
TEST(distances_from_1_mm_are_believed)
{
    assert_int_equal(pulse_of(2), FATHOM_ERR_MALFORMED);
    assert_int_equal(a16.implausible, 1);
    assert_int_equal(pulse_of(3), FATHOM_OK);
    assert_int_equal(sample.distance_mm, 1);
}

/* 572 us are 99.48 mm, 573 us 99.65 mm. */
TEST(the_nearest_distance_is_an_option)
{
    config.window.min_mm = 100;
    assert_int_equal(pulse_of(572), FATHOM_ERR_MALFORMED);
    assert_int_equal(pulse_of(573), FATHOM_OK);
    assert_int_equal(sample.distance_mm, 100);
}

TEST(a_sample_is_without_interference)
{
    const bool no = false;
    assert_int_equal(pulse_of(10000), FATHOM_OK);
    assert_memory_equal(&sample.interference, &no, sizeof no);
}
