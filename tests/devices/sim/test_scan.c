/* SPDX-License-Identifier: MIT */
#include "scan_rig.h"

/* What `fathom scan` finds, how long it takes, and that it harms no device. */

static const uint32_t starts_us[] = {0, UINT32_C(0xFFF00000), UINT32_C(0x7FFFF000)};
enum { STARTS = sizeof starts_us / sizeof starts_us[0] };

static void begin_eight(uint32_t start_us)
{
    rig_begin(start_us);
    const uint8_t a16s[] = {1, 2, 9};
    const uint8_t a05s[] = {3, 5};
    const uint8_t hpss[] = {6, 7, 8};
    for (unsigned i = 0; i != sizeof a16s; i++) rig_a16((a16_config_t){.address = a16s[i], .seed = a16s[i]});
    rig_a05((a05_config_t){.address = a05s[0], .seed = 3});
    rig_a05((a05_config_t){.address = a05s[1], .mode = FATHOM_SIM_A05_DYP, .seed = 5});
    for (unsigned i = 0; i != sizeof hpss; i++)
        rig_hps((hps_config_t){.address = hpss[i], .seed = hpss[i], .no_termination = i == 0});
}

/* Address 4 is the dead one. */
static void expect_eight(void)
{
    const uint8_t others[] = {1, 2, 9};
    assert_int_equal(rig.found, 8);
    for (unsigned i = 0; i != sizeof others; i++) rig_expect(others[i], FATHOM_A16);
    rig_expect(3, FATHOM_A05);
    rig_expect(5, FATHOM_A05);
    for (uint8_t address = 6; address <= 8; address++) {
        rig_expect(address, FATHOM_HPS167S);
        const scan_finding_t *const hps = rig_find(address);
        assert_true(hps->has_interface && hps->has_config && hps->has_details);
        assert_int_equal(hps->has_termination, address != 6);
        assert_int_equal(hps->details.major, 3); /* HPS-167S #3: the example is version 3.9 */
        assert_int_equal(hps->details.minor, 9);
    }
    for (uint16_t i = 0; i != rig.found; i++) assert_false(rig.findings[i].is_double);
    rig_expect_unharmed();
}

EACH_BEGINS(rig_begin(0))
static const suite_t suite = {.set_up = begins};

TEST(test_eight_sensors_of_three_models_are_found_and_none_is_harmed)
{
    for (unsigned i = 0; i != STARTS; i++) {
        begin_eight(starts_us[i]);
        rig_walk();
        expect_eight();
        /* the estimate, and at most its surcharge for each */
        assert_true(rig.passed_us + rig.plan.listen_us <= scan_plan_us(&rig.plan) + 8u * SCAN_FOUND_US);
    }
}

TEST(test_eight_are_found_by_a_loop_of_20_ms)
{
    begin_eight(UINT32_C(0xFFF00000));
    rig.coarse_us = 20000;
    rig_walk();
    expect_eight();
}

TEST(test_eight_are_found_behind_an_adapter_that_echoes)
{
    begin_eight(0);
    rig.sim_line.echo = true;
    rig_walk();
    expect_eight();
    assert_true(rig.walk.heard.echoes > 50);
    assert_false(rig.walk.heard.has_master);
}

TEST(test_an_echo_alone_is_no_device_at_any_address)
{
    /* Nor is that of units 83 and 147, which looks like a response. */
    rig.sim_line.echo = true;
    rig.plan.last = 254;
    rig_finds(0);
    assert_int_equal(rig.walk.heard.echoes, 2 * 254);
    assert_int_equal(rig.walk.heard.bytes, 0);

    rig_begin(0);
    rig.sim_line.echo = true;
    rig.plan.last = 254;
    rig_a16((a16_config_t){.address = 83});
    rig_a05((a05_config_t){.address = 147});
    rig_finds(2);
    rig_expect(83, FATHOM_A16);
    rig_expect(147, FATHOM_A05);
}

TEST(test_eight_are_found_although_one_is_noisy_and_another_damages_half_of_its_responses)
{
    static fathom_sim_fault_t noise, flips;
    uint32_t flipped = 0;
    for (uint32_t seed = 1; seed != 9; seed++) {
        begin_eight(0);
        fathom_sim_fault_init(&noise, seed);
        assert_non_null(fathom_sim_fault_add(&noise, FATHOM_SIM_FAULT_NOISE, FATHOM_SIM_FAULT_ALWAYS_PPM, 0));
        fathom_sim_fault_attach(&noise, &rig.sim_line, &rig.a16[1].device);
        fathom_sim_fault_init(&flips, seed);
        assert_non_null(fathom_sim_fault_add(&flips, FATHOM_SIM_FAULT_FLIP_BIT, 500000, 0));
        fathom_sim_fault_attach(&flips, &rig.sim_line, &rig.hps[1].device);
        rig_finds(8);
        rig_expect(2, FATHOM_A16);
        rig_expect(7, FATHOM_HPS167S);
        assert_true(noise.frames_hit >= 2);
        flipped += flips.frames_hit;
        rig_expect_unharmed();
    }
    assert_true(flipped >= 8);
}

TEST(test_every_address_at_every_rate_and_parity_takes_less_than_10_minutes_and_what_was_said)
{
    rig_begin(UINT32_C(0xF0000000)); /* the clock wraps in between */
    rig_plan_everything();
    const uint64_t said_us = scan_plan_us(&rig.plan) - rig.plan.listen_us;
    assert_true(scan_plan_us(&rig.plan) < UINT64_C(600000000));
    rig_finds(0);
    assert_int_equal(rig.requests, 254 * 5 * 3 + 1); /* and one to any A05 */
    for (unsigned rate = 0; rate != 5; rate++)
        for (unsigned parity = 0; parity != 3; parity++) assert_int_equal(rig.probed[rate][parity], 254);
    /* Simulated time has no late wake-ups, for which 5 ms a request are in the estimate. */
    assert_true(rig.passed_us <= said_us);
    assert_true(rig.passed_us + 254u * 15u * 5000u + 5000u >= said_us);
    assert_true(rig.progress_us < said_us);
}

