/* SPDX-License-Identifier: MIT */
#include "scan_others.h"

/* What `fathom scan` makes of responses that are not as they should be: two units with one address, other devices,
 * other protocols, another master. */

EACH_BEGINS(rig_begin(0))
static const suite_t suite = {.set_up = begins};

TEST(test_two_units_with_one_address_are_told_and_their_neighbours_found)
{
    for (uint32_t seed = 0; seed != 8; seed++) {
        rig_begin(0);
        rig_a16((a16_config_t){.address = 1, .seed = seed});
        rig_a05((a05_config_t){.address = 1, .seed = seed + 100});
        rig_a16((a16_config_t){.address = 2});
        rig_hps((hps_config_t){.address = 4, .seed = seed});
        rig_hps((hps_config_t){.address = 4, .seed = seed + 100});
        rig_hps((hps_config_t){.address = 5});
        rig_finds(4);
        assert_int_equal(rig_find(1)->kind, SCAN_DAMAGED);
        assert_int_equal(rig_find(1)->line.baud, 9600);
        rig_expect(2, FATHOM_A16);
        assert_int_equal(rig_find(4)->kind, SCAN_DAMAGED);
        assert_int_equal(rig_find(4)->line.baud, 19200);
        rig_expect(5, FATHOM_HPS167S);
        rig_expect_unharmed();
    }
}

TEST(test_two_responses_to_one_request_are_told)
{
    /* One answers 0200 after 17.5 to 20 ms, the other after 35 to 40: both responses are whole. */
    rig_a16((a16_config_t){.address = 6});
    rig_a16((a16_config_t){.address = 6, .settings_us = 40000});
    rig_finds(1);
    assert_true(rig_find(6)->is_double);
}

TEST(test_one_spike_on_a_dead_address_is_no_device)
{
    /* once, 1.2 s after the beginning */
    const fathom_sim_device_t *const spike = begin_speaker(&scan_dyp_line, 1200000, junk, 1);
    rig.plan.setting_count = 1;
    rig.plan.last = 12; /* 12 addresses, 2 s */
    rig_walk();
    assert_true(spike->counters.automatic != 0);
    assert_int_equal(rig.found, 0);
    assert_true(rig.walk.heard.bytes != 0);
}

TEST(test_responses_that_are_no_modbus_are_told_once)
{
    rig_begin(UINT32_C(0xFFF00000));
    begin_speaker(&scan_hps167s_line, 0, junk, sizeof junk);
    rig_a16((a16_config_t){.address = 3});
    rig_finds(2);
    rig_expect(3, FATHOM_A16);
    assert_int_equal(rig.findings[1].kind, SCAN_NOT_MODBUS);
    assert_int_equal(rig.findings[1].address, 0);
    assert_int_equal(rig.findings[1].line.baud, 19200);
    /* 32 addresses, most of them asked twice and not four times */
    assert_in_range(rig.probed[1][FATHOM_PARITY_EVEN], 64, 80);
}

TEST(test_no_modbus_at_one_address_of_two_is_a_damaged_response_and_at_the_only_one_another_protocol)
{
    for (uint8_t last = 3; last <= 4; last++) {
        rig_begin(0);
        begin_speaker(&scan_dyp_line, 0, junk, sizeof junk)->address = 3;
        rig.plan.first = 3;
        rig.plan.last = last;
        rig_finds(1);
        assert_int_equal(rig.findings[0].kind, last == 3 ? SCAN_NOT_MODBUS : SCAN_DAMAGED);
        assert_int_equal(rig.findings[0].address, last == 3 ? 0 : 3);
    }
}

static void begin_with(stranger_t with, const fathom_line_settings_t *line)
{
    rig_begin(0);
    stranger = with;
    begin_stranger(9, line);
}

static void expect_other(stranger_t with, const fathom_line_settings_t *line)
{
    begin_with(with, line);
    rig_finds(1);
    assert_non_null(rig_find(9));
    assert_int_equal(rig_find(9)->kind, SCAN_OTHER);
}

TEST(test_a_device_that_answers_everything_or_nothing_is_another_modbus_device)
{
    const fathom_line_settings_t *const lines[] = {&scan_dyp_line, &scan_hps167s_line};
    const uint16_t values[] = {0, 9, 0xFFFF, 0xB00B, 0x0909}; /* the last is a date */
    for (unsigned line = 0; line != 2; line++) {
        for (unsigned i = 0; i != sizeof values / sizeof values[0]; i++)
            expect_other((stranger_t){.value = values[i], .version = values[i], .address = 9}, lines[line]);
        for (uint8_t exception = 1; exception != 5; exception++)
            expect_other((stranger_t){.exception = exception}, lines[line]);
    }
}

TEST(test_a_device_with_another_address_in_0200_than_its_own_is_no_a16)
{
    stranger_t with = {.value = 754, .address = 9, .only = {0x0200, 0x0101}};
    begin_with(with, &scan_dyp_line);
    rig_walk();
    rig_expect(9, FATHOM_A16);
    for (with.address = 10; with.address != 12; with.address++) expect_other(with, &scan_dyp_line);
}

TEST(test_a_device_without_a_date_in_0001_is_no_hps167s)
{
    /* #3 begins with the right byte; in #1 the month is 0, 13 or 32, or the day is 0 */
    const uint16_t versions[] = {0x1400, 0x140D, 0x0020, 0x0009};
    for (unsigned i = 0; i != 4; i++)
        expect_other((stranger_t){.value = 0xB000, .version = versions[i]}, &scan_hps167s_line);
}

