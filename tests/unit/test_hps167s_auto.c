/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "auto_rig.h"
#include "fathom/hps167s_auto.h"
#include "fathom/hps167s_info.h"
#include "fathom/modbus_client.h"

/* Frames that nobody asked for, on a line. */

enum { LENGTH = 13 };

static uint32_t start_us;
static uint32_t loop_us;
static fathom_hps167s_auto_t hps;
static fathom_hps167s_auto_config_t config;
static fathom_modbus_t modbus;
static fathom_hps167s_t asking;

/* The example of #5, and the abnormal packet with the CRC by hand: frames.csv, and the simulator's tests. */
static const uint8_t example[LENGTH] = {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2,
                                        0x07, 0x01, 0x00, 0x00, 0xFD, 0x41};

/* The CRC bit by bit, from the text of HPS-167S 2.2.5. */
static void seal(uint8_t *frame)
{
    unsigned crc = 0xFFFF;
    for (unsigned i = 0; i != LENGTH - 2; i++) {
        crc ^= frame[i];
        for (unsigned bit = 0; bit != 8; bit++) crc = (crc & 1) != 0 ? crc >> 1 ^ 0xA001 : crc >> 1;
    }
    frame[LENGTH - 2] = (uint8_t)(crc & 0xFF);
    frame[LENGTH - 1] = (uint8_t)(crc >> 8);
}

static void make(uint8_t *frame, uint8_t address, uint16_t a, uint16_t b, uint16_t c, uint16_t d)
{
    const uint16_t values[] = {a, b, c, d};
    frame[0] = address;
    frame[1] = 0x03;
    frame[2] = 0x08;
    for (unsigned i = 0; i != 4; i++) {
        frame[3 + 2 * i] = (uint8_t)(values[i] >> 8);
        frame[4 + 2 * i] = (uint8_t)(values[i] & 0xFF);
    }
    seal(frame);
}

static int set_up(void **state)
{
    rig_start(start_us);
    memset(&config, 0, sizeof config);
    config.line = &rig.line;
    memset(&hps, 0x5A, sizeof hps);
    return 0;
}

/* In a fine loop and in one that comes round every 20 ms, and across the wrap of the clock. */
static void begin_round(unsigned round)
{
    start_us = round / 2 != 0 ? 0xFFFF8000u : RIG_START_US;
    loop_us = round % 2 != 0 ? 20000 : 1000;
}

static const suite_t suite = {.set_up = set_up, .begin_round = begin_round, .rounds = 4};

static void begin(void)
{
    assert_int_equal(fathom_hps167s_auto_init(&hps, &config), FATHOM_READY);
    rig.sensor = fathom_hps167s_auto_sensor(&hps);
}

static void send(uint8_t address, uint16_t a, uint16_t b, uint16_t c, uint16_t d)
{
    uint8_t frame[LENGTH];
    make(frame, address, a, b, c, d);
    rig_send(frame, LENGTH, loop_us);
}

/* The driver that asks the same device. */
static void ask_too(void)
{
    modbus = fathom_modbus_client(&rig.line);
    const fathom_hps167s_config_t asked = {.modbus = &modbus, .clock = &rig.fake.clock, .timeout_us = 300000};
    assert_int_equal(fathom_hps167s_init(&asking, &asked), FATHOM_READY);
    config.asking = &asking;
}

/* ---- frames ---- */

TEST(a_frame_is_a_sample_with_all_its_members)
{
    begin();
    rig_send(example, LENGTH, loop_us);
    assert_int_equal(rig.samples, 1);
    assert_int_equal(rig.sample.kind, FATHOM_TARGET);
    assert_int_equal(rig.sample.distance_mm, 2083);
    assert_int_equal(rig.sample.raw, 2083);
    assert_int_equal(rig.sample.magnitude, 7231744);
    assert_int_equal(rig.sample.ambient, 1);
    assert_int_equal(rig.sample.precision, 0);
    assert_int_equal(rig.sample.sequence, 1);
    assert_int_equal(rig.sample.model, FATHOM_HPS167S);
    assert_int_equal(rig.sample.unit, 1);
    assert_int_equal(rig.sample.probe, 1);
    assert_in_range(rig.fake.now_us - rig.sample.time_us, RIG_GAP_US - 1000, RIG_GAP_US + loop_us);
    rig_send(example, LENGTH, loop_us);
    assert_int_equal(rig.samples, 2);
    assert_int_equal(rig.sample.sequence, 2);
}

