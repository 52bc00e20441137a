/* SPDX-License-Identifier: MIT */
#include "commands/scan/scan_listen.h"
#include "scan_others.h"

/* What `fathom scan` hears before it asks, and what it may not ask. */

static scan_unasked_t unasked;

static void listen_for_3_s(void)
{
    assert_int_equal(scan_listen(&rig.wire, 3000000, &unasked), FATHOM_OK);
    assert_int_equal(rig.requests, 0);
    assert_int_equal(rig.sim_line.counters.from_host, 0);
}

EACH_BEGINS(rig_begin(0))
static const suite_t suite = {.set_up = begins};

TEST(test_a_quiet_line_is_listened_to_for_just_that_long)
{
    rig_begin(UINT32_C(0xFFF00000));
    rig_a16((a16_config_t){.address = 1});
    listen_for_3_s();
    assert_false(unasked.is_heard);
    assert_int_equal(rig.passed_us, 3000000);
}

/* A device is heard. */
static void hear(scan_kind_t kind, uint8_t address)
{
    listen_for_3_s();
    assert_true(unasked.is_heard);
    assert_int_equal(unasked.finding.kind, kind);
    assert_int_equal(unasked.finding.address, address);
}

TEST(test_an_a16_and_an_a05_that_send_are_named_and_nothing_is_sent)
{
    /* Held still at values whose bytes look like frames one byte further: 511 mm is FF 01 FF FF. */
    static fathom_sim_fixed_t scenes[] = {
        {{511, 511, 511, 511}}, {{1000, 2000, 2047, 1339}}, {{-1, -1, -1, -1}}, {{65281, 0, 255, 65535}}};
    for (unsigned i = 0; i != 16; i++) {
        const fathom_sim_scene_t scene = fathom_sim_fixed(&scenes[i / 4]);
        rig_begin(UINT32_C(0xFFF00000));
        rig.sim_line.full_duplex = true;
        rig.coarse_us = i % 2 != 0 ? 20000 : 0;
        if (i / 2 % 2 == 0)
            rig_a16((a16_config_t){.mode = FATHOM_SIM_A16_AUTO, .scene = scene});
        else
            rig_a05((a05_config_t){.mode = FATHOM_SIM_A05_AUTO, .scene = scene});
        hear(SCAN_SENSOR, 0);
        assert_int_equal(unasked.finding.model, i / 2 % 2 == 0 ? FATHOM_A16 : FATHOM_A05);
        assert_int_equal(unasked.finding.mode, SCAN_AUTO);
    }
}

TEST(test_one_that_sends_is_asked_when_that_is_wanted_and_its_frames_are_no_devices)
{
    rig.sim_line.full_duplex = true;
    rig_a16((a16_config_t){.address = 7, .mode = FATHOM_SIM_A16_AUTO});
    listen_for_3_s();
    rig.walk.has_sender = unasked.is_heard;
    rig_finds(1);
    rig_expect(7, FATHOM_A16);

    /* and one that hears nothing, and sends on */
    rig_begin(0);
    rig.sim_line.full_duplex = true;
    rig_a16((a16_config_t){.address = 7, .mode = FATHOM_SIM_A16_UART});
    rig.walk.has_sender = true;
    rig_finds(0);
}

static void hear_hps167s_at_115200(uint32_t period_us)
{
    const fathom_line_settings_t fast = {115200, FATHOM_PARITY_EVEN, 1};
    begin_speaker(&fast, period_us, hps_response, sizeof hps_response);
    hear(SCAN_SENSOR, 1);
    assert_int_equal(unasked.finding.model, FATHOM_HPS167S);
    assert_int_equal(unasked.finding.line.baud, 115200);
}

TEST(test_an_hps167s_that_sends_unasked_is_found_at_its_rate)
{
    hear_hps167s_at_115200(40000); /* so often that what was heard at the wrong rate fills any memory */
}

TEST(test_a_rate_that_the_port_cannot_do_does_not_end_the_listening)
{
    rig.refused_baud = 57600;
    hear_hps167s_at_115200(180000);
}

TEST(test_another_master_is_told)
{
    begin_speaker(&scan_dyp_line, 500000, a16_request, sizeof a16_request);
    hear(SCAN_MASTER, 1);
}

TEST(test_what_is_not_understood_is_a_sender_and_a_few_bytes_are_noise)
{
    begin_speaker(&scan_dyp_line, 1000000, junk, sizeof junk); /* three times in 3 s */
    hear(SCAN_SENDER, 0);

    rig_begin(0);
    begin_speaker(&scan_dyp_line, 2000000, junk, sizeof junk); /* once */
    listen_for_3_s();
    assert_false(unasked.is_heard);
}

TEST(test_neither_the_reset_nor_all_units_can_be_asked_whatever_the_count)
{
    scan_request_t request = {
        .line = &scan_hps167s_line, .timeout_us = 100000, .first = 0x0009, .address = 1};
    scan_response_t response;
    rig_begin(0);
    rig_hps((hps_config_t){.address = 1});
    for (uint8_t count = 1; count <= SCAN_REGISTERS; count++) {
        request.count = count;
        scan_ask(&rig.wire, &request, &response);
        assert_int_equal(response.status, FATHOM_ERR_ARGUMENT);
    }
    request = (scan_request_t){.line = &scan_hps167s_line, .timeout_us = 100000, .first = 1, .count = 3};
    scan_ask(&rig.wire, &request, &response); /* unit 0 */
    assert_int_equal(response.status, FATHOM_ERR_ARGUMENT);
    request.address = 1;
    request.count = SCAN_REGISTERS + 1; /* more than a response has room for */
    scan_ask(&rig.wire, &request, &response);
    assert_int_equal(response.status, FATHOM_ERR_ARGUMENT);
    assert_int_equal(rig.requests, 0);
    request.count = 3;
    scan_ask(&rig.wire, &request, &response);
    assert_int_equal(response.status, FATHOM_OK);
    assert_int_equal(rig.requests, 1);
    rig_expect_unharmed();
}
