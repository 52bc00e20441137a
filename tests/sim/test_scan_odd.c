/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "fathom/dyp_client.h"
#include "scan_listen.h"
#include "scan_rig.h"

/* What `fathom scan` makes of a line on which not all is well: two units with one address, other devices, other
 * protocols, senders, another master; and what it may not ask. */

/* ---- devices that are none of the three ---- */

/* Answers every read with the same value; or, with an empty scene, says what a frame of its own is made of. */
static uint16_t stranger_value;
static uint8_t stranger_exception;

static uint32_t stranger_request(fathom_sim_device_t *device, fathom_modbus_message_t *message)
{
    (void)device;
    message->exception = stranger_exception;
    return 5000;
}

static void stranger_fill(fathom_sim_device_t *device, fathom_modbus_message_t *message, uint32_t now_us)
{
    (void)device;
    (void)now_us;
    for (uint8_t i = 0; i != message->head[5]; i++) message->values[i] = stranger_value;
}

/* Says the same bytes over and over, or in answer to whatever it hears. */
static const uint8_t *said;
static uint8_t said_length;

static uint8_t speaker_automatic(fathom_sim_device_t *device, uint8_t *bytes, uint32_t now_us)
{
    (void)device;
    (void)now_us;
    memcpy(bytes, said, said_length);
    return said_length;
}

static uint8_t speaker_answer(fathom_sim_device_t *device, uint8_t *bytes, uint32_t now_us)
{
    return speaker_automatic(device, bytes, now_us);
}

static bool speaker_hear(fathom_sim_device_t *device, const uint8_t *frame, uint8_t length, uint32_t now_us);

static const fathom_sim_protocol_t speaker_protocol = {speaker_hear, speaker_answer, NULL, 0};

static bool speaker_hear(fathom_sim_device_t *device, const uint8_t *frame, uint8_t length, uint32_t now_us)
{
    (void)length;
    (void)now_us;
    if (device->unit != 0 && frame[0] != device->unit) return true;
    device->reply_settings = device->settings;
    fathom_sim_device_reply(device, &speaker_protocol, 5000);
    return true;
}

static const fathom_sim_model_t stranger_model = {.request = stranger_request, .fill = stranger_fill};
static const fathom_sim_model_t speaker_model = {.automatic = speaker_automatic};

static void begin_stranger(fathom_sim_device_t *device, uint8_t unit, const fathom_line_settings_t *line)
{
    memset(device, 0, sizeof *device);
    device->model = &stranger_model;
    device->settings = *line;
    device->unit = unit;
    device->listens = true;
    device->protocols[0] = &fathom_sim_modbus;
    rig_attach(device);
}

/* period_us: 0: it answers. */
static void begin_speaker(fathom_sim_device_t *device, const fathom_line_settings_t *line, uint32_t period_us,
                          const uint8_t *bytes, uint8_t length)
{
    memset(device, 0, sizeof *device);
    said = bytes;
    said_length = length;
    device->model = &speaker_model;
    device->settings = *line;
    device->period_us = period_us;
    device->listens = period_us == 0;
    device->protocols[0] = &speaker_protocol;
    rig_attach(device);
}

static const uint8_t junk[] = {0x02, 0x84, 0x31, 0x90, 0x11, 0xE7};

/* ---- answers that are damaged ---- */

static void test_two_units_with_one_address_are_told_and_their_neighbours_found(void **state)
{
    (void)state;
    for (uint32_t seed = 0; seed != 8; seed++) {
        rig_begin(0);
        rig_a16(&(fathom_sim_a16_config_t){.unit = 1, .mode = FATHOM_SIM_A16_MODBUS, .seed = seed});
        rig_a05(&(fathom_sim_a05_config_t){.unit = 1, .mode = FATHOM_SIM_A05_MODBUS, .seed = seed + 100});
        rig_a16(&(fathom_sim_a16_config_t){.unit = 2, .mode = FATHOM_SIM_A16_MODBUS});
        rig_hps(&(fathom_sim_hps167s_config_t){.unit = 4, .seed = seed});
        rig_hps(&(fathom_sim_hps167s_config_t){.unit = 4, .seed = seed + 100});
        rig_hps(&(fathom_sim_hps167s_config_t){.unit = 5});
        assert_int_equal(rig_walk(), FATHOM_READY);
        assert_int_equal(rig.found, 4);
        assert_int_equal(rig_find(1)->kind, SCAN_DAMAGED);
        assert_int_equal(rig_find(1)->line.baud, 9600);
        rig_expect_sensor(2, FATHOM_A16, SCAN_MODBUS, &scan_dyp_line);
        assert_int_equal(rig_find(4)->kind, SCAN_DAMAGED);
        assert_int_equal(rig_find(4)->line.baud, 19200);
        rig_expect_sensor(5, FATHOM_HPS167S, SCAN_MODBUS, &scan_hps167s_line);
        rig_expect_unharmed();
    }
}

