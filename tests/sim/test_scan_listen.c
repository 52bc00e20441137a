/* SPDX-License-Identifier: MIT */
#include "scan_listen.h"
#include "scan_others.h"

/* What `fathom scan` hears before it asks, and what it may not ask. */

static const uint8_t junk[] = {0x02, 0x84, 0x31, 0x90, 0x11, 0xE7};

/* ---- listening ---- */

static scan_talk_t talk;

static void listen_for_3_s(void)
{
    assert_int_equal(scan_listen(&rig.wire, 3000000, &talk), FATHOM_READY);
    assert_int_equal(rig.requests, 0);
    assert_int_equal(rig.sim_line.counters.from_host, 0);
}

EACH_BEGINS(rig_begin(0))
static const suite_t suite = {.set_up = begins};

TEST(test_a_quiet_line_is_listened_to_for_just_that_long)
{
    rig_begin(UINT32_C(0xFFF00000));
    rig_a16((a16_config_t){.unit = 1});
    listen_for_3_s();
    assert_false(talk.is_heard);
    assert_int_equal(rig.passed_us, 3000000);
}

TEST(test_an_a16_and_an_a05_that_send_are_named_and_nothing_is_sent)
{
    /* Held still at values whose bytes look like frames one byte further: 511 mm is FF 01 FF FF. */
    static fathom_sim_fixed_t scenes[] = {
        {{511, 511, 511, 511}}, {{1000, 2000, 2047, 1339}}, {{-1, -1, -1, -1}}, {{65281, 0, 255, 65535}}};
    for (unsigned i = 0; i != 4; i++) {
        for (unsigned coarse = 0; coarse != 2; coarse++) {
            rig_begin(UINT32_C(0xFFF00000));
            rig.sim_line.full_duplex = true;
            rig.coarse_us = coarse != 0 ? 20000 : 0;
            rig_a16((a16_config_t){.mode = FATHOM_SIM_A16_AUTO, .scene = fathom_sim_fixed(&scenes[i])});
            listen_for_3_s();
            assert_true(talk.is_heard);
            assert_int_equal(talk.finding.kind, SCAN_SENSOR);
            assert_int_equal(talk.finding.model, FATHOM_A16);
            assert_int_equal(talk.finding.mode, SCAN_AUTO);

            rig_begin(UINT32_C(0xFFF00000));
            rig.sim_line.full_duplex = true;
            rig.coarse_us = coarse != 0 ? 20000 : 0;
            rig_a05((a05_config_t){.mode = FATHOM_SIM_A05_AUTO, .scene = fathom_sim_fixed(&scenes[i])});
            listen_for_3_s();
            assert_true(talk.is_heard);
            assert_int_equal(talk.finding.model, FATHOM_A05);
            assert_int_equal(talk.finding.mode, SCAN_AUTO);
        }
    }
}

TEST(test_one_that_sends_is_asked_when_that_is_wanted_and_its_frames_are_no_devices)
{
    rig.sim_line.full_duplex = true;
    rig_a16((a16_config_t){.unit = 7, .mode = FATHOM_SIM_A16_AUTO});
    listen_for_3_s();
    rig.walk.is_talking = talk.is_heard;
    rig_finds(1);
    rig_expect(7, FATHOM_A16);

    /* and one that hears nothing, and sends on */
    rig_begin(0);
    rig.sim_line.full_duplex = true;
    rig_a16((a16_config_t){.unit = 7, .mode = FATHOM_SIM_A16_UART});
    rig.walk.is_talking = true;
    rig_finds(0);
}

TEST(test_an_hps167s_that_sends_unasked_is_found_at_its_rate)
{
    /* HPS-167S #5, the example's answer */
    static const uint8_t answer[] = {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2,
                                     0x07, 0x01, 0x00, 0x00, 0xFD, 0x41};
    const fathom_line_settings_t fast = {115200, FATHOM_PARITY_EVEN, 1};
    /* so often that what was heard at the wrong rate fills any memory */
    rig_begin(0);
    begin_speaker(&fast, 40000, answer, sizeof answer);
    listen_for_3_s();
    assert_true(talk.is_heard);
    assert_int_equal(talk.finding.kind, SCAN_SENSOR);
    assert_int_equal(talk.finding.model, FATHOM_HPS167S);
    assert_int_equal(talk.finding.address, 1);
    assert_int_equal(talk.finding.line.baud, 115200);
}

TEST(test_a_rate_that_the_port_cannot_do_does_not_end_the_listening)
{
    static const uint8_t answer[] = {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2,
                                     0x07, 0x01, 0x00, 0x00, 0xFD, 0x41};
    const fathom_line_settings_t fast = {115200, FATHOM_PARITY_EVEN, 1};
    rig_begin(0);
    rig.refused_baud = 57600;
    begin_speaker(&fast, 180000, answer, sizeof answer);
    listen_for_3_s();
    assert_int_equal(talk.finding.model, FATHOM_HPS167S);
    assert_int_equal(talk.finding.line.baud, 115200);
}

TEST(test_another_master_is_told)
{
    /* A16 6, the first example: it asks address 1 for 0100 */
    static const uint8_t request[] = {0x01, 0x03, 0x01, 0x00, 0x00, 0x01, 0x85, 0xF6};
    begin_speaker(&scan_dyp_line, 500000, request, sizeof request);
    listen_for_3_s();
    assert_true(talk.is_heard);
    assert_int_equal(talk.finding.kind, SCAN_MASTER);
    assert_int_equal(talk.finding.address, 1);
}

TEST(test_what_nobody_understands_is_a_sender_and_a_few_bytes_are_noise)
{
    begin_speaker(&scan_dyp_line, 1000000, junk, sizeof junk); /* three times in 3 s */
    listen_for_3_s();
    assert_true(talk.is_heard);
    assert_int_equal(talk.finding.kind, SCAN_SENDER);
    assert_int_equal(talk.finding.address, 0);

    rig_begin(0);
    begin_speaker(&scan_dyp_line, 2000000, junk, sizeof junk); /* once */
    listen_for_3_s();
    assert_false(talk.is_heard);
}

/* ---- what it may not ask ---- */

TEST(test_neither_the_reset_nor_all_units_can_be_asked_whatever_the_count)
{
    scan_question_t question = {
        .line = &scan_hps167s_line, .timeout_us = 100000, .first = 0x0009, .address = 1};
    scan_answer_t answer;
    rig_begin(0);
    rig_hps((hps_config_t){.unit = 1});
    for (uint8_t count = 1; count <= SCAN_REGISTERS; count++) {
        question.count = count;
        scan_ask(&rig.wire, &question, &answer);
        assert_int_equal(answer.status, FATHOM_ERR_ARGUMENT);
    }
    question = (scan_question_t){.line = &scan_hps167s_line, .timeout_us = 100000, .first = 1, .count = 3};
    scan_ask(&rig.wire, &question, &answer); /* unit 0 */
    assert_int_equal(answer.status, FATHOM_ERR_ARGUMENT);
    question.address = 1;
    question.count = SCAN_REGISTERS + 1; /* more than an answer has room for */
    scan_ask(&rig.wire, &question, &answer);
    assert_int_equal(answer.status, FATHOM_ERR_ARGUMENT);
    assert_int_equal(rig.requests, 0);
    question.count = 3;
    scan_ask(&rig.wire, &question, &answer);
    assert_int_equal(answer.status, FATHOM_READY);
    assert_int_equal(rig.requests, 1);
    rig_expect_unharmed();
}
