/* SPDX-License-Identifier: MIT */
#include "drivers.h"
#include "fake_pin.h"
#include "fathom/sensor/a16_pwm.h"

/* What widths mean; test_driver_contract.c has the rest. */

static fake_t fake;
static fake_pin_t pin;
static fathom_a16_pwm_config_t config;
static fathom_model_facts_t model;
static fathom_output_t output;
static fathom_a16_pwm_t a16;
static fathom_sensor_t sensor;
static fathom_sample_t last;
static uint32_t after_us; /* the trigger the pulse begins */

static void start(void)
{
    fake_init(&fake);
    fake_pin_init(&pin, &fake);
    pin.response_after_us = after_us;
    memset(&a16, 0x5A, sizeof a16);
    assert_int_equal(fathom_a16_pwm_init(&a16, &pin.capture, &fake.clock, &output, &config), FATHOM_OK);
    sensor = fathom_a16_pwm_sensor(&a16);
}

static int set_up(void **state)
{
    output = fathom_output_pin(&pin.trigger);
    model = fathom_a16_pwm_model;
    config = (fathom_a16_pwm_config_t){.model = &model};
    after_us = 110 * MS;
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
    model.min_mm = 1739;
    model.max_mm = 1740;
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

/* width * 100 / 575: 2700 us are 469.6 mm, 91999 us are 15999.8; 382.81 m/s * 45.9995 ms = 17609.1. */
TEST(the_whole_range_is_accepted_by_default)
{
    reads(2700, FATHOM_TARGET, 470);
    reads(91999, FATHOM_TARGET, 16000);
    config.in_air = true;
    config.air_dc = 850;
    reads(91999, FATHOM_TARGET, 17609);
    config.model = NULL;
    reads(91999, FATHOM_TARGET, 17609);
    reads(92000, FATHOM_NO_TARGET, 0);
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

/* "three quarters of the pulse of min_mm, but 100 to 2700": min_mm * us_per_dm / 128. 300 * 575 / 128 = 1347.7, 20 * 580 /
 * 128 = 90.6; 600 * 575 / 128 = 2695.3, 601 mm would be 2699.8 and 602 mm 2704.3. */
TEST(pulses_below_the_blind_zone_are_noise)
{
    static const struct {
        uint16_t min_mm, us_per_dm, noise_us;
    } rows[] = {{0, 575, 2700},   {300, 575, 1347}, {20, 580, 100},
                {600, 575, 2695}, {602, 575, 2700}, {15000, 575, 2700}};
    for (unsigned i = 0; i != COUNT(rows); i++) {
        model.min_mm = rows[i].min_mm;
        model.us_per_dm = rows[i].us_per_dm;
        start();
        assert_int_equal(a16.meter.noise_us, rows[i].noise_us);
    }
}

/* HC-SR04: a high pulse of 10 us or more, 58 us for each cm, 20 to 4000 mm, 38 ms without an echo. 116 us are 20 mm, 23200
 * us 4000 mm; 36 to 49 ms mean that nothing is in range. */
TEST(a_relative_has_its_own_trigger_scale_range_and_pulse_without_an_echo)
{
    model = (fathom_model_facts_t){.min_mm = 20,
                                   .max_mm = 4000,
                                   .period_ms = 60,
                                   .trigger_us = 20,
                                   .us_per_dm = 580,
                                   .start = FATHOM_STARTS_HIGH_PULSE,
                                   .no_target_ms = 38};
    after_us = 1 * MS;
    reads(116, FATHOM_TARGET, 20);
    reads(23200, FATHOM_TARGET, 4000);
    measures(110, FATHOM_ERR_MALFORMED);   /* 18.97 */
    measures(23203, FATHOM_ERR_MALFORMED); /* 4000.52 */
    measures(35999, FATHOM_ERR_MALFORMED);
    reads(36000, FATHOM_NO_TARGET, 0);
    reads(49000, FATHOM_NO_TARGET, 0);
    reads(49001, FATHOM_FAULT, 0);
}

/* fathom_output_inverted_pin(): low between the triggers, and high for `trigger_us`. */
TEST(an_inverted_pin_makes_high_pulses_and_rests_low)
{
    output = fathom_output_inverted_pin(&pin.trigger);
    model.trigger_us = 5000;
    model.period_ms = 110;
    start();
    assert_int_equal(pin.sets, 1);
    assert_false(pin.level);
    fake.now_us += 5000;
    assert_int_equal(checked_poll(&sensor, &last), FATHOM_PENDING);
    assert_true(pin.level);
    fake.now_us += 4999;
    assert_int_equal(checked_poll(&sensor, &last), FATHOM_PENDING);
    assert_true(pin.level);
    fake.now_us += 1;
    assert_int_equal(checked_poll(&sensor, &last), FATHOM_PENDING);
    assert_false(pin.level);
    fake.now_us += 105 * MS;
    assert_int_equal(checked_poll(&sensor, &last), FATHOM_ERR_NO_RESPONSE);
    assert_true(pin.level); /* the next trigger, 110 ms after the first */
    assert_int_equal(fathom_a16_pwm_deinit(&a16), FATHOM_OK);
    assert_false(pin.level);
}

/* JSN-SR04T V3.x mode 3: a pulse each 200 ms, without a trigger. Pulses of 5 ms are 870 mm (869.6). */
TEST(each_pulse_of_a_module_without_a_trigger_is_a_sample_whenever_it_was_armed)
{
    output = fathom_output_none();
    model.start = FATHOM_STARTS_ALONE;
    model.period_ms = 200;
    for (uint32_t offset_us = 0; offset_us < 210 * MS; offset_us += 2500) {
        unsigned samples = 0;
        start();
        fake_pulse(&pin, 0, offset_us + 1); /* in progress when the meter is armed, or not */
        fake.now_us += offset_us;
        for (uint32_t us = 0; us != 3000 * MS; us += 1 * MS) {
            if (us % (200 * MS) == 0) fake_pulse(&pin, 10 * MS, 5 * MS);
            fake.now_us += 1 * MS;
            const fathom_status_t status = checked_poll(&sensor, &last);
            if (status == FATHOM_PENDING || last.raw != 5 * MS) continue;
            samples++;
            is(status, FATHOM_TARGET, 5000, 870);
            assert_int_equal(last.time_us, fake.now_us);
        }
        assert_in_range(samples, 14, 15);
        assert_int_equal(pin.sets, 0);
    }
}

/* "without one for two periods fathom_poll() returns FATHOM_ERR_NO_RESPONSE" */
TEST(a_module_without_a_trigger_that_is_silent_is_reported_after_two_periods)
{
    output = fathom_output_none();
    model.start = FATHOM_STARTS_ALONE;
    model.period_ms = 200;
    config.period_us = 1; /* less than two periods */
    start();
    for (unsigned polls = 0; polls != 2; polls++) { /* the begin and the end of the trigger */
        fake.now_us += 2 * MS;
        assert_int_equal(checked_poll(&sensor, &last), FATHOM_PENDING);
    }
    fake.now_us += 398 * MS - 1;
    assert_int_equal(checked_poll(&sensor, &last), FATHOM_PENDING);
    fake.now_us += 1;
    assert_int_equal(checked_poll(&sensor, &last), FATHOM_ERR_NO_RESPONSE);
    config.period_us = 700 * MS;
    start();
    assert_int_equal(a16.meter.trigger.period_us, 700 * MS);
}

/* Without a fixed pulse, every pulse up to the period is a distance: of 150 ms at 575 us, 26087 mm. */
TEST(a_model_without_a_fixed_pulse_has_distances_only)
{
    after_us = 10 * MS;
    model.no_target_ms = 0;
    measures(92000, FATHOM_OK);
    assert_int_equal(last.kind, FATHOM_TARGET);
    measures(150 * MS, FATHOM_ERR_MALFORMED);
    assert_int_equal(last.kind, FATHOM_TARGET);
}

TEST(the_period_is_that_of_the_model_or_longer)
{
    static const struct {
        uint16_t period_ms;
        uint32_t period_us, is_us;
    } rows[] = {{221, 0, 221 * MS},    {221, 1, 221 * MS}, {221, 400 * MS, 400 * MS}, {110, 0, 110 * MS},
                {110, 110001, 110001}, {0, 0, 221 * MS},   {0, 300 * MS, 300 * MS}};
    for (unsigned i = 0; i != COUNT(rows); i++) {
        model.period_ms = rows[i].period_ms;
        model.trigger_us = 50000;
        config.period_us = rows[i].period_us;
        start();
        for (unsigned ms = 0; ms != 2000; ms++) {
            fake.now_us += 1 * MS;
            fathom_poll(&sensor, &last);
        }
        assert_in_range(pin.least_us, rows[i].is_us, rows[i].is_us + 1 * MS);
        assert_int_equal(pin.low_us, 50 * MS);
    }
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