static void test_two_answers_to_one_question_are_told(void **state)
{
    /* One answers 0200 after 17.5 to 20 ms, the other after 35 to 40: both answers are whole. */
    (void)state;
    rig_begin(0);
    rig_a16(&(fathom_sim_a16_config_t){.unit = 6, .mode = FATHOM_SIM_A16_MODBUS});
    rig_a16(&(fathom_sim_a16_config_t){.unit = 6, .mode = FATHOM_SIM_A16_MODBUS, .settings_us = 40000});
    assert_int_equal(rig_walk(), FATHOM_READY);
    assert_int_equal(rig.found, 1);
    assert_true(rig_find(6)->is_double);
}

static void test_one_spike_on_a_dead_address_is_no_device(void **state)
{
    static fathom_sim_device_t spike;
    (void)state;
    rig_begin(0);
    /* once, 1.2 s after the beginning */
    begin_speaker(&spike, &scan_dyp_line, 1200000, junk, 1);
    rig.plan.setting_count = 1;
    rig.plan.last = 12; /* 12 addresses, 2 s */
    assert_int_equal(rig_walk(), FATHOM_READY);
    assert_true(spike.counters.automatic != 0);
    assert_int_equal(rig.found, 0);
    assert_true(rig.walk.heard.bytes != 0);
}

static void test_answers_that_are_no_modbus_are_told_once(void **state)
{
    static fathom_sim_device_t other;
    (void)state;
    rig_begin(UINT32_C(0xFFF00000));
    begin_speaker(&other, &scan_hps167s_line, 0, junk, sizeof junk);
    rig_a16(&(fathom_sim_a16_config_t){.unit = 3, .mode = FATHOM_SIM_A16_MODBUS});
    assert_int_equal(rig_walk(), FATHOM_READY);
    assert_int_equal(rig.found, 2);
    rig_expect_sensor(3, FATHOM_A16, SCAN_MODBUS, &scan_dyp_line);
    assert_int_equal(rig.findings[1].kind, SCAN_NOT_MODBUS);
    assert_int_equal(rig.findings[1].address, 0);
    assert_int_equal(rig.findings[1].line.baud, 19200);
    /* 32 addresses, most of them asked twice and not four times */
    assert_in_range(rig.probed[1][FATHOM_PARITY_EVEN], 64, 80);
}

static void test_no_modbus_at_one_address_of_two_is_a_damaged_answer_and_at_the_only_one_another_protocol(
    void **state)
{
    static fathom_sim_device_t other;
    (void)state;
    for (uint8_t last = 3; last <= 4; last++) {
        rig_begin(0);
        begin_speaker(&other, &scan_dyp_line, 0, junk, sizeof junk);
        other.unit = 3;
        rig.plan.first = 3;
        rig.plan.last = last;
        assert_int_equal(rig_walk(), FATHOM_READY);
        assert_int_equal(rig.found, 1);
        assert_int_equal(rig.findings[0].kind, last == 3 ? SCAN_NOT_MODBUS : SCAN_DAMAGED);
        assert_int_equal(rig.findings[0].address, last == 3 ? 0 : 3);
    }
}

/* ---- devices that answer in Modbus ---- */

static void expect_other(uint8_t address)
{
    assert_int_equal(rig_walk(), FATHOM_READY);
    assert_int_equal(rig.found, 1);
    assert_non_null(rig_find(address));
    assert_int_equal(rig_find(address)->kind, SCAN_OTHER);
}

static void test_whoever_answers_everything_or_nothing_is_another_modbus_device(void **state)
{
    static fathom_sim_device_t stranger;
    const fathom_line_settings_t *const lines[] = {&scan_dyp_line, &scan_hps167s_line};
    const uint16_t values[] = {0, 9, 0xFFFF, 0xB00B};
    (void)state;
    for (unsigned line = 0; line != 2; line++) {
        for (unsigned value = 0; value != 4; value++) {
            rig_begin(0);
            stranger_value = values[value];
            stranger_exception = 0;
            begin_stranger(&stranger, 9, lines[line]);
            expect_other(9);
        }
        for (uint8_t exception = 1; exception != 5; exception++) {
            rig_begin(0);
            stranger_exception = exception;
            begin_stranger(&stranger, 9, lines[line]);
            expect_other(9);
        }
    }
}

