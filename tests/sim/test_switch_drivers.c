/* SPDX-License-Identifier: MIT */
#include "switch_stage.h"

/* The drivers of switch and relay at simulated modules. */

static const uint32_t steps_us[] = {500, 7000, 20000};
enum { STEPS = sizeof steps_us / sizeof *steps_us };

static const suite_t suite = {BENCH_ROUNDS};

/* ---- A16 ---- */

TEST(the_switch_of_an_a16_is_read_in_any_loop)
{
    for (unsigned i = 0; i != STEPS; i++) {
        const uint32_t step_us = steps_us[i];
        set_a16(2000);
        run(200 * MS, step_us);
        expect("F");
        for (unsigned n = 0; n != 2; n++) {
            s.fixed.value[0] = 999;
            const uint32_t came_us = s.sim_clock.now_us;
            run(2100 * MS, step_us);
            ASSERT_SPAN(s.times_us[s.samples - 1], came_us, 1000 * MS, 1500 * MS + step_us);
            s.fixed.value[0] = 1001;
            const uint32_t went_us = s.sim_clock.now_us;
            run(3100 * MS, step_us);
            /* and the byte that the UART makes of the fall keeps it waiting for 5 ms and a look */
            ASSERT_SPAN(s.times_us[s.samples - 1], went_us, 2000 * MS, 2500 * MS + 2 * step_us + 7 * MS);
        }
        expect("FNFNF");
    }
}

TEST(a_program_that_sleeps_as_long_as_it_is_told_sees_each_change)
{
    unsigned looks = 0;
    set_a16(2000);
    for (int32_t mm = 999; mm <= 1001; mm += 2) {
        s.fixed.value[0] = mm;
        const uint32_t from_us = s.sim_clock.now_us;
        while (fathom_elapsed_us(s.sim_clock.now_us, from_us) < 4000 * MS) {
            fathom_sim_clock_idle(&s.sim_clock, fathom_due_us(&s.sensor, 1));
            look();
            looks++;
        }
    }
    expect("FNF");
    assert_in_range(looks, 700, 1000); /* 8 s at 10 ms, and what happens besides */
}

static void set_threshold(uint16_t mm, uint32_t step_us)
{
    fathom_status_t status;
    while ((status = fathom_a16_set_switch_threshold_mm(&s.settings, mm)) == FATHOM_PENDING)
        run(step_us, step_us);
    assert_int_equal(status, FATHOM_READY);
    uint16_t read_mm = 0;
    while ((status = fathom_a16_switch_threshold_mm(&s.settings, &read_mm)) == FATHOM_PENDING)
        run(step_us, step_us);
    assert_int_equal(status, FATHOM_READY);
    assert_int_equal(read_mm, mm);
}

TEST(the_threshold_is_set_on_the_same_pins_and_no_answer_is_a_change)
{
    for (unsigned i = 0; i != STEPS; i++) {
        set_a16(1500);
        run(3000 * MS, steps_us[i]);
        expect("F");
        set_threshold(1400, steps_us[i]); /* with the pin low */
        set_threshold(1300, steps_us[i]);
        run(3000 * MS, steps_us[i]);
        expect("F");
        set_threshold(1501, steps_us[i]);
        run(3000 * MS, steps_us[i]);
        expect("FN");
        set_threshold(1600, steps_us[i]); /* with the pin high */
        set_threshold(1502, steps_us[i]);
        run(3000 * MS, steps_us[i]);
        expect("FN");
        set_threshold(1499, steps_us[i]);
        run(3500 * MS, steps_us[i]);
        expect("FNF");
        assert_int_equal(s.sim_a16[0].device.counters.writes, 6);
        assert_true(s.port[0].line.counters[FATHOM_LINE_BAD_BYTES] >= 10); /* breaks around answers */
        assert_int_equal(s.port[0].line.counters[FATHOM_LINE_NO_ANSWERS], 0);
        assert_int_equal(s.port[0].line.counters[FATHOM_LINE_CHECKSUM_ERRORS], 0);
    }
}

/* A port that marks nothing: the bytes of a break are noise, and a line that is not told does not find out that it has
 * no echo. Then a write is not believed by its answer, but by the value that is read back. */
