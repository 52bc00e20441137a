/* SPDX-License-Identifier: MIT */
#include "stage.h"

/* An A16 with RS232 output (A16 5): from automatic output to Modbus and back. */

static fathom_a16_auto_t automatic;
static fathom_a16_rs232_t rs232;

static void set(uint8_t mode, uint32_t loop_us)
{
    stage_begin(&bench_9600, true, loop_us);
    bench.fixed = FIXED(1953);
    set_echo(FATHOM_LINE_ECHO_OFF);
    assert_int_equal(fathom_a16_auto_init(&automatic, &s.line, NULL), FATHOM_OK);
    init_driver(&s.driver, A16, 1, NULL);
    fathom_a16_rs232_init(&rs232, &s.driver.a16, &automatic);
    add_a16(mode, (a16_config_t){0});
    set_faults(1);
}

static fathom_status_t listen(void)
{
    s.sensor = fathom_a16_auto_sensor(&automatic);
    return measure();
}

static fathom_status_t ask_it(void)
{
    s.sensor = sensor_of(&s.driver, A16);
    return measure();
}

static fathom_status_t once(void) { return fathom_a16_rs232_return_to_automatic(&rs232, &s.sample); }

static fathom_status_t go_back(void)
{
    const uint32_t start_us = s.clock.now_us;
    for (;;) {
        const fathom_status_t status = once();
        if (status != FATHOM_PENDING) return status;
        assert_true(since_us(start_us) < 15 * SECOND);
        pass_until(fathom_a16_rs232_due_us(&rs232));
    }
}

/* It acknowledges or not, and sends nothing within that time. */
static void expect_unconfirmed(uint32_t least_ms, uint32_t most_ms)
{
    const uint32_t start_us = s.clock.now_us;
    assert_int_equal(go_back(), FATHOM_ERR_UNCONFIRMED);
    assert_in_range(since_us(start_us), least_ms * MS, most_ms * MS);
}

static void go_until_it_listens(void)
{
    for (; !rs232.is_listening; pass_until(fathom_a16_rs232_due_us(&rs232)))
        assert_int_equal(once(), FATHOM_PENDING);
}

EACH_BEGINS(set(FATHOM_SIM_A16_MODBUS, 0))
static const suite_t suite = {BENCH_ROUNDS, .set_up = begins};

TEST(the_first_modbus_command_ends_automatic_output_and_0202_brings_it_back)
{
    for (unsigned l = 0; l != 2; l++) {
        set(FATHOM_SIM_A16_AUTO, loops_us[l]);
        assert_int_equal(listen(), FATHOM_OK);
        assert_int_equal(ask_it(), FATHOM_OK);
        assert_int_equal(s.sample.distance_mm, 1953);
        assert_int_equal(s.sample.address, 1);
        while (listen() == FATHOM_OK) continue; /* frames linger around the first response */
        const uint32_t sent = bench.device->counters.automatic;
        assert_int_equal(listen(), FATHOM_ERR_STALE);
        assert_int_equal(bench.device->counters.automatic, sent);

        assert_int_equal(go_back(), FATHOM_OK);
        assert_int_equal(s.sample.address, 0);
        assert_int_equal(s.sample.distance_mm, 1953);
        assert_int_equal(bench.device->counters.automatic, sent + 1);
        for (unsigned i = 0; i != 10; i++) assert_int_equal(listen(), FATHOM_OK);
    }
}

TEST(a_frame_from_before_the_command_confirms_nothing)
{
    set(FATHOM_SIM_A16_AUTO, 0);
    for (unsigned i = 0; i != 300; i++) { /* a frame comes and is not taken */
        pass_us(1 * MS);
        (void)fathom_line_poll(&s.line);
    }
    go_until_it_listens();
    fathom_sim_detach(&bench.line, bench.device, s.clock.now_us);
    assert_int_equal(go_back(), FATHOM_ERR_UNCONFIRMED);
    assert_int_equal(go_back(), FATHOM_ERR_NO_RESPONSE); /* and of one that is not there nothing is claimed */
    assert_false(fathom_a16_modbus_is_written(rs232.modbus));
    assert_true(automatic.base.stream.counters[FATHOM_STREAM_FRAMES] != 0);
}

