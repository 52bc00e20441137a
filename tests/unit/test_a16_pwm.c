/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake_pin.h"
#include "fathom/a16_pwm.h"

#define MS ((int32_t)1000) /* an int may have 16 bits */
enum { GUARD = 0xA5 };

static fake_t fake;
static fake_pin_t pin;
static fathom_a16_pwm_config_t config;
static fathom_a16_pwm_t a16;
static fathom_sensor_t sensor;
static fathom_sample_t last;

static void start(void)
{
    fake_init(&fake);
    fake_pin_init(&pin, &fake);
    pin.answer_after_us = 110 * MS;
    memset(&a16, 0x5A, sizeof a16);
    assert_int_equal(fathom_a16_pwm_init(&a16, &config), FATHOM_READY);
    sensor = fathom_a16_pwm_sensor(&a16);
}

static int set_up(void **state)
{
    memset(&config, 0, sizeof config);
    config.clock = &fake.clock;
    config.capture = &pin.capture;
    config.trigger = &pin.trigger;
    start();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* Runs until a cycle has brought something; without a sample none may be written. A cycle that begins before that has
 * a pulse of this width, or none. */
static fathom_status_t cycle(uint32_t width_us)
{
    pin.answer_width_us = width_us;
    for (unsigned polls = 0; polls != 100; polls++) {
        fathom_sample_t sample;
        uint8_t untouched[sizeof sample];
        memset(&sample, GUARD, sizeof sample);
        memset(untouched, GUARD, sizeof untouched);
        fake.now_us += 20 * MS;
        const fathom_status_t status = fathom_poll(&sensor, &sample);
        if (status == FATHOM_READY) last = sample;
        if (status != FATHOM_READY) assert_memory_equal(&sample, untouched, sizeof untouched);
        if (status == FATHOM_PENDING) continue;
        pin.answer_width_us = 0;
        return status;
    }
    fail_msg("nothing in 2 s");
    return FATHOM_PENDING;
}

static fathom_status_t measure(uint32_t width_us)
{
    start();
    return cycle(width_us);
}

TEST(the_example_of_the_datasheet_is_a_sample_with_all_its_members)
{
    assert_int_equal(measure(10000), FATHOM_READY); /* A16 1(4): 173.9 cm */
    assert_int_equal(last.distance_mm, 1739);
    assert_int_equal(last.raw, 10000);
    assert_int_equal(last.kind, FATHOM_TARGET);
    assert_int_equal(last.model, FATHOM_A16);
    assert_int_equal(last.sequence, 1);
    assert_int_equal(last.unit, 0);
    assert_int_equal(last.probe, 1);
    assert_int_equal(last.magnitude + last.precision + last.ambient, 0);
    assert_false(last.interference);
    assert_int_equal(last.time_us, pin.fall_us + 120 * MS);
}

TEST(no_target_and_faults_are_samples_without_a_distance)
{
    assert_int_equal(measure(94000), FATHOM_READY);
    assert_int_equal(last.kind, FATHOM_NO_TARGET);
    assert_int_equal(last.raw, 94000);
    assert_int_equal(last.distance_mm, 0);
    assert_int_equal(measure(105001), FATHOM_READY);
    assert_int_equal(last.kind, FATHOM_FAULT);
    assert_int_equal(last.raw, 105001);
    assert_int_equal(last.distance_mm, 0);
    start();
    pin.stuck_high = true;
    assert_int_equal(cycle(0), FATHOM_READY);
    assert_int_equal(last.kind, FATHOM_FAULT);
    assert_int_equal(last.raw, 0);
}

TEST(no_pulse_is_no_answer_and_never_no_target)
{
    assert_int_equal(measure(0), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(cycle(0), FATHOM_ERR_NO_ANSWER);
}

TEST(samples_are_numbered_and_errors_are_not)
{
    unsigned no_answers = 0;
    assert_int_equal(cycle(10000), FATHOM_READY);
    assert_int_equal(last.sequence, 1);
    for (unsigned i = 2; i <= 4; i++) {
        fathom_status_t status;
        while ((status = cycle(10000)) == FATHOM_ERR_NO_ANSWER) no_answers++;
        assert_int_equal(status, FATHOM_READY);
        assert_int_equal(last.sequence, i);
        assert_int_equal(cycle(0), FATHOM_ERR_NO_ANSWER);
    }
    assert_int_equal(no_answers, 2); /* the cycles that had begun without one */
}

TEST(a_window_of_the_users_own_is_kept_and_refusals_are_counted)
{
    config.window.min_mm = 1739;
    config.window.max_mm = 1740;
    assert_int_equal(measure(10000), FATHOM_READY);
    assert_int_equal(measure(10003), FATHOM_READY);         /* 1739.65 */
    assert_int_equal(measure(9996), FATHOM_ERR_MALFORMED);  /* 1738.4 */
    assert_int_equal(measure(10009), FATHOM_ERR_MALFORMED); /* 1740.7 */
    assert_int_equal(a16.implausible, 1);
    assert_int_equal(measure(94000), FATHOM_READY); /* no distance */
    a16.implausible = UINT16_MAX;
    while (cycle(10009) != FATHOM_ERR_MALFORMED) assert_true(pin.falls < 5);
    assert_int_equal(a16.implausible, UINT16_MAX);
}

TEST(the_whole_range_is_in_the_default_windows)
{
    config.no_target_us = 94000;
    assert_int_equal(measure(2700), FATHOM_READY);
    assert_int_equal(last.distance_mm, 470); /* 469.6 */
    assert_int_equal(measure(93999), FATHOM_READY);
    assert_int_equal(last.distance_mm, 16348); /* 16347.7 */
    config.in_air = true;
    config.air_dc = 850;
    assert_int_equal(measure(93999), FATHOM_READY);
    assert_int_equal(last.distance_mm, 17992); /* 382.81 * 46.9995 = 17991.9 */
}

TEST(the_temperature_of_the_air_is_an_option_that_may_change)
{
    config.air_dc = 200; /* without in_air it means nothing */
    assert_int_equal(measure(10000), FATHOM_READY);
    assert_int_equal(last.distance_mm, 1739);
    config.in_air = true;
    assert_int_equal(measure(10000), FATHOM_READY);
    assert_int_equal(last.distance_mm, 1717); /* 343.42 m/s * 5 ms */
    start();
    a16.air_dc = -400;
    assert_int_equal(cycle(10000), FATHOM_READY);
    assert_int_equal(last.distance_mm, 1535); /* 307.06 m/s * 5 ms */
    assert_int_equal(last.raw, 10000);
}

/* Each of the engine's options reaches it. */
TEST(the_options_of_the_pulse_are_the_drivers)
{
    config.noise_us = 11000;
    assert_int_equal(measure(10000), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(a16.meter.noises, 1);
    config.noise_us = 0;
    config.no_target_us = 9000;
    assert_int_equal(measure(10000), FATHOM_READY);
    assert_int_equal(last.kind, FATHOM_NO_TARGET);
    config.stuck_us = 9500;
    assert_int_equal(measure(10000), FATHOM_READY);
    assert_int_equal(last.kind, FATHOM_FAULT);
    config.no_target_us = config.stuck_us = 0;
    config.cycle_us = 400 * MS;
    config.low_us = 50 * MS;
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
    assert_int_equal(fathom_due_us(&sensor, 1), 2 * MS);
    fake.now_us += 2 * MS;
    fathom_poll(&sensor, &last);
    fake.now_us += 2 * MS;
    fathom_poll(&sensor, &last);
    fake.now_us += 100 * MS;
    assert_int_equal(fathom_due_us(&sensor, 1), 119 * MS);
}

TEST(a_break_triggers_where_there_is_no_pin)
{
    config.trigger = NULL;
    config.uart = &fake.uart;
    start();
    fake.now_us += 2 * MS;
    assert_int_equal(fathom_poll(&sensor, &last), FATHOM_PENDING);
    assert_true(fake.in_break);
    fathom_a16_pwm_deinit(&a16);
    assert_false(fake.in_break);
}

TEST(a_config_that_cannot_work_is_refused)
{
    config.window.min_mm = 16351;
    assert_int_equal(fathom_a16_pwm_init(&a16, &config), FATHOM_ERR_ARGUMENT);
    config.in_air = true;
    assert_int_equal(fathom_a16_pwm_init(&a16, &config), FATHOM_READY);
    config.window.min_mm = 18001;
    assert_int_equal(fathom_a16_pwm_init(&a16, &config), FATHOM_ERR_ARGUMENT);
    config.window.min_mm = 0;
    config.capture = NULL;
    assert_int_equal(fathom_a16_pwm_init(&a16, &config), FATHOM_ERR_ARGUMENT);
}
