/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* the tty's flags, and what Linux has besides */
#include <poll.h>
#include <stdlib.h>
#include <string.h>

#include "fathom/fathom.h"
#include "fathom_gpio.h"
#include "fathom_loop.h"
#include "fathom_posix.h"
#include "guest.h"

/* port/gpio on a PL061 of 8 lines, whose levels test_virt.py sets and sees. */

#define CHIP "gpiochip0"
enum { RELAY = 2, CONTACT = 4, ECHO = 5, TRIGGER = 6, LINES = 8 };

static fathom_gpio_t trigger, echo;

static fathom_pin_t open_output(fathom_gpio_t *gpio, uint32_t line, bool high)
{
    if (fathom_gpio_open_output(gpio, CHIP, line, high) != FATHOM_GPIO_OK)
        guest_fail(__FILE__, __LINE__, "%s", fathom_gpio_error_text(gpio));
    return fathom_gpio_pin(gpio);
}

static fathom_pin_t open_edges(fathom_gpio_t *gpio, uint32_t line)
{
    if (fathom_gpio_open_edges(gpio, CHIP, line, FATHOM_GPIO_BIAS_AS_IS) != FATHOM_GPIO_OK)
        guest_fail(__FILE__, __LINE__, "%s", fathom_gpio_error_text(gpio));
    return fathom_gpio_pin(gpio);
}

static bool is_readable(const fathom_gpio_t *gpio, int ms)
{
    struct pollfd one = {fathom_gpio_fd(gpio), POLLIN, 0};
    return poll(&one, 1, ms) == 1;
}

/* ---- levels ---- */

GUEST_CASE(an_output_has_its_level_from_the_beginning)
{
    fathom_pin_t pin = open_output(&trigger, TRIGGER, true);
    CHECK_INT(guest_ask("level %d", TRIGGER), 1);
    pin.set(pin.ctx, false);
    CHECK_INT(guest_ask("level %d", TRIGGER), 0);
    pin.set(pin.ctx, true);
    CHECK_INT(guest_ask("level %d", TRIGGER), 1);
    fathom_gpio_close(&trigger);
    (void)open_output(&trigger, TRIGGER, false);
    CHECK_INT(guest_ask("level %d", TRIGGER), 0);
}

GUEST_CASE(an_input_has_the_level_of_the_wire)
{
    static fathom_gpio_t input;
    CHECK_INT(fathom_gpio_open_input(&input, CHIP, CONTACT, FATHOM_GPIO_BIAS_AS_IS), FATHOM_GPIO_OK);
    const fathom_pin_t pin = fathom_gpio_pin(&input);
    for (int level = 1; level >= 0; level--) {
        (void)guest_ask("set %d %d", CONTACT, level);
        CHECK_INT(pin.get(pin.ctx), level);
    }
}

GUEST_CASE(an_edge_wakes_a_program_that_sleeps)
{
    const fathom_pin_t pin = open_edges(&echo, ECHO);
    CHECK(!is_readable(&echo, 20));
    (void)guest_ask("set %d 1", ECHO);
    CHECK(is_readable(&echo, 1000));
    CHECK(pin.get(pin.ctx));
    CHECK(!is_readable(&echo, 20)); /* it was taken */
    (void)guest_ask("set %d 0", ECHO);
    CHECK(is_readable(&echo, 1000));
    CHECK(!pin.get(pin.ctx));
}

/* ---- who has a line ---- */

static int open_it(void *ctx)
{
    static fathom_gpio_t other;
    (void)ctx;
    return -(int)fathom_gpio_open_input(&other, CHIP, CONTACT, FATHOM_GPIO_BIAS_AS_IS);
}

GUEST_CASE(a_line_is_had_by_one_program)
{
    static fathom_gpio_t second;
    (void)open_edges(&echo, CONTACT);
    CHECK_INT(fathom_gpio_open_edges(&second, CHIP, CONTACT, FATHOM_GPIO_BIAS_AS_IS), FATHOM_GPIO_ERR_IN_USE);
    CHECK_SAYS(fathom_gpio_error_text(&second), "fathom");
    CHECK_INT(fathom_gpio_fd(&second), -1);
    CHECK_INT(guest_other_process(0, open_it, NULL), -FATHOM_GPIO_ERR_IN_USE);
    fathom_gpio_close(&echo);
    CHECK_INT(guest_other_process(0, open_it, NULL), 0);
}

