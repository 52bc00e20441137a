/* SPDX-License-Identifier: MIT */
#include "pulse_rig.h"
#include "suite.h"

/* pulse.h where a UART triggers that is busy or broken, and the cycle to the microsecond. */

static fathom_uart_t uart;
static unsigned set_breaks;

static int counted_set_break(void *ctx, bool on)
{
    set_breaks++;
    return stand.fake.uart.set_break(ctx, on);
}

/* hal.h: "< 0: the port is broken", of an int: -256 is 0 in its low byte. */
static int failing_set_break(void *ctx, bool on)
{
    (void)ctx, (void)on;
    return -256;
}

static int failing_take(void *ctx, fathom_pulse_t *pulse)
{
    (void)ctx, (void)pulse;
    return -256;
}

static int set_up_uart(void **state)
{
    set_up_meter(state);
    uart = stand.fake.uart;
    uart.set_break = counted_set_break;
    stand.trigger = fathom_output_break(&uart);
    set_breaks = 0;
    start_meter();
    return 0;
}

static const suite_t suite = {.set_up = set_up_uart};
static const suite_t with_pin = {.set_up = set_up_meter};

static fathom_status_t poll_after(uint32_t us)
{
    stand.fake.now_us += us;
    return poll_meter();
}

static void is_busy_for(uint32_t us) { stand.fake.busy_until_us = stand.fake.now_us + us; }

static uint32_t due_us(void) { return fathom_pulse_due_us(&stand.meter); }

/* "never FATHOM_NO_DEADLINE": a port that was busy is asked again in 1 ms. */
TEST(where_the_port_was_busy_it_is_due_in_1_ms)
{
    is_busy_for(10 * MS);
    assert_int_equal(poll_after(2 * MS), FATHOM_PENDING);
    assert_int_equal(stand.fake.breaks, 0);
    assert_int_equal(due_us(), 1000);
    stand.fake.now_us += 400;
    assert_int_equal(due_us(), 600);
}

TEST(a_trigger_rises_as_soon_as_the_port_is_no_longer_busy)
{
    poll_after(2 * MS);
    assert_true(stand.fake.in_break);
    is_busy_for(5 * MS);
    assert_int_equal(poll_after(2 * MS), FATHOM_PENDING);
    assert_int_equal(due_us(), 1000);
    assert_int_equal(poll_after(2 * MS), FATHOM_PENDING);
    assert_true(stand.fake.in_break);
    assert_int_equal(poll_after(1 * MS), FATHOM_PENDING);
    assert_false(stand.fake.in_break);
}

/* "A cycle begins with the falling edge": what is low cannot fall. */
TEST(no_cycle_begins_before_the_trigger_has_risen)
{
    poll_after(2 * MS);
    assert_int_equal(stand.pin.arms, 1);
    is_busy_for(500 * MS);
    assert_int_equal(poll_after(221 * MS), FATHOM_ERR_NO_RESPONSE);
    assert_int_equal(poll_after(1 * MS), FATHOM_PENDING);
    assert_int_equal(stand.pin.arms, 1);
    assert_int_equal(stand.fake.breaks, 1);
    assert_int_equal(poll_after(278 * MS), FATHOM_PENDING); /* 221 + 1 + 278 = 500 */
    assert_false(stand.fake.in_break);
    assert_int_equal(stand.pin.arms, 1);
    poll_after(2 * MS); /* some high time */
    assert_int_equal(stand.pin.arms, 2);
    assert_true(stand.fake.in_break);
}

/* FATHOM_ERR_PORT: "the capture or the break failed; said by every poll until it works again". */
TEST(every_negative_result_of_set_break_is_a_broken_port)
{
    uart.set_break = failing_set_break;
    assert_int_equal(poll_after(2 * MS), FATHOM_ERR_PORT);
    uart.set_break = counted_set_break;
    assert_int_equal(poll_after(1 * MS), FATHOM_PENDING);
    assert_true(stand.fake.in_break);
    uart.set_break = failing_set_break;
    assert_int_equal(poll_after(2 * MS), FATHOM_ERR_PORT);
    assert_int_equal(poll_after(1 * MS), FATHOM_ERR_PORT);
}

TEST_IN(with_pin, every_negative_result_of_take_is_a_broken_port)
{
    stand.pin.capture.take = failing_take;
    run_to_trigger();
    assert_int_equal(poll_after(100), FATHOM_ERR_PORT);
}