TEST(test_with_eight_sensors_every_address_takes_less_than_10_minutes)
{
    begin_eight(0);
    rig_plan_everything();
    rig_walk();
    expect_eight();
    assert_true(rig.passed_us + rig.plan.listen_us < UINT32_C(600000000));
    assert_true(rig.passed_us + rig.plan.listen_us <= scan_plan_us(&rig.plan) + 8u * SCAN_FOUND_US);
}

TEST(test_a_silent_address_is_asked_again_as_often_as_the_plan_says)
{
    rig.plan.repeats = 2;
    rig.plan.last = 4;
    rig_walk();
    assert_int_equal(rig.probed[0][FATHOM_PARITY_NONE], 4 * 3);
    assert_int_equal(rig.probed[1][FATHOM_PARITY_EVEN], 4 * 3);
    assert_true(rig.passed_us + rig.plan.listen_us <= scan_plan_us(&rig.plan));
}

TEST(test_the_time_out_of_the_plan_is_kept)
{
    rig.plan.timeout_us = 400000;
    rig.plan.last = 2;
    rig_walk();
    assert_in_range(rig.passed_us, 4 * 400000 + 300000, scan_plan_us(&rig.plan) - rig.plan.listen_us);
}

TEST(test_an_a16_or_a05_may_take_longer_than_an_hps167s)
{
    const fathom_line_settings_t odd = {9600, FATHOM_PARITY_ODD, 1};
    assert_int_equal(scan_timeout_us(&rig.plan, &scan_dyp_line), 150000);
    assert_int_equal(scan_timeout_us(&rig.plan, &scan_hps167s_line), 100000);
    assert_int_equal(scan_timeout_us(&rig.plan, &odd), 100000);
    rig.plan.setting_count = 1;
    rig.plan.last = 1;
    rig_walk();
    /* 3.6 ms of silence, 8 bytes of 10 bits, the time-out and as long again, in which it may still answer; 5 bytes and
     * a time-out for any A05 */
    assert_in_range(rig.passed_us, 3646 + 8333 + 2 * 150000 + 5208 + 300000,
                    3646 + 8333 + 2 * 150000 + 5208 + 310000);
}

TEST(test_a_sensor_at_another_rate_is_found_there_and_other_parities_are_not_tried)
{
    const fathom_line_settings_t fast = {57600, FATHOM_PARITY_EVEN, 1};
    rig_plan_everything();
    rig.plan.settings[6] = (fathom_line_settings_t){57600, FATHOM_PARITY_EVEN, 1}; /* the factory's first */
    rig.plan.settings[7] = (fathom_line_settings_t){57600, FATHOM_PARITY_NONE, 1};
    rig.plan.last = 32;
    rig_hps((hps_config_t){.address = 12, .baud_code = 2});
    rig_finds(1);
    rig_expect_sensor(12, FATHOM_HPS167S, SCAN_MODBUS, &fast);
    assert_int_equal(rig.probed[2][FATHOM_PARITY_EVEN], 32);
    assert_int_equal(rig.probed[2][FATHOM_PARITY_NONE], 31);
    assert_int_equal(rig.probed[2][FATHOM_PARITY_ODD], 31);
    rig_expect_unharmed();
}

TEST(test_a_port_that_cannot_do_a_rate_leaves_it_out_and_goes_on)
{
    rig.plan.settings[2] = rig.plan.settings[1];
    rig.plan.settings[1] = (fathom_line_settings_t){230400, FATHOM_PARITY_EVEN, 1};
    rig.plan.setting_count = 3;
    rig.refused_baud = 230400;
    rig_hps((hps_config_t){.address = 1});
    rig_walk();
    assert_int_equal(rig.unsupported, 1);
    rig_expect(1, FATHOM_HPS167S);
}

TEST(test_one_that_answers_late_is_found_all_the_same)
{
    /* 220 to 250 ms, where 150 are waited for: it answers while the next address is asked. */
    rig_begin(UINT32_C(0xFFF00000));
    rig_a16((a16_config_t){.address = 3, .settings_us = 250000});
    rig_a16((a16_config_t){.address = 5});
    rig_finds(2);
    rig_expect(3, FATHOM_A16);
    rig_expect(5, FATHOM_A16);
}

TEST(test_an_a05_that_speaks_55_aa_is_found_at_an_address_that_was_not_asked)
{
    rig_a05((a05_config_t){.address = 100, .mode = FATHOM_SIM_A05_DYP});
    rig_finds(1);
    rig_expect_sensor(100, FATHOM_A05, SCAN_DYP, &scan_dyp_line);
    rig_expect_unharmed();
}

TEST(test_it_ends_at_once_when_that_is_asked_for)
{
    for (uint32_t waits = 0; waits < 400; waits += 7) {
        begin_eight(0);
        rig.waits_left = waits;
        assert_int_equal(scan_walk(&rig.walk), FATHOM_ERR_CANCELLED);
        assert_null(rig.line.head);
        assert_int_equal(rig.waits_left, 0);
    }
}

TEST(test_a_port_that_breaks_ends_it)
{
    begin_eight(0);
    rig.is_broken = true;
    assert_int_equal(scan_walk(&rig.walk), FATHOM_ERR_PORT);
    assert_int_equal(rig.found, 0);
}
