/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "controlled_rig.h"
#include "fathom/a05_auto.h"
#include "fathom/a16_auto.h"

/* Sensors whose RX is held low by a break of the line: where the port refuses to end that, they ask again until it does,
 * say so after a second, and deinit tells whether it has ended. */

enum { FOR_EVER = -1, SELECT_US = FATHOM_A05_SELECT_US };

static int (*works)(void *ctx, bool on);
static int refusals; /* of the end of a break */
static int refusal;  /* what they say: 0 or < 0 */

static int set_break(void *ctx, bool on)
{
    if (on || refusals == 0) return works(ctx, on);
    if (refusals > 0) refusals--;
    return refusal;
}

/* After the rig has started. */
static void refuse(int times, int how)
{
    if (rig.fake.uart.set_break != set_break) works = rig.fake.uart.set_break;
    rig.fake.uart.set_break = set_break;
    refusals = times;
    refusal = how;
}

static fathom_status_t said_of(int how) { return how == 0 ? FATHOM_PENDING : FATHOM_ERR_PORT; }

/* ---- A05, automatic ---- */

static fathom_a05_auto_t a05;
static const uint8_t example[] = {0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x60}; /* A05 1(4) */

static void start_a05(void)
{
    rig_start(RIG_START_US);
    const fathom_a05_auto_config_t config = {.line = &rig.line, .stale_us = 60000000};
    memset(&a05, 0x5A, sizeof a05);
    assert_int_equal(fathom_a05_auto_init(&a05, &config), FATHOM_READY);
    rig.sensor = fathom_a05_auto_sensor(&a05);
}

TEST(a_selection_of_an_a05_ends_although_the_port_refused_that_once)
{
    for (int how = 0; how >= -1; how--) {
        start_a05();
        refuse(1, how);
        assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_REAL_TIME), FATHOM_READY);
        rig_run(SELECT_US - 1000, 1000);
        rig.fake.now_us += 1000;
        assert_int_equal(rig_poll(), said_of(how));
        assert_true(rig.fake.in_break);
        assert_int_equal(rig.sensor.due_us(rig.sensor.ctx), 1000);
        rig.fake.now_us += 700;
        assert_int_equal(rig.sensor.due_us(rig.sensor.ctx), 300);
        rig.fake.now_us += 300;
        assert_int_equal(rig_poll(), FATHOM_PENDING);
        assert_false(rig.fake.in_break);
        assert_true(rig.sensor.due_us(rig.sensor.ctx) > 1000);
    }
}

/* The port refuses, and the sensor sends all the same. */
TEST(a_selection_of_an_a05_that_does_not_end_is_said_once_a_second_beside_the_samples)
{
    start_a05();
    refuse(FOR_EVER, 0);
    assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_REAL_TIME), FATHOM_READY);
    rig_run(SELECT_US + 999000, 1000);
    assert_int_equal(rig.ports, 0);
    rig_run(1000, 1000);
    assert_int_equal(rig.ports, 1);
    rig_run(3000000, 1000);
    assert_int_equal(rig.ports, 3);
    rig_send(example, sizeof example, 500);
    assert_int_equal(rig.samples, 4);
    assert_true(rig.fake.in_break);
    refusals = 0;
    rig_run(1000, 1000);
    assert_false(rig.fake.in_break);
    const unsigned ports = rig.ports;
    rig_run(3000000, 1000);
    assert_int_equal(rig.ports, ports);

    /* and with each poll where the port is broken; a sample comes first */
    start_a05();
    refuse(FOR_EVER, -1);
    assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_REAL_TIME), FATHOM_READY);
    rig_run(SELECT_US - 1000, 1000);
    assert_int_equal(rig.ports, 0);
    fake_receive(&rig.fake, 1000, example, sizeof example);
    rig_run(1000, 1000);
    assert_int_equal(rig.ports, 1);
    rig_run(4000, 1000);
    assert_int_equal(rig.ports, 5);
    rig.fake.now_us += 1000;
    for (unsigned i = 0; i != 4; i++) assert_int_equal(rig_poll(), FATHOM_READY);
    assert_int_equal(rig_poll(), FATHOM_ERR_PORT);
}

