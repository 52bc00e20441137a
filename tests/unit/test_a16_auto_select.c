/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "auto_rig.h"
#include "fake_pin.h"
#include "fathom/a16_auto.h"

/* Which value a module with automatic UART output sends: its RX pin high or open, the processed one; low, the
 * real-time one (A16 2(2)). */

static fathom_a16_auto_config_t config;
static fathom_a16_auto_t a16;
static fake_pin_t pin;

static int set_up(void **state)
{
    rig_start(RIG_START_US);
    fake_pin_init(&pin, &rig.fake);
    memset(&config, 0, sizeof config);
    memset(&a16, 0x5A, sizeof a16);
    config.line = &rig.line;
    return 0;
}

static const suite_t suite = {.set_up = set_up};

TEST(by_default_nothing_is_driven)
{
    rig.fake.uart.set_break = NULL;
    assert_int_equal(fathom_a16_auto_init(&a16, &config), FATHOM_READY);
    fathom_a16_auto_deinit(&a16);
    assert_int_equal(rig.fake.breaks, 0);
    assert_int_equal(pin.sets, 0);
}

TEST(a_pin_is_driven_at_init_and_when_told)
{
    config.select = &pin.trigger;
    assert_int_equal(fathom_a16_auto_init(&a16, &config), FATHOM_READY);
    assert_true(pin.level);
    config.real_time = true;
    assert_int_equal(fathom_a16_auto_init(&a16, &config), FATHOM_READY);
    assert_false(pin.level);
    assert_int_equal(fathom_a16_auto_select(&a16, false), FATHOM_READY);
    assert_true(pin.level);
    assert_int_equal(fathom_a16_auto_select(&a16, true), FATHOM_READY);
    assert_false(pin.level);
    fathom_a16_auto_deinit(&a16);
    assert_int_equal(rig.fake.breaks, 0);
    assert_null(rig.line.listener);
}

TEST(without_a_pin_a_break_selects_until_deinit)
{
    config.real_time = true;
    assert_int_equal(fathom_a16_auto_init(&a16, &config), FATHOM_READY);
    assert_true(rig.fake.in_break);
    assert_int_equal(fathom_a16_auto_select(&a16, false), FATHOM_READY);
    assert_false(rig.fake.in_break);
    assert_int_equal(fathom_a16_auto_select(&a16, true), FATHOM_READY);
    fathom_a16_auto_deinit(&a16);
    assert_false(rig.fake.in_break);
    assert_null(rig.line.listener);
}

TEST(frames_are_read_in_a_break)
{
    static const uint8_t mm_1953[] = {0xFF, 0x07, 0xA1, 0xA7}; /* A16 2(4) */
    config.real_time = true;
    assert_int_equal(fathom_a16_auto_init(&a16, &config), FATHOM_READY);
    rig.sensor = fathom_a16_auto_sensor(&a16);
    rig_send(mm_1953, 4, 500);
    assert_true(rig.fake.in_break);
    assert_int_equal(rig.sample.distance_mm, 1953);
}

TEST(a_port_that_cannot_is_said_by_init_and_nothing_listens)
{
    config.real_time = true;
    rig.fake.never_sent = true;
    assert_int_equal(fathom_a16_auto_init(&a16, &config), FATHOM_ERR_BUSY);
    assert_null(rig.line.listener);
    rig.fake.uart.set_break = NULL;
    assert_int_equal(fathom_a16_auto_init(&a16, &config), FATHOM_ERR_UNSUPPORTED);
    assert_null(rig.line.listener);
    config.real_time = false;
    assert_int_equal(fathom_a16_auto_init(&a16, &config), FATHOM_READY);
    assert_int_equal(fathom_a16_auto_select(&a16, true), FATHOM_ERR_UNSUPPORTED);
}

TEST(a_selection_that_failed_has_changed_nothing)
{
    assert_int_equal(fathom_a16_auto_init(&a16, &config), FATHOM_READY);
    rig.fake.never_sent = true;
    assert_int_equal(fathom_a16_auto_select(&a16, true), FATHOM_PENDING);
    assert_false(a16.real_time);
    rig.fake.never_sent = false;
    assert_int_equal(fathom_a16_auto_select(&a16, true), FATHOM_READY);
    assert_true(a16.real_time);
}