GUEST_CASE(what_is_not_there_is_told_apart)
{
    CHECK_INT(fathom_gpio_open_input(&echo, CHIP, LINES, FATHOM_GPIO_BIAS_AS_IS), FATHOM_GPIO_ERR_NO_LINE);
    CHECK_SAYS(fathom_gpio_error_text(&echo), "the lines 0 to 7");
    CHECK_INT(fathom_gpio_open_input(&echo, CHIP, UINT32_MAX, FATHOM_GPIO_BIAS_AS_IS),
              FATHOM_GPIO_ERR_NO_LINE);
    CHECK_INT(fathom_gpio_open_input(&echo, "gpiochip1", 0, FATHOM_GPIO_BIAS_AS_IS),
              FATHOM_GPIO_ERR_NOT_FOUND);
    CHECK_INT(fathom_gpio_open_input(&echo, "/dev/null", 0, FATHOM_GPIO_BIAS_AS_IS),
              FATHOM_GPIO_ERR_NOT_A_CHIP);
    CHECK_INT(fathom_gpio_open_input(&echo, "ttyAMA0", 0, FATHOM_GPIO_BIAS_AS_IS),
              FATHOM_GPIO_ERR_NOT_A_CHIP);
    CHECK_INT(guest_other_process(1000, open_it, NULL), -FATHOM_GPIO_ERR_PERMISSION);
}

/* ---- A16 with PWM output ---- */

static fathom_pin_t trigger_pin;
static fathom_capture_t capture;
static fathom_clock_t clock_of_system;
static fathom_a16_pwm_t tank;

static fathom_sensor_t begin_tank(void)
{
    (void)guest_ask("set %d 0", ECHO);
    trigger_pin = open_output(&trigger, TRIGGER, true);
    (void)open_edges(&echo, ECHO);
    capture = fathom_gpio_capture(&echo);
    clock_of_system = fathom_posix_clock();
    const fathom_output_t output = fathom_output_pin(&trigger_pin);
    CHECK_INT(fathom_a16_pwm_init(&tank, &capture, &clock_of_system, &output, NULL), FATHOM_OK);
    return fathom_a16_pwm_sensor(&tank);
}

static void sleep_on_echo(void *ctx, uint32_t max_us)
{
    (void)ctx;
    (void)is_readable(&echo, (int)(max_us / 1000u) + 1);
}

static fathom_status_t wait_for(const fathom_sensor_t *sensor, fathom_sample_t *sample)
{
    memset(sample, 0, sizeof *sample);
    return fathom_wait(sensor, sample, sleep_on_echo, NULL);
}

static int by_size(const void *a, const void *b) { return (int)(*(const long *)a - *(const long *)b); }

/* Takes five readings and returns by how much the second best differs from what was played, because the machine may be
 * busy. Between the readings, errors of the kind `allowed` and readings without a distance are accepted; with FATHOM_OK,
 * none is. */
static long difference_us(const fathom_sensor_t *sensor, fathom_status_t allowed)
{
    enum { READINGS = 5, MOST_CYCLES = 20 };
    long off[READINGS];
    int readings = 0;
    for (int cycles = 0; readings != READINGS; cycles++) {
        fathom_sample_t sample;
        const fathom_status_t status = wait_for(sensor, &sample);
        CHECK(cycles != MOST_CYCLES);
        if (status == allowed && status != FATHOM_OK) continue;
        CHECK_INT(status, FATHOM_OK);
        /* If the long pulse was missed among bounces, only the short ones are left, and they have no distance. */
        if (allowed != FATHOM_OK && sample.kind == FATHOM_UNKNOWN) continue;
        CHECK_INT(sample.kind, FATHOM_TARGET);
        CHECK_INT(sample.distance_mm, (sample.raw * 4 + 11) / 23); /* us * 4 / 23, rounded */
        off[readings++] = labs((long)sample.raw - guest_ask("width %lu", (unsigned long)sample.raw));
    }
    qsort(off, READINGS, sizeof off[0], by_size);
    return off[1];
}