TEST(one_that_acknowledges_and_does_not_send_is_found_out_after_ten_seconds)
{
    for (unsigned l = 0; l != 2; l++) {
        set(FATHOM_SIM_A16_MODBUS, loops_us[l]);
        expect_unconfirmed(10000, 11000);
        COUNTED(.answered = 2);
    }
}

TEST(a_refusal_and_a_broken_port_are_told_as_they_are)
{
    FAULT(EXCEPTION, ALWAYS, 2);
    assert_int_equal(go_back(), FATHOM_ERR_EXCEPTION);

    set(FATHOM_SIM_A16_MODBUS, 0);
    s.broken = -1;
    assert_int_equal(go_back(), FATHOM_ERR_PORT);

    set(FATHOM_SIM_A16_MODBUS, 0); /* broken while it listens */
    assert_int_equal(ask_it(), FATHOM_OK);
    go_until_it_listens();
    s.broken = -1;
    assert_int_equal(go_back(), FATHOM_ERR_PORT);
    assert_false(rs232.is_listening);
}

TEST(a_lost_or_damaged_acknowledgement_leaves_it_to_the_frames)
{
    static const uint8_t kinds[] = {FATHOM_SIM_FAULT_FLIP_BIT, FATHOM_SIM_FAULT_TRUNCATE,
                                    FATHOM_SIM_FAULT_FUNCTION, FATHOM_SIM_FAULT_SILENCE};
    for (size_t i = 0; i != sizeof kinds; i++) {
        set(FATHOM_SIM_A16_MODBUS, 0);
        /* the address is the first frame, the acknowledgement the second */
        assert_non_null(fathom_sim_fault_add(&bench.fault, kinds[i], ALWAYS, 2));
        expect_unconfirmed(10000, 12000);
        COUNTED(.writes = 1);
    }
}

/* A first response with noise before it does not show whether the line echoes (line.h). */
TEST(an_acknowledgement_that_may_be_an_echo_leaves_it_to_the_frames)
{
    set_echo(FATHOM_LINE_ECHO_AUTO);
    FAULT(BREAK, ALWAYS, 1);
    expect_unconfirmed(11000, 12000); /* the time-out of the write before */
}

static uint16_t threshold_mm;
static fathom_status_t ask_threshold(void)
{
    return fathom_a16_modbus_get_switch_threshold_mm(&s.driver.a16, &threshold_mm);
}

TEST(another_commands_outcome_comes_first)
{
    fathom_status_t status;
    set(FATHOM_SIM_A16_AUTO, 0);
    assert_int_equal(ask_threshold(), FATHOM_PENDING);
    assert_int_equal(once(), FATHOM_ERR_BUSY);
    while ((status = ask_threshold()) == FATHOM_PENDING) pass_us(1 * MS);
    assert_int_equal(status, FATHOM_OK);
    assert_int_equal(go_back(), FATHOM_OK);
}

TEST(due_is_never_later_than_the_end_of_the_wait)
{
    go_until_it_listens();
    for (unsigned second = 1; second != 10; second++) {
        pass_us(1000 * MS);
        assert_int_equal(once(), FATHOM_PENDING);
    }
    pass_us(999 * MS);
    assert_true(fathom_a16_rs232_due_us(&rs232) <= 1 * MS);
    pass_us(1 * MS);
    assert_int_equal(fathom_a16_rs232_due_us(&rs232), 0);
    assert_int_equal(once(), FATHOM_ERR_UNCONFIRMED);
}

/* a16_rs232.h: of a pause in which the line drops what it heard, only the stale limit of 2 s counts. So polls each 3 s
 * end the wait of 10 s with the fifth. */
TEST(pauses_that_nothing_was_heard_in_do_not_prolong_the_wait_without_end)
{
    go_until_it_listens();
    for (unsigned pause = 1; pause != 5; pause++) {
        pass_us(3000 * MS);
        assert_int_equal(once(), FATHOM_PENDING);
    }
    pass_us(3000 * MS);
    assert_int_equal(once(), FATHOM_ERR_UNCONFIRMED);
}