TEST(a_port_that_knows_nothing_will_do)
{
    set_a16(1500);
    s.port[0].config.echo = FATHOM_LINE_ECHO_AUTO;
    s.port[0].uart.knows = 0;
    run(3000 * MS, 20000);
    set_threshold(1501, 20000);
    run(3000 * MS, 20000);
    set_threshold(1400, 20000);
    run(4000 * MS, 20000);
    expect("FNF");
    assert_true(s.port[0].line.counters[FATHOM_LINE_DROPPED_BYTES] >= 4);
    assert_int_equal(s.port[0].line.counters[FATHOM_LINE_NO_ANSWERS], 1);
}

static fathom_status_t set_polarity(fathom_a16_polarity_t polarity, uint32_t step_us)
{
    fathom_status_t status;
    while ((status = fathom_a16_switch_set_polarity(&s.a16, &s.settings, polarity)) == FATHOM_PENDING)
        run(step_us, step_us);
    return status;
}

TEST(the_polarity_is_set_and_the_driver_reads_by_it)
{
    for (unsigned i = 0; i != STEPS; i++) {
        const uint32_t step_us = steps_us[i];
        for (int32_t mm = 999; mm <= 1001; mm += 2) {
            set_a16(mm);
            run(3100 * MS, step_us);
            const unsigned before = s.samples;
            assert_int_equal(set_polarity(FATHOM_A16_NEGATIVE, step_us), FATHOM_READY);
            run(3000 * MS, step_us);
            assert_int_equal(s.samples, before); /* nothing has come nearer or gone */
            assert_int_equal(s.sim_a16[0].polarity, 0);
            s.fixed.value[0] = 2000 - mm;
            run(3100 * MS, step_us);
            assert_int_equal(set_polarity(FATHOM_A16_POSITIVE, step_us), FATHOM_READY);
            s.fixed.value[0] = mm;
            run(3100 * MS, step_us);
            expect(mm == 999 ? "FNFN" : "FNF");
        }
    }
}

TEST(a_polarity_that_could_not_be_set_changes_nothing)
{
    set_a16(999);
    run(2100 * MS, 20000);
    expect("FN");
    fathom_sim_detach(&s.port[0].wire, &s.sim_a16[0].device, s.sim_clock.now_us);
    assert_int_equal(set_polarity(FATHOM_A16_NEGATIVE, 20000), FATHOM_ERR_NO_ANSWER);
    run(1000 * MS, 20000);
    expect("FN");
    /* it can be told what somebody else has done */
    fathom_a16_switch_polarity_is(&s.a16, FATHOM_A16_NEGATIVE);
    run(100 * MS, 20000);
    expect("FNF");
}

TEST(while_the_polarity_is_being_set_the_level_is_not_looked_at)
{
    set_a16(999);
    run(2100 * MS, 20000);
    assert_int_equal(fathom_a16_switch_set_polarity(&s.a16, &s.settings, FATHOM_A16_NEGATIVE),
                     FATHOM_PENDING);
    fathom_a16_cancel(&s.settings);
    fathom_sim_tx_wire(&s.port[0].pins, FATHOM_SIM_WIRE_LOW);
    run(1500 * MS, 20000);
    expect("FN");
    run(600 * MS, 20000);
    assert_int_equal(s.errors, 1); /* FATHOM_ERR_STALE */
    s.errors = 0;
    fathom_a16_switch_polarity_is(&s.a16, FATHOM_A16_POSITIVE);
    run(100 * MS, 20000);
    expect("FNF");
}

/* ---- A05 ---- */

TEST(the_relay_of_an_a05_is_read_in_any_loop_and_by_either_contact)
{
    for (unsigned i = 0; i != STEPS; i++) {
        for (unsigned closed = 0; closed != 2; closed++) {
            const fathom_sim_a05_config_t bounces = {.bounces = 10, .normally_closed = closed != 0};
            set_a05(FATHOM_SIM_NO_TARGET, bounces,
                    closed != 0 ? FATHOM_A05_RELAY_NORMALLY_CLOSED : FATHOM_A05_RELAY_NORMALLY_OPEN);
            run(2000 * MS, steps_us[i]);
            expect("F");
            for (unsigned probe = 0; probe != 4; probe++) {
                s.fixed.value[probe] = 500;
                run(400 * MS, steps_us[i]);
                s.fixed.value[probe] = 3000;
                run(400 * MS, steps_us[i]);
                assert_int_equal(s.samples, 2 + 2 * probe); /* held for 1 s */
                run(2000 * MS, steps_us[i]);
            }
            expect("FNFNFNFNF");
            for (unsigned n = 2; n != s.samples; n++)
                assert_true(fathom_elapsed_us(s.times_us[n], s.times_us[n - 1]) >= 1000 * MS - steps_us[i]);
        }
    }
}