TEST(a_second_power_on_of_an_a05_does_not_forget_the_break_that_has_not_ended)
{
    start_a05();
    refuse(2, 0);
    assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_REAL_TIME), FATHOM_READY);
    rig_run(SELECT_US, 1000);
    assert_true(rig.fake.in_break);
    assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_PROCESSED), FATHOM_ERR_BUSY);
    assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_PROCESSED), FATHOM_READY);
    assert_false(rig.fake.in_break);
}

TEST(deinit_of_an_a05_tells_whether_rx_is_high)
{
    for (int how = 0; how >= -1; how--) {
        start_a05();
        assert_int_equal(fathom_a05_auto_power_on(&a05, FATHOM_A05_REAL_TIME), FATHOM_READY);
        refuse(2, how);
        for (unsigned i = 0; i != 2; i++) {
            assert_int_equal(fathom_a05_auto_deinit(&a05), said_of(how));
            assert_null(rig.line.listener);
            assert_true(rig.fake.in_break);
        }
        assert_int_equal(fathom_a05_auto_deinit(&a05), FATHOM_READY);
        assert_false(rig.fake.in_break);
        refuse(FOR_EVER, how);
        assert_int_equal(fathom_a05_auto_deinit(&a05), FATHOM_READY);
    }
}

/* ---- A16, automatic ---- */

TEST(deinit_of_an_a16_tells_whether_rx_is_high)
{
    static fathom_a16_auto_t a16;
    for (int how = 0; how >= -1; how--) {
        rig_start(RIG_START_US);
        const fathom_a16_auto_config_t config = {.line = &rig.line, .real_time = true};
        memset(&a16, 0x5A, sizeof a16);
        assert_int_equal(fathom_a16_auto_init(&a16, &config), FATHOM_READY);
        assert_true(rig.fake.in_break);
        refuse(3, how);
        assert_int_equal(fathom_a16_auto_select(&a16, false), said_of(how));
        for (unsigned i = 0; i != 2; i++) {
            assert_int_equal(fathom_a16_auto_deinit(&a16), said_of(how));
            assert_null(rig.line.listener);
            assert_true(rig.fake.in_break);
        }
        assert_int_equal(fathom_a16_auto_deinit(&a16), FATHOM_READY);
        assert_false(rig.fake.in_break);
        refuse(FOR_EVER, how);
        assert_int_equal(fathom_a16_auto_deinit(&a16), FATHOM_READY);
    }
}

/* No poll is needed between the calls. */
TEST(deinit_gives_the_port_a_second)
{
    static fathom_a16_auto_t a16;
    rig_start(RIG_START_US);
    const fathom_a16_auto_config_t config = {.line = &rig.line, .real_time = true};
    assert_int_equal(fathom_a16_auto_init(&a16, &config), FATHOM_READY);
    refuse(FOR_EVER, 0);
    assert_int_equal(fathom_a16_auto_deinit(&a16), FATHOM_PENDING);
    for (unsigned i = 0; i != 999; i++) {
        rig.fake.now_us += 1000;
        assert_int_equal(fathom_a16_auto_deinit(&a16), FATHOM_PENDING);
    }
    rig.fake.now_us += 1000;
    assert_int_equal(fathom_a16_auto_deinit(&a16), FATHOM_ERR_PORT);
}

/* ---- A16, controlled ---- */

static void start_controlled(void)
{
    memset(&controlled.config, 0, sizeof controlled.config);
    controlled_start();
}