TEST(no_target_and_the_abnormal_packet_are_samples_too)
{
    begin();
    send(1, 65530, 0, 0, 0);
    assert_int_equal(rig.sample.kind, FATHOM_NO_TARGET);
    send(1, 0xFFFF, 0, 0x00FF, 0xFFFF);
    assert_int_equal(rig.samples, 2);
    assert_int_equal(rig.sample.kind, FATHOM_FAULT);
}

TEST(figures_that_it_cannot_mean_are_malformed_and_counted)
{
    begin();
    hps.implausible = 65533;
    for (unsigned i = 0; i != 3; i++) send(1, 31000, 0, 0, 0);
    assert_int_equal(rig.malformed, 3);
    assert_int_equal(hps.implausible, 65535);
    assert_int_equal(rig.samples, 0);
}

TEST(the_limits_are_options)
{
    config.limits.max_mm = 18000;
    config.limits.over_range_mm = 65500;
    begin();
    send(1, 18001, 0, 0, 0);
    assert_int_equal(rig.malformed, 1);
    send(1, 65500, 0, 0, 0);
    assert_int_equal(rig.sample.kind, FATHOM_NO_TARGET);
}

TEST(only_its_address_counts)
{
    config.address = 32;
    begin();
    send(31, 1000, 0, 0, 0);
    send(1, 1000, 0, 0, 0);
    assert_int_equal(rig.samples, 0);
    send(32, 2000, 0, 0, 0);
    assert_int_equal(rig.samples, 1);
    assert_int_equal(rig.sample.unit, 32);
}

TEST(what_is_not_of_this_shape_is_passed_over)
{
    uint8_t frame[LENGTH];
    begin();
    make(frame, 1, 1000, 0, 0, 0);
    frame[1] = 0x04;
    seal(frame);
    rig_send(frame, LENGTH, loop_us);
    make(frame, 1, 1000, 0, 0, 0);
    frame[2] = 0x0A;
    seal(frame);
    rig_send(frame, LENGTH, loop_us);
    assert_int_equal(rig.samples + rig.malformed, 0);
    rig_send(example, LENGTH, loop_us);
    assert_int_equal(rig.samples, 1);
}

TEST(no_single_wrong_bit_makes_a_sample)
{
    begin();
    for (unsigned bit = 0; bit != LENGTH * 8; bit++) {
        uint8_t frame[LENGTH];
        memcpy(frame, example, LENGTH);
        frame[bit / 8] ^= (uint8_t)(1u << bit % 8);
        rig_send(frame, LENGTH, 5000);
        assert_int_equal(rig.samples, bit);
        rig_send(example, LENGTH, 5000);
        assert_int_equal(rig.samples, bit + 1);
    }
    assert_int_equal(rig.malformed, 0);
}

/* Up to 12 bytes of a frame that broke off, and at once a whole one. */
TEST(a_frame_is_found_behind_the_beginning_of_another)
{
    begin();
    for (unsigned torn = 0; torn != LENGTH; torn++) {
        uint8_t bytes[2 * LENGTH];
        memcpy(bytes, example, torn);
        memcpy(bytes + torn, example, LENGTH);
        rig_send(bytes, torn + LENGTH, loop_us);
        assert_int_equal(rig.samples, torn + 1);
    }
}

/* 03 01 03 08 and the like: what looks like its beginning is none. */
TEST(a_frame_is_found_behind_noise_that_looks_like_its_head)
{
    static const uint8_t noises[][4] = {{1, 1, 3, 8}, {1, 3, 1, 3}, {1, 3, 8, 1}, {0, 0, 0, 0},
                                        {8, 3, 1, 1}, {1, 3, 8, 8}, {1, 1, 1, 1}};
    begin();
    for (unsigned i = 0; i != sizeof noises / sizeof *noises; i++) {
        uint8_t bytes[4 + LENGTH];
        memcpy(bytes, noises[i], 4);
        memcpy(bytes + 4, example, LENGTH);
        rig_send(bytes, sizeof bytes, loop_us);
        assert_int_equal(rig.samples, i + 1);
    }
}

TEST(lost_bytes_end_a_frame)
{
    const fathom_rx_t lost = {0, FATHOM_RX_OVERRUN};
    begin();
    fake_receive(&rig.fake, 0, example, 6);
    rig_run(1000, 1000);
    assert_int_equal(hps.have, 6);
    fake_receive_rx(&rig.fake, 0, example + 6, LENGTH - 6, lost);
    rig_run(20000, 1000);
    assert_int_equal(rig.samples, 0);
    assert_int_equal(hps.have, 0);
    rig_send(example, LENGTH, loop_us);
    assert_int_equal(rig.samples, 1);
}

