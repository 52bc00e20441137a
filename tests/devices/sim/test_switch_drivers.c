/* SPDX-License-Identifier: MIT */
#include "switch_stage.h"

/* The drivers of switch and relay at simulated modules. */

static const uint32_t steps_us[] = {500, 7000, 20000};
enum { STEPS = sizeof steps_us / sizeof *steps_us };

static const suite_t suite = {BENCH_ROUNDS};

TEST(the_switch_of_an_a16_is_read_in_any_loop)
{
    for (unsigned i = 0; i != STEPS; i++) {
        const uint32_t step_us = steps_us[i];
        set_switch(2000);
        run(200 * MS, step_us);
        expect_kinds("F");
        for (unsigned n = 0; n != 2; n++) {
            bench.fixed.value[0] = 999;
            const uint32_t came_us = s.clock.now_us;
            run(2100 * MS, step_us);
            ASSERT_SPAN(times_us[samples - 1], came_us, 1000 * MS, 1500 * MS + step_us);
            bench.fixed.value[0] = 1001;
            const uint32_t went_us = s.clock.now_us;
            run(3100 * MS, step_us);
            /* and the byte that the UART makes of the fall keeps it waiting for 5 ms and a look */
            ASSERT_SPAN(times_us[samples - 1], went_us, 2000 * MS, 2500 * MS + 2 * step_us + 7 * MS);
        }
        expect_kinds("FNFNF");
    }
}

TEST(a_program_that_sleeps_as_long_as_it_is_told_sees_each_change)
{
    unsigned looks = 0;
    set_switch(2000);
    for (int32_t mm = 999; mm <= 1001; mm += 2) {
        bench.fixed.value[0] = mm;
        const uint32_t from_us = s.clock.now_us;
        while (fathom_elapsed_us(s.clock.now_us, from_us) < 4000 * MS) {
            fathom_sim_clock_idle(&s.clock, fathom_due_us(&s.sensor, 1));
            look();
            looks++;
        }
    }
    expect_kinds("FNF");
    assert_in_range(looks, 700, 1000); /* 8 s at 10 ms, and what happens besides */
}

/* `call` until it has ended, in that loop. */
#define UNTIL_ENDED(status, call, step_us)                                                                   \
    while ((status = (call)) == FATHOM_PENDING) run(step_us, step_us)

static void set_threshold(uint16_t mm, uint32_t step_us)
{
    fathom_status_t status;
    uint16_t read_mm = 0;
    UNTIL_ENDED(status, fathom_a16_modbus_set_switch_threshold_mm(settings, mm), step_us);
    assert_int_equal(status, FATHOM_OK);
    UNTIL_ENDED(status, fathom_a16_modbus_get_switch_threshold_mm(settings, &read_mm), step_us);
    assert_int_equal(status, FATHOM_OK);
    assert_int_equal(read_mm, mm);
}

TEST(the_threshold_is_set_on_the_same_pins_and_no_response_is_a_change)
{
    static const struct {
        uint16_t mm[2]; /* one after the other; 0: none */
        uint32_t then_ms;
        const char *kinds;
    } rows[] = {{{0, 0}, 3000, "F"},
                {{1400, 1300}, 3000, "F"}, /* with the pin low */
                {{1501, 0}, 3000, "FN"},
                {{1600, 1502}, 3000, "FN"}, /* with the pin high */
                {{1499, 0}, 3500, "FNF"}};
    for (unsigned i = 0; i != STEPS; i++) {
        set_switch(1500);
        for (unsigned n = 0; n != sizeof rows / sizeof *rows; n++) {
            for (unsigned m = 0; m != 2; m++)
                if (rows[n].mm[m] != 0) set_threshold(rows[n].mm[m], steps_us[i]);
            run(rows[n].then_ms * MS, steps_us[i]);
            expect_kinds(rows[n].kinds);
        }
        assert_int_equal(bench.a16.device.counters.writes, 6);
        assert_true(s.counters[FATHOM_LINE_BAD_BYTES] >= 10); /* breaks around responses */
        assert_int_equal(s.counters[FATHOM_LINE_NO_RESPONSES], 0);
        assert_int_equal(s.counters[FATHOM_LINE_CHECKSUM_ERRORS], 0);
    }
}

/* A port that marks nothing: the bytes of a break are noise, and a line that is not told does not find out that it has
 * no echo. Then a write is not believed by its response, but by the value that is read back. */