TEST(a_trigger_of_an_a16_ends_although_the_port_refused_that_once)
{
    for (int how = 0; how >= -1; how--) {
        start_controlled();
        refuse(1, how);
        controlled_run_to_break(1, 1000);
        rig_run(1000, 1000);
        assert_true(rig.fake.in_break);
        rig.fake.now_us += 1000;
        assert_int_equal(rig_poll(), said_of(how));
        assert_true(rig.fake.in_break);
        rig_run(1000, 1000);
        assert_false(rig.fake.in_break);
        controlled_answer(controlled_1953, 97 * MS);
        assert_int_equal(controlled_outcome(1000), FATHOM_READY);
        assert_int_equal(rig.sample.distance_mm, 1953);
    }
}

TEST(a_trigger_of_an_a16_that_does_not_end_is_said_once_a_second)
{
    start_controlled();
    refuse(FOR_EVER, 0);
    controlled_run_to_break(1, 1000);
    rig_run(2 * MS + 999 * MS, 1000);
    assert_int_equal(rig.ports, 0);
    rig_run(1 * MS, 1000);
    assert_int_equal(rig.ports, 1);
    assert_in_range(rig.sensor.due_us(rig.sensor.ctx), 1, 1000);
    rig_run(3000 * MS, 1000);
    assert_int_equal(rig.ports, 3);
    assert_int_equal(rig.fake.breaks, 1);
    refusals = 0;
    rig_run(1 * MS, 1000);
    assert_false(rig.fake.in_break);
    controlled_run_to_break(2, 1000);
    controlled_answer(controlled_511, 100 * MS);
    assert_int_equal(controlled_outcome(1000), FATHOM_READY);
    assert_int_equal(rig.sample.distance_mm, 511);
}

/* Something else is sent there without end, or what is sent does not leave. */
TEST(a_trigger_of_an_a16_that_cannot_begin_is_said_once_a_second)
{
    start_controlled();
    rig.fake.never_sent = true;
    rig_run(2 * MS + 999 * MS, 1000);
    rig_run(999, 999);
    assert_int_equal(rig.ports, 0);
    rig_run(1, 1);
    assert_int_equal(rig.ports, 1);
    rig_run(3000 * MS, 1000);
    assert_int_equal(rig.ports, 4);
    rig.fake.never_sent = false;
    controlled_run_to_break(1, 1000);
    controlled_answer(controlled_511, 100 * MS);
    assert_int_equal(controlled_outcome(1000), FATHOM_READY);

    /* Nor is what was left of the time for the last answer, 30 ms of it here, taken for that second. */
    rig.fake.never_sent = true;
    rig.ports = 0;
    rig_run(900 * MS, 1000);
    assert_int_equal(rig.ports, 0);
    rig.fake.never_sent = false;
    controlled_run_to_break(2, 1000);
    assert_int_equal(controlled_outcome(1000), FATHOM_ERR_NO_ANSWER);

    /* In a slow loop the refusal is the first thing after the answer. */
    controlled_run_to_break(3, 1000);
    controlled_answer(controlled_511, 100 * MS);
    assert_int_equal(controlled_outcome(1000), FATHOM_READY);
    rig.fake.never_sent = true;
    rig.fake.now_us += 200 * MS;
    assert_int_equal(rig_poll(), FATHOM_PENDING);
}

TEST(deinit_of_a_controlled_a16_tells_whether_rx_is_high)
{
    for (int how = 0; how >= -1; how--) {
        start_controlled();
        controlled_run_to_break(1, 1000);
        refuse(2, how);
        for (unsigned i = 0; i != 2; i++) {
            assert_int_equal(fathom_a16_controlled_deinit(&controlled.a16), said_of(how));
            assert_null(rig.line.listener);
            assert_true(rig.fake.in_break);
        }
        assert_int_equal(fathom_a16_controlled_deinit(&controlled.a16), FATHOM_READY);
        assert_false(rig.fake.in_break);
        refuse(FOR_EVER, how);
        assert_int_equal(fathom_a16_controlled_deinit(&controlled.a16), FATHOM_READY);
    }
}
