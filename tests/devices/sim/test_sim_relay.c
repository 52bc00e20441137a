/* SPDX-License-Identifier: MIT */
#include "pin_stage.h"

/* The relay of a simulated A05 (A05 4). */

static void set(int32_t mm, a05_config_t config)
{
    begin(mm);
    add_a05(FATHOM_SIM_A05_RELAY, config);
    take_pins();
}

#define AS_IT_IS ((a05_config_t){0})

static const suite_t suite = {BENCH_ROUNDS};

TEST(the_relay_closes_for_any_probe_that_is_nearer)
{
    for (int i = 0; i != 4; i++) {
        set(FATHOM_SIM_NO_TARGET, AS_IT_IS);
        assert_true(level_in(300 * MS)); /* open, pulled up */
        bench.fixed.value[i] = 999;
        assert_false(level_in(300 * MS));
        bench.fixed.value[i] = 1000; /* equality holds */
        assert_false(level_in(5000 * MS));
        bench.fixed.value[i] = 1001;
        assert_true(level_in(300 * MS));
        assert_int_equal(edges, 2);
    }
}

TEST(each_state_of_the_relay_lasts_a_second)
{
    set(999, AS_IT_IS);
    assert_false(level_in(300 * MS));
    const uint32_t closed_us = edge_us[edges - 1];
    bench.fixed = FIXED(2000, 2000, 2000, 2000);
    assert_false(level_in(1199 * MS));
    assert_true(level_in(1 * MS)); /* the first measurement after a second */
    ASSERT_SPAN(edge_us[edges - 1], closed_us, 1200 * MS, 1200 * MS);
    bench.fixed.value[2] = 1;
    assert_false(level_in(1200 * MS));
    assert_int_equal(edges, 3);
    set(999, (a05_config_t){.hold_us = 200 * MS});
    assert_false(level_in(300 * MS));
    bench.fixed = FIXED(2000, 2000, 2000, 2000);
    assert_true(level_in(300 * MS));
}

TEST(what_is_taught_and_wired_are_options)
{
    set(2999, (a05_config_t){.threshold_mm = 3000, .normally_closed = true, .period_us = 100 * MS});
    assert_false(level()); /* it conducts */
    assert_true(level_in(100 * MS));
    set(3001, (a05_config_t){.probes = 0x0D, .threshold_mm = 3000});
    bench.fixed.value[1] = 1; /* not fitted */
    assert_true(level_in(3000 * MS));
    COUNTED(.measurements = 30);
}

TEST(without_power_the_relay_drops)
{
    for (int closed = 0; closed != 2; closed++) {
        set(999, (a05_config_t){.normally_closed = closed != 0});
        assert_int_equal(level_in(300 * MS), closed != 0); /* near */
        fathom_sim_power_cycle(&bench.line, bench.device, 500 * MS, s.clock.now_us);
        assert_int_equal(level(), closed == 0); /* far */
        assert_int_equal(edges, 2);
        assert_int_equal(level_in(799 * MS), closed == 0);
        assert_int_equal(level_in(1 * MS), closed != 0);
        assert_int_equal(edges, 3);
    }
}

TEST(a_contact_may_bounce)
{
    set(999, (a05_config_t){.bounces = 6});
    pass_us(300 * MS);
    assert_int_equal(edges, 1);
    assert_false(level());
    assert_true(level_in(700));
    pass_us(5 * 700);
    assert_int_equal(edges, 7);
    assert_false(level());
    pass_us(5000 * MS);
    assert_int_equal(edges, 7);
    assert_false(level());
}

TEST(the_relay_neither_receives_nor_sends)
{
    set(999, AS_IT_IS);
    say("01 03 01 06 00 01 65 F7"); /* A05 3(4) example 1 */
    pass_us(5000 * MS);
    assert_true(has_heard("", 0));
    COUNTED(.unheard = 8);
}
