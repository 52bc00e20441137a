/* SPDX-License-Identifier: MIT */
#include "pin_stage.h"

/* The relay of a simulated A05 (A05 4). */

static void set_a05(stage_t *s, int32_t distance, fathom_sim_a05_config_t config)
{
    begin(s);
    for (int i = 0; i != 4; i++) s->fixed.value[i] = distance;
    config.mode = FATHOM_SIM_A05_RELAY;
    config.scene = fathom_sim_fixed(&s->fixed);
    fathom_sim_a05_init(&s->a05, &config);
    attach(s, &s->a05.device);
}

#define A05 ((fathom_sim_a05_config_t){0})

static const suite_t suite = {BENCH_ROUNDS};

TEST(the_relay_closes_for_any_probe_that_is_nearer)
{
    stage_t s;
    for (int i = 0; i != 4; i++) {
        set_a05(&s, FATHOM_SIM_NO_TARGET, A05);
        wait(&s, 300 * MS);
        assert_true(level(&s)); /* open, pulled up */
        s.fixed.value[i] = 999;
        wait(&s, 300 * MS);
        assert_false(level(&s));
        s.fixed.value[i] = 1000; /* equality holds */
        wait(&s, 5000 * MS);
        assert_false(level(&s));
        s.fixed.value[i] = 1001;
        wait(&s, 300 * MS);
        assert_true(level(&s));
        assert_int_equal(s.edges, 2);
    }
}

TEST(each_state_of_the_relay_lasts_a_second)
{
    stage_t s;
    set_a05(&s, 999, A05);
    wait(&s, 300 * MS);
    assert_false(level(&s));
    const uint32_t closed_us = s.edge_us;
    for (int i = 0; i != 4; i++) s.fixed.value[i] = 2000;
    wait(&s, 1199 * MS);
    assert_false(level(&s));
    wait(&s, 1 * MS); /* the first measurement after a second */
    assert_true(level(&s));
    ASSERT_SPAN(s.edge_us, closed_us, 1200 * MS, 1200 * MS);
    s.fixed.value[2] = 1;
    wait(&s, 1200 * MS);
    assert_false(level(&s));
    assert_int_equal(s.edges, 3);
    set_a05(&s, 999, (fathom_sim_a05_config_t){.hold_us = 200 * MS});
    wait(&s, 300 * MS);
    assert_false(level(&s));
    for (int i = 0; i != 4; i++) s.fixed.value[i] = 2000;
    wait(&s, 300 * MS);
    assert_true(level(&s));
}

TEST(what_is_taught_and_wired_are_options)
{
    stage_t s;
    set_a05(&s, 2999,
            (fathom_sim_a05_config_t){.threshold_mm = 3000, .normally_closed = true, .period_us = 100 * MS});
    assert_false(level(&s)); /* it conducts */
    wait(&s, 100 * MS);
    assert_true(level(&s));
    set_a05(&s, 3001, (fathom_sim_a05_config_t){.probes = 0x0D, .threshold_mm = 3000});
    s.fixed.value[1] = 1; /* not fitted */
    wait(&s, 3000 * MS);
    assert_true(level(&s));
    assert_int_equal(s.a05.device.counters.measurements, 30);
}

TEST(without_power_the_relay_drops)
{
    stage_t s;
    for (int closed = 0; closed != 2; closed++) {
        set_a05(&s, 999, (fathom_sim_a05_config_t){.normally_closed = closed != 0});
        wait(&s, 300 * MS);
        assert_int_equal(level(&s), closed != 0); /* near */
        fathom_sim_power_cycle(&s.line, &s.a05.device, 500 * MS, s.clock.now_us);
        assert_int_equal(level(&s), closed == 0); /* far */
        assert_int_equal(s.edges, 2);
        wait(&s, 799 * MS);
        assert_int_equal(level(&s), closed == 0);
        wait(&s, 1 * MS);
        assert_int_equal(level(&s), closed != 0);
        assert_int_equal(s.edges, 3);
    }
}

TEST(a_contact_may_bounce)
{
    stage_t s;
    set_a05(&s, 999, (fathom_sim_a05_config_t){.bounces = 6});
    wait(&s, 300 * MS);
    assert_int_equal(s.edges, 1);
    assert_false(level(&s));
    wait(&s, 700);
    assert_true(level(&s));
    wait(&s, 5 * 700);
    assert_int_equal(s.edges, 7);
    assert_false(level(&s));
    wait(&s, 5000 * MS);
    assert_int_equal(s.edges, 7);
    assert_false(level(&s));
}

TEST(the_relay_has_no_ears_and_no_voice)
{
    stage_t s;
    uint8_t bytes[32];
    uint8_t bad;
    set_a05(&s, 999, A05);
    say(&s, (const uint8_t[]){0x01, 0x03, 0x01, 0x06, 0x00, 0x01, 0x65, 0xF7}, 8); /* A05 3(4) example 1 */
    wait(&s, 5000 * MS);
    assert_int_equal(receive(&s, bytes, &bad), 0);
    assert_int_equal(s.a05.device.counters.unheard, 8);
}