static void test_sensors_that_refuse_instead_of_being_silent_are_known_all_the_same(void **state)
{
    (void)state;
    rig_begin(0);
    rig_a16(&(fathom_sim_a16_config_t){.unit = 1, .mode = FATHOM_SIM_A16_MODBUS, .exceptions = true});
    rig_a05(&(fathom_sim_a05_config_t){.unit = 2, .mode = FATHOM_SIM_A05_MODBUS, .exceptions = true});
    rig_hps(&(fathom_sim_hps167s_config_t){.unit = 3, .wrong_length = FATHOM_MODBUS_ILLEGAL_DATA_VALUE});
    assert_int_equal(rig_walk(), FATHOM_READY);
    assert_int_equal(rig.found, 3);
    rig_expect_sensor(1, FATHOM_A16, SCAN_MODBUS, &scan_dyp_line);
    rig_expect_sensor(2, FATHOM_A05, SCAN_MODBUS, &scan_dyp_line);
    rig_expect_sensor(3, FATHOM_HPS167S, SCAN_MODBUS, &scan_hps167s_line);
}

/* ---- listening ---- */

static scan_talk_t talk;

static void listen_for_3_s(void)
{
    assert_int_equal(scan_listen(&rig.wire, 3000000, &talk), FATHOM_READY);
    assert_int_equal(rig.requests, 0);
    assert_int_equal(rig.sim_line.counters.from_host, 0);
}

static void test_a_quiet_line_is_listened_to_for_just_that_long(void **state)
{
    (void)state;
    rig_begin(UINT32_C(0xFFF00000));
    rig_a16(&(fathom_sim_a16_config_t){.unit = 1, .mode = FATHOM_SIM_A16_MODBUS});
    listen_for_3_s();
    assert_false(talk.is_heard);
    assert_int_equal(rig.passed_us, 3000000);
}

static void test_an_a16_and_an_a05_that_send_are_named_and_nothing_is_sent(void **state)
{
    /* Held still at values whose bytes look like frames one byte further: 511 mm is FF 01 FF FF. */
    static fathom_sim_fixed_t scenes[] = {
        {{511, 511, 511, 511}}, {{1000, 2000, 2047, 1339}}, {{-1, -1, -1, -1}}, {{65281, 0, 255, 65535}}};
    (void)state;
    for (unsigned i = 0; i != 4; i++) {
        for (unsigned coarse = 0; coarse != 2; coarse++) {
            rig_begin(UINT32_C(0xFFF00000));
            rig.sim_line.full_duplex = true;
            rig.coarse_us = coarse != 0 ? 20000 : 0;
            rig_a16(&(fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_AUTO,
                                               .scene = fathom_sim_fixed(&scenes[i])});
            listen_for_3_s();
            assert_true(talk.is_heard);
            assert_int_equal(talk.finding.kind, SCAN_SENSOR);
            assert_int_equal(talk.finding.model, FATHOM_A16);
            assert_int_equal(talk.finding.mode, SCAN_AUTO);

            rig_begin(UINT32_C(0xFFF00000));
            rig.sim_line.full_duplex = true;
            rig.coarse_us = coarse != 0 ? 20000 : 0;
            rig_a05(&(fathom_sim_a05_config_t){.mode = FATHOM_SIM_A05_AUTO,
                                               .scene = fathom_sim_fixed(&scenes[i])});
            listen_for_3_s();
            assert_true(talk.is_heard);
            assert_int_equal(talk.finding.model, FATHOM_A05);
            assert_int_equal(talk.finding.mode, SCAN_AUTO);
        }
    }
}

static void test_one_that_sends_is_asked_when_that_is_wanted_and_its_frames_are_no_devices(void **state)
{
    (void)state;
    rig_begin(0);
    rig.sim_line.full_duplex = true;
    rig_a16(&(fathom_sim_a16_config_t){.unit = 7, .mode = FATHOM_SIM_A16_AUTO});
    listen_for_3_s();
    rig.walk.is_talking = talk.is_heard;
    assert_int_equal(rig_walk(), FATHOM_READY);
    assert_int_equal(rig.found, 1);
    rig_expect_sensor(7, FATHOM_A16, SCAN_MODBUS, &scan_dyp_line);

    /* and one that hears nothing, and sends on */
    rig_begin(0);
    rig.sim_line.full_duplex = true;
    rig_a16(&(fathom_sim_a16_config_t){.unit = 7, .mode = FATHOM_SIM_A16_UART});
    rig.walk.is_talking = true;
    assert_int_equal(rig_walk(), FATHOM_READY);
    assert_int_equal(rig.found, 0);
}

