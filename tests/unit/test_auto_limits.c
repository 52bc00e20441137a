/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"

#include <string.h>

#include "suite.h"

#include "fake_pin.h"
#include "fathom/engine/line_pins.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/sensor/a05_auto.h"
#include "fathom/sensor/a16_auto.h"

/* a05_auto.h and a16_auto.h: what selects a value is driven when it has to be, and let go where it was taken. */

static fathom_uart_t uart; /* of the line; it counts what is done to its TX */
static unsigned set_breaks;
static fake_pin_t pin;
static fathom_a05_auto_t a05;
static fathom_a16_auto_t a16;

static int counted_set_break(void *ctx, bool on)
{
    set_breaks++;
    return rig.fake.uart.set_break(ctx, on);
}

static int set_up(void **state)
{
    rig_start(RIG_START_US);
    uart = rig.fake.uart;
    uart.set_break = counted_set_break;
    rig.line_parts.uart = &uart;
    set_breaks = 0;
    fake_pin_init(&pin, &rig.fake);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* What drives RX: the pin, or a break. */
static fathom_output_t select_by(bool pin_does)
{
    return pin_does ? fathom_output_pin(&pin.trigger) : fathom_output_line_break(&rig.line);
}

static void start_a05(bool by_pin)
{
    const fathom_a05_auto_config_t config = {.select = select_by(by_pin)};
    memset(&a05, 0xFF, sizeof a05);
    assert_int_equal(fathom_a05_auto_init(&a05, &rig.line, &config), FATHOM_OK);
    rig.sensor = fathom_a05_auto_sensor(&a05);
}

static void start_a16(uint8_t fill, bool by_pin, uint32_t stale_us)
{
    const fathom_a16_auto_config_t config = {.select = select_by(by_pin), .stale_us = stale_us};
    memset(&a16, fill, sizeof a16);
    assert_int_equal(fathom_a16_auto_init(&a16, &rig.line, &config), FATHOM_OK);
    rig.sensor = fathom_a16_auto_sensor(&a16);
}

static fathom_status_t poll_after(uint32_t us)
{
    rig.fake.now_us += us;
    return rig_poll();
}

static uint32_t due_us(void) { return rig.sensor.due_us(rig.sensor.ctx); }

/* ---- A05 ---- */

/* "FATHOM_ERR_ARGUMENT: no such value": not 256 either, where an enumeration can hold it at all. */
TEST(a_value_of_256_is_refused)
{
    start_a05(false);
    if (sizeof(fathom_dyp_value_t) == 1) return;
    assert_int_equal(fathom_a05_auto_select(&a05, (fathom_dyp_value_t)256), FATHOM_ERR_ARGUMENT);
}

/* FATHOM_A05_SELECT_US, some time after the last poll too. */
TEST(the_end_of_selecting_is_due_after_1500_ms)
{
    start_a05(false);
    assert_int_equal(fathom_a05_auto_select(&a05, FATHOM_REAL_TIME), FATHOM_OK);
    assert_int_equal(due_us(), RIG_GAP_US); /* before that the line is to see a silence */
    assert_int_equal(poll_after(10000), FATHOM_PENDING);
    assert_int_equal(due_us(), 1490000);
    rig.fake.now_us += 70000;
    assert_int_equal(due_us(), 1420000);
    rig.fake.now_us += 1420001;
    assert_int_equal(due_us(), 0);
    assert_int_equal(poll_after(0), FATHOM_PENDING);
    assert_false(rig.fake.in_break);
}

/* ---- A16 ---- */

/* "ends a break that selected": whatever the memory held, there was none. */
TEST(without_a_selection_an_a16_leaves_tx_alone)
{
    static const uint8_t fills[] = {0x00, 0x5A, 0xFF};
    for (unsigned i = 0; i != sizeof fills; i++) {
        set_up(state);
        start_a16(fills[i], false, 0);
        fathom_a16_auto_deinit(&a16);
        assert_int_equal(set_breaks, 0);
    }
}

TEST(a_break_that_selected_is_ended_once)
{
    start_a16(0, false, 0);
    assert_int_equal(fathom_a16_auto_select(&a16, FATHOM_REAL_TIME), FATHOM_OK);
    assert_true(rig.fake.in_break);
    fathom_a16_auto_deinit(&a16);
    assert_false(rig.fake.in_break);
    assert_int_equal(set_breaks, 2);
}

/* A pin stays as it is: the module goes on with the value that was selected. */
TEST(a_pin_that_selected_is_left_as_it_is)
{
    for (unsigned value = FATHOM_PROCESSED; value != 2; value++) {
        set_up(state);
        start_a16(0, true, 0);
        assert_int_equal(fathom_a16_auto_select(&a16, (fathom_dyp_value_t)value), FATHOM_OK);
        const unsigned sets = pin.sets;
        fathom_a16_auto_deinit(&a16);
        assert_int_equal(pin.sets, sets);
        assert_int_equal(pin.level, value == FATHOM_PROCESSED);
        assert_int_equal(set_breaks, 0);
    }
}