GUEST_CASE(an_a16_is_triggered_and_measured)
{
    const fathom_sensor_t sensor = begin_tank();
    (void)guest_ask("a16 pulse 20");
    (void)guest_ask("listen");
    CHECK_WITHIN(difference_us(&sensor, FATHOM_OK), 0, 3000);
    (void)guest_ask("triggered 5"); /* at least so often, and as the datasheet wants it */
    CHECK_INT(echo.lost_events, 0);
    CHECK_INT(fathom_a16_pwm_deinit(&tank), FATHOM_OK);
    CHECK_INT(guest_ask("level %d", TRIGGER), 1);
}

GUEST_CASE(a_pulse_whose_edges_bounce_is_measured)
{
    const fathom_sensor_t sensor = begin_tank();
    (void)guest_ask("a16 bounce 20");
    /* An edge that came too soon after another one may be missed: then there is no width, and none is made up. */
    CHECK_WITHIN(difference_us(&sensor, FATHOM_ERR_NO_RESPONSE), 0, 3000);
    CHECK_WITHIN(echo.events, 20, 1000); /* 10 edges in 5 cycles without */
    CHECK_WITHIN(tank.meter.noises, 5, 100);
}

GUEST_CASE(a_line_that_stays_high_is_a_fault)
{
    fathom_sample_t sample;
    const fathom_sensor_t sensor = begin_tank();
    (void)guest_ask("a16 high 0");
    for (int i = 0; i != 2; i++) {
        CHECK_INT(wait_for(&sensor, &sample), FATHOM_OK);
        CHECK_INT(sample.kind, FATHOM_FAULT);
        CHECK_INT(sample.raw, 0);
    }
    (void)guest_ask("a16 nothing 0");
    (void)guest_ask("set %d 0", ECHO);
    while (wait_for(&sensor, &sample) == FATHOM_OK)
        CHECK_INT(sample.kind, FATHOM_FAULT); /* of the cycle that ran */
    (void)guest_ask("a16 pulse 20");
    while (wait_for(&sensor, &sample) != FATHOM_OK) continue;
    CHECK_INT(sample.kind, FATHOM_TARGET);
}

GUEST_CASE(no_pulse_is_no_response)
{
    fathom_sample_t sample;
    const fathom_sensor_t sensor = begin_tank();
    (void)guest_ask("a16 nothing 0");
    for (int i = 0; i != 2; i++) CHECK_INT(wait_for(&sensor, &sample), FATHOM_ERR_NO_RESPONSE);
}

GUEST_CASE(edges_that_the_queue_dropped_are_counted_and_make_no_pulse)
{
    fathom_pulse_t pulse;
    unsigned pulses = 0;
    (void)guest_ask("a16 nothing 0");
    (void)guest_ask("set %d 0", ECHO);
    (void)open_edges(&echo, ECHO);
    capture = fathom_gpio_capture(&echo);
    capture.arm(capture.ctx);
    (void)guest_ask("set %d 1", ECHO);
    CHECK(is_readable(&echo, 1000));
    CHECK_INT(capture.take(capture.ctx, &pulse), 0); /* it has begun */

    /* Down and up 35 times: low for 8 ms, high for 2, or what a busy machine makes of it. Of 70 edges the kernel keeps
     * the last 64, of which the oldest is a fall: it ends a pulse whose rise was dropped, and not the one that has
     * begun, which would be 38 ms wide. 31 pulses follow, unless two edges were so near that they came as one. */
    (void)guest_ask("pulses 35 8 2");
    guest_sleep_ms(50);
    for (;;) {
        memset(&pulse, 0, sizeof pulse);
        const int taken = capture.take(capture.ctx, &pulse);
        CHECK(taken >= 0);
        if (taken == 0) break;
        CHECK_WITHIN(pulse.width_us, 200, 25000);
        pulses++;
    }
    CHECK(pulse.is_high);
    CHECK_INT(echo.events, 1 + FATHOM_GPIO_QUEUE);
    CHECK_WITHIN(echo.lost_events, 1, 70 - FATHOM_GPIO_QUEUE);
    CHECK_WITHIN(pulses, 20, 31);

    (void)guest_ask("set %d 0", ECHO); /* and it goes on */
    capture.arm(capture.ctx);
    (void)guest_ask("pulses 1 8 20");
    (void)guest_ask("set %d 0", ECHO);
    guest_sleep_ms(50);
    CHECK_INT(capture.take(capture.ctx, &pulse), 1);
    CHECK_WITHIN(pulse.width_us, 15000, 200000);
}

