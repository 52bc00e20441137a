/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include "fathom/a16_pwm.h"
#include "pulse_rig.h"

/* A trigger that is the break of a UART, where that refuses to begin or to end it. */

enum { FOR_EVER = -1 };

static int (*works)(void *ctx, bool on);
static int refusals;
static int refusal;  /* what they say: 0 or < 0 */
static bool refused; /* which of the two: begin (true) or end */

static int set_break(void *ctx, bool on)
{
    if (on != refused || refusals == 0) return works(ctx, on);
    if (refusals > 0) refusals--;
    return refusal;
}

static int set_up(void **state)
{
    (void)set_up_meter(state);
    stand.config.trigger = NULL;
    stand.config.uart = &stand.fake.uart;
    start_meter_at(1000);
    works = stand.fake.uart.set_break;
    stand.fake.uart.set_break = set_break;
    refusals = refusal = 0;
    refused = false;
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* Polls for so long; returns how often the port was said to be broken. */
static unsigned ports_in(uint32_t for_us)
{
    unsigned ports = 0;
    for (uint32_t passed_us = 0; passed_us != for_us; passed_us += 1000) {
        stand.fake.now_us += 1000;
        ports += poll_meter() == FATHOM_ERR_PORT;
    }
    return ports;
}

TEST(a_trigger_that_does_not_end_is_said_once_a_second)
{
    refusals = FOR_EVER;
    assert_int_equal(ports_in(2 * MS), 0);
    assert_true(stand.fake.in_break);
    assert_int_equal(ports_in(2 * MS + 999 * MS), 0);
    assert_int_equal(ports_in(1 * MS), 1);
    assert_in_range(fathom_pulse_due_us(&stand.meter), 1, 1000);
    assert_int_equal(ports_in(999 * MS), 0);
    assert_int_equal(ports_in(1 * MS), 1);
    assert_true(stand.fake.in_break);
    refusals = 0;
    assert_int_equal(ports_in(1 * MS), 0);
    assert_false(stand.fake.in_break);
    assert_int_equal(ports_in(2 * MS), 0);
    assert_int_equal(stand.fake.breaks, 2);
}

TEST(a_trigger_that_cannot_begin_is_said_once_a_second)
{
    refused = true;
    refusals = FOR_EVER;
    assert_int_equal(ports_in(2 * MS + 999 * MS), 0);
    stand.fake.now_us += 999;
    assert_int_equal(poll_meter(), FATHOM_PENDING);
    stand.fake.now_us++;
    assert_int_equal(poll_meter(), FATHOM_ERR_PORT);
    assert_int_equal(ports_in(3000 * MS), 3);
    assert_int_equal(stand.fake.breaks, 0);
    refusals = 0;
    assert_int_equal(ports_in(1 * MS), 0);
    assert_int_equal(stand.fake.breaks, 1);
}

/* What was taken in between ends a refusal, and so does an error. */
TEST(refusals_of_less_than_a_second_are_never_added_up)
{
    for (unsigned i = 0; i != 4; i++) {
        refused = i % 2 == 0;
        refusals = FOR_EVER;
        assert_int_equal(ports_in(900 * MS), 0);
        refusals = 0;
        assert_int_equal(ports_in(1 * MS), 0);
        assert_int_equal(stand.fake.in_break, i % 2 == 0);
    }
    refused = true;
    refusals = FOR_EVER;
    assert_int_equal(ports_in(900 * MS), 0);
    refusal = -1;
    assert_int_equal(ports_in(1 * MS), 1);
    refusal = 0;
    assert_int_equal(ports_in(999 * MS), 0);
}

TEST(deinit_tells_whether_the_trigger_is_high)
{
    for (int how = 0; how >= -1; how--) {
        const fathom_status_t said = how == 0 ? FATHOM_PENDING : FATHOM_ERR_PORT;
        start_meter_at(1000);
        refusal = how;
        stand.fake.uart.set_break = set_break;
        assert_int_equal(fathom_pulse_deinit(&stand.meter), FATHOM_READY);
        run_meter(2 * MS);
        assert_true(stand.fake.in_break);
        refusals = 2;
        for (unsigned i = 0; i != 2; i++) {
            assert_int_equal(fathom_pulse_deinit(&stand.meter), said);
            assert_true(stand.fake.in_break);
        }
        assert_int_equal(fathom_pulse_deinit(&stand.meter), FATHOM_READY);
        assert_false(stand.fake.in_break);
        refusals = FOR_EVER;
        assert_int_equal(fathom_pulse_deinit(&stand.meter), FATHOM_READY);
        refusals = 0;
    }
}

/* No poll is needed between the calls. */
TEST(deinit_gives_the_port_a_second)
{
    run_meter(2 * MS);
    assert_true(stand.fake.in_break);
    refusals = FOR_EVER;
    assert_int_equal(fathom_pulse_deinit(&stand.meter), FATHOM_PENDING);
    for (unsigned i = 0; i != 999; i++) {
        stand.fake.now_us += 1000;
        assert_int_equal(fathom_pulse_deinit(&stand.meter), FATHOM_PENDING);
    }
    stand.fake.now_us += 1000;
    assert_int_equal(fathom_pulse_deinit(&stand.meter), FATHOM_ERR_PORT);
}