TEST(of_several_frames_the_newest_is_told_and_the_others_are_counted)
{
    uint8_t frame[LENGTH];
    begin();
    hps.missed = 65533;
    for (uint16_t i = 1; i != 6; i++) {
        make(frame, 1, (uint16_t)(1000 * i), 0, 0, 0);
        fake_receive(&rig.fake, 0, frame, LENGTH);
    }
    rig_run(20000, 20000);
    assert_int_equal(rig.samples, 1);
    assert_int_equal(rig.sample.distance_mm, 5000);
    assert_int_equal(hps.missed, 65535);
}

/* ---- time ---- */

TEST(without_a_frame_it_is_stale_once_every_2_s)
{
    begin();
    rig_run(1980000, 20000);
    assert_int_equal(rig.stales, 0);
    rig_run(20000, 20000);
    assert_int_equal(rig.stales, 1);
    rig_run(4000000, 20000);
    assert_int_equal(rig.stales, 3);
    send(1, 31000, 0, 0, 0); /* no good frame */
    rig_run(1900000, 20000);
    assert_int_equal(rig.stales, 4);
    rig_send(example, LENGTH, 1000);
    rig_run(1900000, 20000);
    assert_int_equal(rig.stales, 4);
}

TEST(the_deadline_is_an_option_and_due_tells_it)
{
    config.stale_us = 700000;
    begin();
    rig_run(500000, 20000);
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 200000);
    rig.fake.now_us += 150000;
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 50000);
    rig.fake.now_us += 60000;
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 0);
    rig_run(20000, 20000);
    assert_int_equal(rig.stales, 1);
    fake_receive(&rig.fake, 0, example, LENGTH);
    fathom_line_poll(&rig.line); /* somebody else's poll brings a frame */
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 0);
    assert_int_equal(rig_poll(), FATHOM_READY);
}

TEST(a_request_of_another_is_due_before_it_is_stale)
{
    fathom_sample_t sample;
    ask_too();
    begin();
    const fathom_sensor_t measuring = fathom_hps167s_sensor(&asking);
    rig_run(10000, 1000);
    assert_int_equal(fathom_poll(&measuring, &sample), FATHOM_PENDING);
    assert_in_range(fathom_due_us(&rig.sensor, 1), 0, 300000);
}

TEST(a_broken_port_is_told_until_it_works_again)
{
    begin();
    rig.fake.read_fails = true;
    rig_run(3000, 1000);
    assert_int_equal(rig.ports, 3);
    rig.fake.read_fails = false;
    rig_send(example, LENGTH, loop_us);
    assert_int_equal(rig.samples, 1);
    assert_int_equal(rig.ports, 3);
}

/* ---- setting up ---- */

TEST(wrong_configs_are_refused)
{
    config.address = 33;
    assert_int_equal(fathom_hps167s_auto_init(&hps, &config), FATHOM_ERR_ARGUMENT);
    config.address = 0;
    config.limits.over_range_mm = 65535;
    assert_int_equal(fathom_hps167s_auto_init(&hps, &config), FATHOM_ERR_ARGUMENT);
    config.limits.over_range_mm = 0;
    config.line = NULL;
    assert_int_equal(fathom_hps167s_auto_init(&hps, &config), FATHOM_ERR_ARGUMENT);
    assert_null(rig.line.listener);
}

TEST(it_listens_until_it_is_told_to_stop)
{
    fathom_listener_t other;
    begin();
    assert_ptr_equal(rig.line.listener, &hps.listener);
    fathom_hps167s_auto_deinit(&hps);
    assert_null(rig.line.listener);
    begin();
    fathom_line_listen(&rig.line, &other);
    fathom_hps167s_auto_deinit(&hps); /* another one has taken its place */
    assert_ptr_equal(rig.line.listener, &other);
}

/* ---- beside asking ---- */

TEST(its_address_can_be_that_of_the_driver_that_asks)
{
    ask_too();
    begin();
    send(1, 1000, 0, 0, 0);
    assert_int_equal(rig.samples, 1);
    asking.unit.address = 7;
    send(1, 1000, 0, 0, 0);
    assert_int_equal(rig.samples, 1);
    send(7, 1000, 0, 0, 0);
    assert_int_equal(rig.samples, 2);
    assert_int_equal(rig.sample.unit, 7);
    config.address = 9;
    begin();
    send(9, 1000, 0, 0, 0);
    assert_int_equal(rig.samples, 3);
}