static struct {
    fathom_loop_t loop;
    fathom_loop_pin_t pin;
    fathom_loop_sensor_t sensor;
    int readings;
} rig;

static void take(void *ctx, fathom_status_t status, const fathom_sample_t *sample)
{
    (void)ctx;
    CHECK_INT(status, FATHOM_OK);
    CHECK_INT(sample->kind, FATHOM_TARGET);
    rig.readings++;
    if (rig.readings == 3) fathom_loop_stop(&rig.loop);
}

GUEST_CASE(the_loop_reads_a_pin)
{
    CHECK_INT(fathom_loop_init(&rig.loop, NULL), FATHOM_POSIX_OK);
    rig.sensor.sensor = begin_tank();
    rig.sensor.take = take;
    (void)guest_ask("a16 pulse 20");
    fathom_loop_add_pin(&rig.loop, &rig.pin, fathom_gpio_fd(&echo));
    fathom_loop_add_sensor(&rig.pin.source, &rig.sensor);
    const uint64_t began_us = fathom_posix_now_us();
    fathom_loop_run(&rig.loop);
    /* The third pulse ends 25 ms after its trigger, the cycles are of 221 ms: it does not wait for the end of one. */
    CHECK_WITHIN(fathom_posix_now_us() - began_us, 2 * 221000, 3 * 221000 - 20000);
    fathom_loop_deinit(&rig.loop);
}

/* ---- contacts ---- */

GUEST_CASE(a_switch_is_read)
{
    static fathom_a16_switch_t level;
    fathom_sample_t sample;
    (void)guest_ask("set %d 1", CONTACT);
    const fathom_pin_t pin = open_edges(&echo, CONTACT);
    clock_of_system = fathom_posix_clock();
    CHECK_INT(fathom_a16_switch_init(&level, &pin, &clock_of_system, NULL), FATHOM_OK);
    const fathom_sensor_t sensor = fathom_a16_switch_sensor(&level);
    CHECK_INT(wait_for(&sensor, &sample), FATHOM_OK);
    CHECK_INT(sample.kind, FATHOM_NEAR); /* high, A16 4(2) */
    (void)guest_ask("bounce %d 0", CONTACT);
    CHECK_INT(wait_for(&sensor, &sample), FATHOM_OK);
    CHECK_INT(sample.kind, FATHOM_FAR);
}

GUEST_CASE(a_relay_is_read)
{
    static fathom_a05_relay_t relay;
    fathom_sample_t sample;
    (void)guest_ask("set %d 1", RELAY);
    const fathom_pin_t pin = open_edges(&echo, RELAY);
    clock_of_system = fathom_posix_clock();
    CHECK_INT(fathom_a05_relay_init(&relay, &pin, &clock_of_system, NULL), FATHOM_OK);
    const fathom_sensor_t sensor = fathom_a05_relay_sensor(&relay);
    CHECK_INT(wait_for(&sensor, &sample), FATHOM_OK);
    CHECK_INT(sample.kind, FATHOM_FAR); /* its contact is open and the pin pulled up */
    (void)guest_ask("bounce %d 0", RELAY);
    CHECK_INT(wait_for(&sensor, &sample), FATHOM_OK);
    CHECK_INT(sample.kind, FATHOM_NEAR);
}

/* ---- the tool ---- */

GUEST_CASE(the_tool_reads_pins)
{
    static char out[4000];
    (void)guest_ask("a16 pulse 20");
    CHECK_INT(guest_tool("read a16:pwm@" CHIP ",trigger=6,echo=5 --count 3 --format csv", out, sizeof out),
              0);
    CHECK_SAYS(out, ",target,");
    (void)guest_ask("set %d 1", CONTACT);
    CHECK_INT(guest_tool("read a16:switch@" CHIP ",in=4 --count 1 --format csv", out, sizeof out), 0);
    CHECK_SAYS(out, ",near,");
    (void)open_edges(&echo, CONTACT);
    CHECK_INT(guest_tool("read a16:switch@" CHIP ",in=4 --count 1 --format csv", out, sizeof out), 1);
    CHECK_SAYS(out, "in use by \"fathom\"");
}