static void test_an_hps167s_that_sends_unasked_is_found_at_its_rate(void **state)
{
    /* HPS-167S #5, the example's answer */
    static const uint8_t answer[] = {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2,
                                     0x07, 0x01, 0x00, 0x00, 0xFD, 0x41};
    static fathom_sim_device_t sender;
    const fathom_line_settings_t fast = {115200, FATHOM_PARITY_EVEN, 1};
    (void)state;
    rig_begin(0);
    begin_speaker(&sender, &fast, 180000, answer, sizeof answer);
    listen_for_3_s();
    assert_true(talk.is_heard);
    assert_int_equal(talk.finding.kind, SCAN_SENSOR);
    assert_int_equal(talk.finding.model, FATHOM_HPS167S);
    assert_int_equal(talk.finding.address, 1);
    assert_int_equal(talk.finding.line.baud, 115200);
}

static void test_another_master_is_told(void **state)
{
    /* A16 6, the first example: it asks address 1 for 0100 */
    static const uint8_t request[] = {0x01, 0x03, 0x01, 0x00, 0x00, 0x01, 0x85, 0xF6};
    static fathom_sim_device_t master;
    (void)state;
    rig_begin(0);
    begin_speaker(&master, &scan_dyp_line, 500000, request, sizeof request);
    listen_for_3_s();
    assert_true(talk.is_heard);
    assert_int_equal(talk.finding.kind, SCAN_MASTER);
    assert_int_equal(talk.finding.address, 1);
}

static void test_what_nobody_understands_is_a_sender_and_a_few_bytes_are_noise(void **state)
{
    static fathom_sim_device_t sender;
    (void)state;
    rig_begin(0);
    begin_speaker(&sender, &scan_dyp_line, 1000000, junk, sizeof junk); /* three times in 3 s */
    listen_for_3_s();
    assert_true(talk.is_heard);
    assert_int_equal(talk.finding.kind, SCAN_SENDER);
    assert_int_equal(talk.finding.address, 0);

    rig_begin(0);
    begin_speaker(&sender, &scan_dyp_line, 2000000, junk, sizeof junk); /* once */
    listen_for_3_s();
    assert_false(talk.is_heard);
}

/* ---- what it may not ask ---- */

static void test_neither_the_reset_nor_all_units_can_be_asked_whatever_the_count(void **state)
{
    scan_question_t question = {
        .line = &scan_hps167s_line, .timeout_us = 100000, .first = 0x0009, .address = 1};
    scan_answer_t answer;
    (void)state;
    rig_begin(0);
    rig_hps(&(fathom_sim_hps167s_config_t){.unit = 1});
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_two_units_with_one_address_are_told_and_their_neighbours_found),
        cmocka_unit_test(test_two_answers_to_one_question_are_told),
        cmocka_unit_test(test_one_spike_on_a_dead_address_is_no_device),
        cmocka_unit_test(test_answers_that_are_no_modbus_are_told_once),
        cmocka_unit_test(
            test_no_modbus_at_one_address_of_two_is_a_damaged_answer_and_at_the_only_one_another_protocol),
        cmocka_unit_test(test_whoever_answers_everything_or_nothing_is_another_modbus_device),
        cmocka_unit_test(test_sensors_that_refuse_instead_of_being_silent_are_known_all_the_same),
        cmocka_unit_test(test_a_quiet_line_is_listened_to_for_just_that_long),
        cmocka_unit_test(test_an_a16_and_an_a05_that_send_are_named_and_nothing_is_sent),
        cmocka_unit_test(test_one_that_sends_is_asked_when_that_is_wanted_and_its_frames_are_no_devices),
        cmocka_unit_test(test_an_hps167s_that_sends_unasked_is_found_at_its_rate),
        cmocka_unit_test(test_another_master_is_told),
        cmocka_unit_test(test_what_nobody_understands_is_a_sender_and_a_few_bytes_are_noise),
        cmocka_unit_test(test_neither_the_reset_nor_all_units_can_be_asked_whatever_the_count),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