/* The driver asks #2 now, and would take a 255 mm of these figures for its answer. */
#define LOOKS_LIKE_2 0x00FF, 0x0500, 0x0000, 0xB401

static void run_both(uint32_t for_us, fathom_status_t (*command)(void), fathom_status_t *status)
{
    for (uint32_t passed_us = 0; passed_us < for_us; passed_us += loop_us) {
        rig.fake.now_us += loop_us;
        if (*status == FATHOM_PENDING) *status = command();
        while (rig_poll() == FATHOM_READY) {
        }
    }
}

static fathom_hps167s_configuration_t is;
static fathom_status_t ask_2(void) { return fathom_hps167s_configuration(&asking, &is); }

static fathom_hps167s_version_t version;
static fathom_status_t ask_1(void) { return fathom_hps167s_interface_version(&asking, &version); }

TEST(an_answer_to_2_that_comes_by_itself_is_no_measurement)
{
    fathom_status_t status = FATHOM_PENDING;
    ask_too();
    begin();
    send(1, LOOKS_LIKE_2); /* 255 mm, while nobody asks */
    assert_int_equal(rig.samples, 1);
    run_both(2000000, ask_2, &status); /* asked and not answered: the next one may be the answer */
    assert_int_equal(status, FATHOM_ERR_NO_ANSWER);
    send(1, LOOKS_LIKE_2);
    assert_int_equal(rig.samples, 1);
    assert_int_equal(hps.implausible, 1);
    send(1, 0x00FF, 0x0500, 0x0000, 0xB400); /* no such code */
    assert_int_equal(rig.samples, 2);
    status = FATHOM_PENDING;
    run_both(2000000, ask_1, &status); /* another question */
    assert_int_equal(status, FATHOM_ERR_NO_ANSWER);
    send(1, LOOKS_LIKE_2);
    assert_int_equal(rig.samples, 3);
}

TEST(what_was_told_last_is_no_measurement_at_any_time)
{
    static const uint16_t told[4] = {LOOKS_LIKE_2};
    ask_too();
    begin();
    memcpy(asking.told, told, sizeof told);
    send(1, LOOKS_LIKE_2);
    assert_int_equal(rig.samples, 0);
    assert_int_equal(hps.implausible, 1);
    send(1, 0x00FF, 0x0500, 0x0000, 0xB402);
    assert_int_equal(rig.samples, 1);
}

/* A target that stays at 255 mm, with figures that stay as well, sent every 100 ms while #2 is asked. */
TEST(a_held_value_is_never_taken_for_the_configuration)
{
    uint8_t frame[LENGTH];
    fathom_status_t status = FATHOM_PENDING;
    ask_too();
    begin();
    make(frame, 1, LOOKS_LIKE_2);
    rig_send(frame, LENGTH, loop_us);
    assert_int_equal(rig.samples, 1);
    for (unsigned i = 0; i != 60 && status == FATHOM_PENDING; i++) {
        fake_trickle(&rig.fake, 60000, RIG_BYTE_US, frame, LENGTH);
        run_both(100000, ask_2, &status);
    }
    assert_int_equal(status, FATHOM_ERR_MALFORMED);
    assert_int_equal(asking.unit.answers, 8);
}

TEST(commands_are_answered_while_frames_arrive)
{
    static const uint8_t answer_1[] = {0x01, 0x03, 0x06, 0x14, 0x09, 0x1B, 0x02, 0x01, 0x00, 0x58, 0xD4};
    fathom_status_t status = FATHOM_PENDING;
    ask_too();
    begin();
    rig_run(10000, 1000);
    run_both(20000, ask_1, &status);
    assert_int_equal(rig.fake.written, 1);
    fake_trickle(&rig.fake, 0, RIG_BYTE_US, example, LENGTH);
    fake_trickle(&rig.fake, 20000, RIG_BYTE_US, answer_1, sizeof answer_1);
    fake_trickle(&rig.fake, 50000, RIG_BYTE_US, example, LENGTH);
    run_both(100000, ask_1, &status);
    assert_int_equal(status, FATHOM_READY);
    assert_int_equal(version.year, 2020);
    assert_int_equal(rig.samples, 2);
}
