/* SPDX-License-Identifier: MIT */
#include <errno.h>

#include "gpio_chip.h"

#include "fathom/sensor/a16_pwm.h"

/*
 * An A16 with PWM on two lines of a chip, by its driver: the trigger's fall at line 17 is answered at line 27 with a
 * pulse 110 ms later (A16 1(1): T1). Simulated time, in steps of 1 ms; the edges' times are to the microsecond.
 */
enum { TRIGGER = 0, ECHO = 1, T1_US = 110000 };

static fathom_gpio_t trigger, echo;
static fathom_pin_t trigger_pin;
static fathom_capture_t capture;
static fathom_clock_t hal_clock;
static fathom_a16_pwm_t sensor;
static fathom_sample_t sample;
static uint64_t now_us;
static uint32_t width_us; /* of the module's responses; 0: none */
static bool never_falls;
static bool was_high;
static uint64_t rise_us, fall_us; /* of the response that is on its way; 0: none */
static unsigned falls;

static uint32_t read_clock(void *ctx) { return (uint32_t)now_us; }

static void module(void)
{
    chip_line_t *const wire = &chip.lines[ECHO];
    const bool is_high = chip.lines[TRIGGER].level;
    if (was_high && !is_high) {
        falls++;
        rise_us = width_us != 0 ? now_us + T1_US : 0;
        fall_us = width_us != 0 ? rise_us + width_us : 0;
    }
    was_high = is_high;
    if (rise_us != 0 && rise_us <= now_us) {
        chip_edge(wire, true, rise_us);
        rise_us = 0;
    }
    if (fall_us != 0 && fall_us <= now_us && !never_falls) {
        chip_edge(wire, false, fall_us);
        fall_us = 0;
    }
}

/* Until the driver says something; the test fails if it does not within a second. */
static fathom_status_t measure(void)
{
    const fathom_sensor_t handle = fathom_a16_pwm_sensor(&sensor);
    for (unsigned steps = 0; steps != 1000; steps++) {
        const fathom_status_t status = fathom_poll(&handle, &sample);
        if (status != FATHOM_PENDING) return status;
        now_us += 1000;
        module();
    }
    fail_msg("nothing within a second");
    return FATHOM_PENDING;
}

static int begins(void **state)
{
    chip_reset();
    now_us = 4294000000u; /* so that the clock wraps within the fifth cycle */
    width_us = 0;
    never_falls = false;
    was_high = true;
    rise_us = 0;
    fall_us = 0;
    falls = 0;
    assert_int_equal(fathom_gpio_open_output(&trigger, "gpiochip0", 17, true), FATHOM_GPIO_OK);
    assert_int_equal(fathom_gpio_open_edges(&echo, "gpiochip0", 27, FATHOM_GPIO_BIAS_AS_IS), FATHOM_GPIO_OK);
    trigger_pin = fathom_gpio_pin(&trigger);
    capture = fathom_gpio_capture(&echo);
    hal_clock.now_us = read_clock;
    const fathom_output_t output = fathom_output_pin(&trigger_pin);
    assert_int_equal(fathom_a16_pwm_init(&sensor, &capture, &hal_clock, &output, NULL), FATHOM_OK);
    return 0;
}

static int ends(void **state)
{
    fathom_gpio_close(&trigger);
    fathom_gpio_close(&echo);
    chip_reset();
    return 0;
}

static const suite_t suite = {.set_up = begins, .tear_down = ends};

/* A16 1: S[cm] = T[us] / 57.5, so mm = us * 4 / 23, rounded. */
TEST(pulses_are_read_to_the_millimetre)
{
    static const struct {
        uint32_t us;
        uint16_t mm;
    } rows[] = {
        {3000, 522},    /*  521.74; the shortest one of the datasheet */
        {10000, 1739},  /* 1739.13; the datasheet's example: 173.9 cm */
        {57500, 10000}, /* 10 m */
        {2875, 500},    /* 50 cm, the end of the blind zone */
        {91999, 16000}, /* 15999.83; one more would still be under "about 94 ms" */
        {23000, 4000},
    };
    for (unsigned i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        width_us = rows[i].us;
        assert_int_equal(measure(), FATHOM_OK);
        assert_int_equal(sample.kind, FATHOM_TARGET);
        assert_int_equal(sample.raw, rows[i].us);
        assert_int_equal(sample.distance_mm, rows[i].mm);
    }
    assert_int_equal(falls, 6);
    assert_true(now_us > UINT32_MAX);
}

TEST(the_pulse_of_94_ms_is_nothing_in_range)
{
    width_us = 94000;
    assert_int_equal(measure(), FATHOM_OK);
    assert_int_equal(sample.kind, FATHOM_NO_TARGET);
}

TEST(a_line_that_stays_high_is_a_fault)
{
    width_us = 3000;
    never_falls = true;
    assert_int_equal(measure(), FATHOM_OK);
    assert_int_equal(sample.kind, FATHOM_FAULT);
    assert_int_equal(sample.raw, 0);
}

TEST(no_pulse_is_no_response)
{
    assert_int_equal(measure(), FATHOM_ERR_NO_RESPONSE);
    width_us = 10000;
    assert_int_equal(measure(), FATHOM_OK);
    assert_int_equal(sample.distance_mm, 1739);
}

TEST(noise_is_rejected_and_counted_and_the_pulse_is_read)
{
    width_us = 10000;
    now_us += 3000;
    module();
    const fathom_sensor_t handle = fathom_a16_pwm_sensor(&sensor);
    assert_int_equal(fathom_poll(&handle, &sample), FATHOM_PENDING); /* the trigger */
    module();
    for (unsigned i = 0; i != 6; i++) { /* spikes of 100 us */
        chip_edge(&chip.lines[ECHO], true, now_us + 1000 * i);
        chip_edge(&chip.lines[ECHO], false, now_us + 1000 * i + 100);
    }
    assert_int_equal(measure(), FATHOM_OK);
    assert_int_equal(sample.distance_mm, 1739);
    assert_int_equal(sensor.meter.noises, 6);
}

TEST(a_pulse_of_which_an_edge_was_lost_is_no_reading)
{
    width_us = 0;
    now_us += 3000;
    const fathom_sensor_t handle = fathom_a16_pwm_sensor(&sensor);
    assert_int_equal(fathom_poll(&handle, &sample), FATHOM_PENDING);
    module();
    chip_edge(&chip.lines[ECHO], true, now_us + 110000);
    chip_lose(&chip.lines[ECHO], false);
    chip_lose(&chip.lines[ECHO], true);
    chip_edge(&chip.lines[ECHO], false, now_us + 150000); /* 40 ms would be 6957 mm */
    assert_int_equal(measure(), FATHOM_ERR_NO_RESPONSE);
    assert_int_equal(echo.lost_events, 2);
    width_us = 10000;
    assert_int_equal(measure(), FATHOM_OK);
    assert_int_equal(sample.distance_mm, 1739);
}

TEST(a_chip_that_goes_in_mid_run_is_a_broken_port)
{
    width_us = 10000;
    assert_int_equal(measure(), FATHOM_OK);
    chip.read_error = ENODEV;
    assert_int_equal(measure(), FATHOM_ERR_PORT);
    assert_int_equal(fathom_gpio_error(&echo), FATHOM_GPIO_ERR_LOST);

    chip.read_error = 0;
    fathom_gpio_close(&trigger);
    fathom_gpio_close(&echo);
    (void)begins(NULL);
    width_us = 23000;
    assert_int_equal(measure(), FATHOM_OK);
    assert_int_equal(sample.distance_mm, 4000);
}
