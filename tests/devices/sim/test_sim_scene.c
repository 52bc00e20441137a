/* SPDX-License-Identifier: MIT */
#include "sim_bench.h"

static int32_t at(fathom_sim_scene_t scene, uint8_t probe, uint32_t us)
{
    return scene.distance(scene.ctx, probe, bench_start_us + us);
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(fixed_things_stand_still_until_they_are_moved)
{
    fathom_sim_fixed_t fixed = {{100, 200, FATHOM_SIM_NO_TARGET, 400}};
    const fathom_sim_scene_t scene = fathom_sim_fixed(&fixed);
    assert_int_equal(at(scene, 1, 0), 100);
    assert_int_equal(at(scene, 2, 1000), 200);
    assert_int_equal(at(scene, 3, 1000), FATHOM_SIM_NO_TARGET);
    assert_int_equal(at(scene, 4, 1000), 400);
    assert_int_equal(at(scene, 0, 1000), FATHOM_SIM_NO_TARGET);
    assert_int_equal(at(scene, 5, 1000), FATHOM_SIM_NO_TARGET);
    fixed.value[0] = 101;
    assert_int_equal(at(scene, 1, 0), 101);
}

TEST(a_thing_goes_there_and_back_evenly)
{
    fathom_sim_moving_t moving = {1000, 3000, 2000 * MS, bench_start_us};
    const fathom_sim_scene_t scene = fathom_sim_moving(&moving);
    assert_int_equal(at(scene, 1, 0), 1000);
    assert_int_equal(at(scene, 1, 1 * MS), 1002);
    assert_int_equal(at(scene, 4, 250 * MS), 1500);
    assert_int_equal(at(scene, 1, 1000 * MS), 3000);
    assert_int_equal(at(scene, 1, 1500 * MS), 2000);
    assert_int_equal(at(scene, 1, 2000 * MS), 1000);
    assert_int_equal(at(scene, 1, 3000 * MS), 3000);
    assert_int_equal(at(scene, 1, 2500 * MS), 2000); /* another line lags behind */
    assert_int_equal(at(scene, 1, 1999 * MS), 1002);
}

TEST(a_thing_may_come_nearer_first)
{
    fathom_sim_moving_t moving = {65535, 0, 10, bench_start_us};
    const fathom_sim_scene_t scene = fathom_sim_moving(&moving);
    assert_int_equal(at(scene, 1, 0), 65535);
    assert_int_equal(at(scene, 1, 5), 0);
    assert_int_equal(at(scene, 1, 6), 13107);
}

TEST(the_movement_is_smooth_across_wraps)
{
    fathom_sim_moving_t moving = {0, 10000, 7777777, bench_start_us};
    const fathom_sim_scene_t scene = fathom_sim_moving(&moving);
    uint64_t us = 0;
    for (uint32_t i = 0; i < 1000000; i++) { /* 2.8 hours, 2.3 wraps, in steps of 10 ms */
        us += 10 * MS;
        const uint64_t phase_us = us % 7777777;
        const uint64_t out_us = phase_us > 3888888 ? 7777777 - phase_us : phase_us;
        assert_int_equal(at(scene, 1, (uint32_t)us), out_us * 10000 / 3888888);
    }
}

TEST(a_device_sees_the_scene_at_the_moment_of_its_frame)
{
    fathom_sim_moving_t moving = {1000, 2000, 2000 * MS, bench_start_us}; /* 1 mm a ms */
    set_a16(FATHOM_SIM_A16_AUTO, 0, (a16_config_t){.scene = fathom_sim_moving(&moving)});
    hear(310, "FF 04 4C 4F FF 04 B0 B3 FF 05 14 18"); /* 1100, 1200, 1300 */
}
