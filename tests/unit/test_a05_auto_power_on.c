/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "auto_rig.h"
#include "fathom/a05_auto.h"

/* A05 1(1): the level of RX in the first second after power-on chooses what is sent. */

enum { LOW_US = 1500000 };

static fathom_a05_auto_t a05;
static bool pin_is_high;
static unsigned pin_sets;

static const uint8_t example[] = {0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x60};

static void set_pin(void *ctx, bool high)
{
    (void)ctx;
    pin_is_high = high;
    pin_sets++;
}

static const fathom_pin_t pin = {set_pin, NULL, NULL};

static void start_at(uint32_t now_us, const fathom_pin_t *select)
{
    rig_start(now_us);
    const fathom_a05_auto_config_t config = {.line = &rig.line, .select = select};
    memset(&a05, 0x5A, sizeof a05);
    assert_int_equal(fathom_a05_auto_init(&a05, &config), FATHOM_READY);
    rig.sensor = fathom_a05_auto_sensor(&a05);
    pin_is_high = true;
    pin_sets = 0;
}

static bool is_low(const fathom_pin_t *select) { return select != NULL ? !pin_is_high : rig.fake.in_break; }

TEST(rx_is_low_for_a_second_and_a_half_for_real_time_values)
{
    static const uint32_t starts_us[] = {1000, 0xFFFFFFFFu - 700000};
    for (unsigned i = 0; i != 4; i++) {
        const fathom_pin_t *const select = i % 2 == 0 ? &pin : NULL;
        start_at(starts_us[i / 2], select);
        rig_run(10000, 1000); /* the silence that begins a frame has been seen */
        assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_REAL_TIME), FATHOM_READY);
        assert_true(is_low(select));
        assert_int_equal(rig.sensor.due_us(rig.sensor.ctx), LOW_US);
        rig_run(LOW_US - 1000, 1000);
        assert_true(is_low(select));
        assert_int_equal(rig.sensor.due_us(rig.sensor.ctx), 1000);
        rig_run(1000, 1000);
        assert_false(is_low(select));
        assert_true(rig.sensor.due_us(rig.sensor.ctx) > 1000);
    }
}

TEST(rx_is_high_for_processed_values)
{
    start_at(RIG_START_US, NULL);
    assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_PROCESSED), FATHOM_READY);
    assert_int_equal(rig.fake.breaks, 0);
    start_at(RIG_START_US, &pin);
    pin_is_high = false;
    assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_PROCESSED), FATHOM_READY);
    assert_true(pin_is_high);
}

TEST(a_second_power_on_begins_anew)
{
    start_at(RIG_START_US, NULL);
    assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_REAL_TIME), FATHOM_READY);
    rig_run(1000000, 1000);
    assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_REAL_TIME), FATHOM_READY);
    rig_run(1000000, 1000);
    assert_true(rig.fake.in_break);
    assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_PROCESSED), FATHOM_READY);
    assert_false(rig.fake.in_break);
}

TEST(the_deadline_for_a_frame_begins_with_power_and_what_came_before_is_forgotten)
{
    start_at(RIG_START_US, NULL);
    rig_run(1900000, 1000);
    assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_PROCESSED), FATHOM_READY);
    rig_run(1999000, 1000);
    assert_int_equal(rig.stales, 0);
    rig_run(1000, 1000);
    assert_int_equal(rig.stales, 1);
    rig_send(example, sizeof example, 500);
    assert_int_equal(rig.samples, 4);
}

TEST(a_port_that_cannot_is_said_and_a_pin_helps)
{
    start_at(RIG_START_US, NULL);
    rig.fake.uart.set_break = NULL;
    assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_REAL_TIME), FATHOM_ERR_UNSUPPORTED);
    assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_PROCESSED), FATHOM_READY);
    start_at(RIG_START_US, &pin);
    rig.fake.uart.set_break = NULL;
    assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_REAL_TIME), FATHOM_READY);
    assert_int_equal(pin_sets, 1);
}

TEST(a_line_that_sends_is_busy_and_another_value_is_none)
{
    start_at(RIG_START_US, NULL);
    rig.fake.busy_until_us = rig.fake.now_us + 1000;
    assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_REAL_TIME), FATHOM_ERR_BUSY);
    assert_false(rig.fake.in_break);
    rig.fake.now_us += 1000;
    assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_REAL_TIME), FATHOM_READY);
    assert_int_equal(fathom_a05_auto_power_on(&a05, (fathom_a05_value_t)2), FATHOM_ERR_ARGUMENT);
}

TEST(who_stops_listening_lets_rx_go)
{
    start_at(RIG_START_US, NULL);
    assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_REAL_TIME), FATHOM_READY);
    fathom_a05_auto_deinit(&a05);
    assert_false(rig.fake.in_break);
    assert_null(rig.line.listener);
    fathom_a05_auto_deinit(&a05);
    assert_int_equal(rig.fake.breaks, 1);
}

TEST(in_a_slow_loop_rx_is_low_for_longer_and_never_for_less)
{
    start_at(RIG_START_US, NULL);
    assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_REAL_TIME), FATHOM_READY);
    rig_run(1480000, 20000);
    assert_true(rig.fake.in_break);
    rig.fake.now_us += 100000; /* one turn that takes longer */
    assert_int_equal(rig.sensor.due_us(rig.sensor.ctx), 0);
    (void)rig_poll();
    assert_false(rig.fake.in_break);
}