TEST(test_a_device_with_a_date_in_0001_and_zeros_elsewhere_is_no_hps167s)
{
    /* #2 has two switches and is the same twice, but so is what it measures */
    expect_other((stranger_t){.version = 0x0909}, &scan_hps167s_line);
}

TEST(test_an_a16_that_answers_0100_alone_is_known)
{
    begin_with((stranger_t){.value = 754, .address = 9, .only = {0x0200, 0x0100}}, &scan_dyp_line);
    rig_walk();
    rig_expect(9, FATHOM_A16);
    assert_int_equal(rig_find(9)->value, 754);
}

TEST(test_an_a05_whose_measurement_is_lost_once_is_known)
{
    static fathom_sim_fault_t fault;
    rig_a05((a05_config_t){.address = 9});
    fathom_sim_fault_init(&fault, 1);
    /* its first response is that of 0200 */
    assert_non_null(fathom_sim_fault_add(&fault, FATHOM_SIM_FAULT_SILENCE, FATHOM_SIM_FAULT_ALWAYS_PPM, 2));
    fathom_sim_fault_attach(&fault, &rig.sim_line, &rig.a05[0].device);
    rig_walk();
    assert_int_equal(fault.frames_hit, 1);
    rig_expect(9, FATHOM_A05);
}

TEST(test_a_frame_of_an_address_that_was_not_asked_is_noted)
{
    /* A16 6, the first example's response */
    static const uint8_t response[] = {0x01, 0x03, 0x02, 0x02, 0xF2, 0x38, 0xA1};
    rig.plan.first = 2;
    rig.plan.last = 4;
    begin_speaker(&scan_dyp_line, 0, response, sizeof response);
    rig_finds(0);
    assert_int_equal(rig.walk.heard.outside, 1);
    assert_false(rig.walk.heard.has_master);
}

TEST(test_another_master_that_begins_later_is_noted)
{
    rig.plan.first = 2;
    rig.plan.last = 4;
    begin_speaker(&scan_dyp_line, 0, a16_request, sizeof a16_request);
    rig_finds(0);
    assert_true(rig.walk.heard.has_master);
    assert_int_equal(rig.walk.heard.master_address, 1);
    assert_int_equal(rig.walk.heard.outside, 0);
}

TEST(test_measurements_may_take_longer_than_the_first_response)
{
    rig_a16((a16_config_t){.address = 1, .realtime_us = 290000});
    rig_a05((a05_config_t){.address = 2, .probe_us = 290000});
    rig_finds(2);
    rig_expect(1, FATHOM_A16);
    rig_expect(2, FATHOM_A05);
}

TEST(test_sensors_that_refuse_instead_of_being_silent_are_known_all_the_same)
{
    rig_a16((a16_config_t){.address = 1, .exceptions = true});
    rig_a05((a05_config_t){.address = 2, .exceptions = true});
    rig_hps((hps_config_t){.address = 3, .wrong_length = FATHOM_MODBUS_ILLEGAL_DATA_VALUE});
    rig_finds(3);
    rig_expect(1, FATHOM_A16);
    rig_expect(2, FATHOM_A05);
    rig_expect(3, FATHOM_HPS167S);
}

/* ---- HPS-167S #2 ---- */

static bool knows_termination(void)
{
    rig.plan.setting_count = 1;
    rig.plan.settings[0] = scan_hps167s_line;
    rig.plan.first = rig.plan.last = 1;
    rig.plan.listen_us = 0;
    rig_finds(1);
    rig_expect(1, FATHOM_HPS167S);
    rig_expect_unharmed();
    return rig_find(1)->has_config;
}

/* Table 12 prints no encoding of the rate, and the multiple of 18 of #15 is a rule for what is set. */
TEST(test_a_configuration_is_believed_whatever_its_rate_and_its_reconnect_time_are)
{
    const uint32_t times_ms[] = {0, 1, 1000, UINT32_MAX};
    const uint8_t codes[] = {0, 5, 0xFF, 19};
    for (unsigned i = 0; i != 4; i++) {
        rig_begin(0);
        rig_hps((hps_config_t){0});
        rig.hps[0].reconnect_ms = times_ms[i];
        rig.hps[0].baud_code = codes[i];
        assert_true(knows_termination());
        assert_true(rig_find(1)->has_termination);
    }
}

static int (*write_to_line)(void *ctx, const uint8_t *bytes, size_t length);

/* #2 does not reach the device. */
static int write_all_but_2(void *ctx, const uint8_t *bytes, size_t length)
{
    return bytes[3] == 0x02 ? (int)length : write_to_line(ctx, bytes, length);
}

/* 255 mm are 00 FF, two switches; and of a sensor that has failed (table 18) all but the magnitude is FF. */
TEST(test_a_measurement_that_comes_unasked_is_no_configuration)
{
    static fathom_sim_fixed_t near = {{255, 0, 0, 0}};
    for (uint32_t i = 0; i != 60; i++) {
        rig_begin(0);
        rig_hps((hps_config_t){.unasked_us = 25000 + i * 7000, .scene = fathom_sim_fixed(&near)});
        rig.walk.has_sender = true;
        if (i % 2 != 0) fathom_sim_hps167s_lose(&rig.hps[0], true, rig.sim_clock.now_us);
        write_to_line = rig.inner.write;
        rig.inner.write = write_all_but_2;
        assert_false(knows_termination());
    }
}