TEST(a_port_that_knows_nothing_will_do)
{
    set_switch(1500);
    set_echo(FATHOM_LINE_ECHO_AUTO);
    s.port.knows = 0;
    run(3000 * MS, 20000);
    set_threshold(1501, 20000);
    run(3000 * MS, 20000);
    set_threshold(1400, 20000);
    run(4000 * MS, 20000);
    expect_kinds("FNF");
    assert_true(s.counters[FATHOM_LINE_DROPPED_BYTES] >= 4);
    assert_int_equal(s.counters[FATHOM_LINE_ECHOES], 1);
}

static fathom_status_t set_polarity(fathom_a16_polarity_t polarity, uint32_t step_us)
{
    fathom_status_t status;
    UNTIL_ENDED(status, fathom_a16_switch_set_polarity(&a16, settings, polarity), step_us);
    return status;
}

TEST(the_polarity_is_set_and_the_driver_reads_by_it)
{
    for (unsigned i = 0; i != STEPS; i++) {
        const uint32_t step_us = steps_us[i];
        for (int32_t mm = 999; mm <= 1001; mm += 2) {
            set_switch(mm);
            run(3100 * MS, step_us);
            const unsigned before = samples;
            assert_int_equal(set_polarity(FATHOM_A16_NEGATIVE, step_us), FATHOM_OK);
            run(3000 * MS, step_us);
            assert_int_equal(samples, before); /* nothing has come nearer or gone */
            assert_int_equal(bench.a16.polarity, 0);
            bench.fixed.value[0] = 2000 - mm;
            run(3100 * MS, step_us);
            assert_int_equal(set_polarity(FATHOM_A16_POSITIVE, step_us), FATHOM_OK);
            bench.fixed.value[0] = mm;
            run(3100 * MS, step_us);
            expect_kinds(mm == 999 ? "FNFN" : "FNF");
        }
    }
}

TEST(a_polarity_that_could_not_be_set_changes_nothing)
{
    set_switch(999);
    run(2100 * MS, 20000);
    expect_kinds("FN");
    fathom_sim_detach(&bench.line, bench.device, s.clock.now_us);
    assert_int_equal(set_polarity(FATHOM_A16_NEGATIVE, 20000), FATHOM_ERR_NO_RESPONSE);
    run(1000 * MS, 20000);
    expect_kinds("FN");
    /* it can be told what another driver has done */
    fathom_a16_switch_note_polarity(&a16, FATHOM_A16_NEGATIVE);
    run(100 * MS, 20000);
    expect_kinds("FNF");
}

TEST(while_the_polarity_is_being_set_the_level_is_not_looked_at)
{
    set_switch(999);
    run(2100 * MS, 20000);
    assert_int_equal(fathom_a16_switch_set_polarity(&a16, settings, FATHOM_A16_NEGATIVE), FATHOM_PENDING);
    fathom_a16_modbus_cancel(settings);
    fathom_sim_tx_wire(&s.pins, FATHOM_SIM_WIRE_LOW);
    run(1500 * MS, 20000);
    expect_kinds("FN");
    run(600 * MS, 20000);
    assert_int_equal(errors, 1); /* FATHOM_ERR_STALE */
    errors = 0;
    fathom_a16_switch_note_polarity(&a16, FATHOM_A16_POSITIVE);
    run(100 * MS, 20000);
    expect_kinds("FNF");
}

TEST(the_relay_of_an_a05_is_read_in_any_loop_and_by_either_contact)
{
    for (unsigned i = 0; i != STEPS; i++) {
        for (unsigned closed = 0; closed != 2; closed++) {
            const a05_config_t bounces = {.bounces = 10, .normally_closed = closed != 0};
            set_relay(FATHOM_SIM_NO_TARGET, bounces,
                      closed != 0 ? FATHOM_A05_RELAY_NORMALLY_CLOSED : FATHOM_A05_RELAY_NORMALLY_OPEN);
            run(2000 * MS, steps_us[i]);
            expect_kinds("F");
            for (unsigned probe = 0; probe != 4; probe++) {
                bench.fixed.value[probe] = 500;
                run(400 * MS, steps_us[i]);
                bench.fixed.value[probe] = 3000;
                run(400 * MS, steps_us[i]);
                assert_int_equal(samples, 2 + 2 * probe); /* held for 1 s */
                run(2000 * MS, steps_us[i]);
            }
            expect_kinds("FNFNFNFNF");
            for (unsigned n = 2; n != samples; n++)
                assert_true(fathom_elapsed_us(times_us[n], times_us[n - 1]) >= 1000 * MS - steps_us[i]);
        }
    }
}
