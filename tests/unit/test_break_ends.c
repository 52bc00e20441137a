/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "fathom/sensor/a05_auto.h"
#include "fathom/sensor/a16_auto.h"
#include "pulse_rig.h"

/* Sensors whose RX is held low by a break: where the port refuses to end that, they ask again until it does, say so
 * after a second, and deinit tells whether it has ended. */

enum { FOR_EVER = -1, SELECT_US = FATHOM_A05_SELECT_US };

static fathom_a05_auto_t a05;
static fathom_a16_auto_t a16;

/* ---- each of them, from a start to a break that is held ---- */

static void select_a05(void)
{
    const fathom_a05_auto_config_t config = {.stale_us = 60000000,
                                             .select = fathom_output_line_break(&rig.line)};
    rig_start(RIG_START_US);
    assert_int_equal(fathom_a05_auto_init(&a05, &rig.line, &config), FATHOM_OK);
    rig.sensor = fathom_a05_auto_sensor(&a05);
    assert_int_equal(fathom_a05_auto_select(&a05, FATHOM_REAL_TIME), FATHOM_OK);
}

static void select_a16(void)
{
    const fathom_a16_auto_config_t config = {.value = FATHOM_REAL_TIME,
                                             .select = fathom_output_line_break(&rig.line)};
    rig_start(RIG_START_US);
    assert_int_equal(fathom_a16_auto_init(&a16, &rig.line, &config), FATHOM_OK);
}

static void start_controlled(void)
{
    controlled.trigger = fathom_output_line_break(&rig.line);
    controlled_start();
}

static void trigger_controlled(void)
{
    start_controlled();
    controlled_run_to_break(1, 1000);
}

static void start_pulse(void)
{
    (void)set_up_meter(NULL);
    stand.trigger = fathom_output_break(&stand.fake.uart);
    start_meter();
}

static void trigger_pulse(void)
{
    start_pulse();
    run_meter(2 * MS);
}

static fathom_status_t end_a05(void) { return fathom_a05_auto_deinit(&a05); }
static fathom_status_t end_a16(void) { return fathom_a16_auto_deinit(&a16); }
static fathom_status_t end_controlled(void) { return fathom_a16_controlled_deinit(&controlled.a16); }
static fathom_status_t end_pulse(void) { return fathom_pulse_deinit(&stand.meter); }

static const struct {
    void (*hold)(void);
    fathom_status_t (*deinit)(void);
    fake_t *fake;
} sensors[] = {{select_a05, end_a05, &rig.fake},
               {select_a16, end_a16, &rig.fake},
               {trigger_controlled, end_controlled, &rig.fake},
               {trigger_pulse, end_pulse, &stand.fake}};

static void refuse(fake_t *fake, int times, int how)
{
    fake->refusals = times;
    fake->refusal = how;
}

static fathom_status_t said_of(int how) { return how == 0 ? FATHOM_PENDING : FATHOM_ERR_PORT; }

TEST(deinit_tells_whether_rx_is_high)
{
    for (unsigned i = 0; i != 2 * COUNT(sensors); i++) {
        fake_t *const fake = sensors[i / 2].fake;
        const int how = -(int)(i % 2);
        sensors[i / 2].hold();
        refuse(fake, 2, how);
        for (unsigned n = 0; n != 2; n++) {
            assert_int_equal(sensors[i / 2].deinit(), said_of(how));
            assert_true(fake->in_break);
            if (fake == &rig.fake) assert_null(rig.line.listener);
        }
        assert_int_equal(sensors[i / 2].deinit(), FATHOM_OK);
        assert_false(fake->in_break);
        refuse(fake, FOR_EVER, how);
        assert_int_equal(sensors[i / 2].deinit(), FATHOM_OK);
    }
}

/* ---- A05 and A16, automatic ---- */

TEST(a_selection_of_an_a05_ends_although_the_port_refused_that_once)
{
    for (int how = 0; how >= -1; how--) {
        select_a05();
        refuse(&rig.fake, 1, how);
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

/* The sensor sends all the same. */
TEST(a_selection_of_an_a05_that_does_not_end_is_said_once_a_second_beside_the_samples)
{
    static const uint8_t example[] = {0xFF, 0x03, 0xE8, 0x07, 0xD0,
                                      0x07, 0xA1, 0x0D, 0xEA, 0x60}; /* A05 1(4) */
    select_a05();
    refuse(&rig.fake, FOR_EVER, 0);
    rig_run(SELECT_US + 999000, 1000);
    assert_int_equal(rig.ports, 0);
    rig_run(3001000, 1000);
    assert_int_equal(rig.ports, 3);
    rig_send(example, sizeof example, 500);
    assert_int_equal(rig.samples, 4);
    assert_true(rig.fake.in_break);
    rig.fake.refusals = 0;
    rig_run(1000, 1000);
    assert_false(rig.fake.in_break);
    const unsigned ports = rig.ports;
    rig_run(3000000, 1000);
    assert_int_equal(rig.ports, ports);

    /* and with each poll where the port is broken; a sample comes first */
    select_a05();
    refuse(&rig.fake, FOR_EVER, -1);
    rig_run(SELECT_US - 1000, 1000);
    assert_int_equal(rig.ports, 0);
    fake_receive(&rig.fake, 1000, example, sizeof example);
    rig_run(5000, 1000);
    assert_int_equal(rig.ports, 5);
    rig.fake.now_us += 1000;
    for (unsigned i = 0; i != 4; i++) assert_int_equal(rig_poll(), FATHOM_OK);
    assert_int_equal(rig_poll(), FATHOM_ERR_PORT);
}

/* ---- A16, controlled ---- */

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
    controlled_response(controlled_511, 100 * MS);
    assert_int_equal(controlled_outcome(1000), FATHOM_OK);

    /* Nor is what was left of the time for the last response, 30 ms of it here, taken for that second. */
    rig.fake.never_sent = true;
    rig.ports = 0;
    rig_run(900 * MS, 1000);
    assert_int_equal(rig.ports, 0);
    rig.fake.never_sent = false;
    controlled_run_to_break(2, 1000);
    assert_int_equal(controlled_outcome(1000), FATHOM_ERR_NO_RESPONSE);

    /* In a slow loop the refusal is the first thing after the response. */
    controlled_run_to_break(3, 1000);
    controlled_response(controlled_511, 100 * MS);
    assert_int_equal(controlled_outcome(1000), FATHOM_OK);
    rig.fake.never_sent = true;
    rig.fake.now_us += 200 * MS;
    assert_int_equal(rig_poll(), FATHOM_PENDING);
}

/* ---- a pulse meter ---- */

/* Polls for so long; returns how often the port was said to be broken. */
static unsigned ports_in(uint32_t for_us)
{
    const unsigned before = stand.port_errors;
    run_meter_in_steps(for_us, 1000);
    return stand.port_errors - before;
}

TEST(a_trigger_of_a_pulse_that_cannot_begin_is_said_once_a_second)
{
    start_pulse();
    stand.fake.refuses_begin = true;
    refuse(&stand.fake, FOR_EVER, 0);
    assert_int_equal(ports_in(2 * MS + 999 * MS), 0);
    stand.fake.now_us += 999;
    expect_poll(FATHOM_PENDING);
    stand.fake.now_us++;
    expect_poll(FATHOM_ERR_PORT);
    assert_int_equal(ports_in(3000 * MS), 3);
    assert_int_equal(stand.fake.breaks, 0);
    stand.fake.refusals = 0;
    assert_int_equal(ports_in(1 * MS), 0);
    assert_int_equal(stand.fake.breaks, 1);
}
