/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/sensor/hps167s_auto.h"
#include "fathom/sensor/hps167s_info.h"

/* Unsolicited frames on a line; test_driver_contract.c has what every listener promises. */

enum { LENGTH = RIG_HPS_LENGTH };

static uint32_t start_us;
static uint32_t loop_us;
static fathom_hps167s_auto_t hps;
static fathom_hps167s_auto_config_t config;
static fathom_modbus_t modbus;
static fathom_hps167s_t driver;

/* The example of #5, and its CRC. */
static const uint8_t example[LENGTH] = {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2,
                                        0x07, 0x01, 0x00, 0x00, 0xFD, 0x41};

static void begin(void)
{
    assert_int_equal(fathom_hps167s_auto_init(&hps, &rig.line, &config), FATHOM_OK);
    rig.sensor = fathom_hps167s_auto_sensor(&hps);
}

static int set_up(void **state)
{
    rig_start(start_us);
    config = (fathom_hps167s_auto_config_t){0};
    memset(&hps, 0x5A, sizeof hps);
    begin();
    PENDS(rig_poll()); /* the port is seen empty */
    return 0;
}

/* In a fine loop and in one that comes round every 20 ms, and across the wrap of the clock. */
static void begin_round(unsigned round)
{
    start_us = round / 2 != 0 ? 0xFFFF8000u : RIG_START_US;
    loop_us = round % 2 != 0 ? 20000 : 1000;
}

static const suite_t suite = {.set_up = set_up, .begin_round = begin_round, .rounds = 4};

/* A frame with these registers, and one with the example's, and what comes of it. */
static void hears(fathom_status_t status, uint8_t address, uint16_t a, uint16_t b, uint16_t c, uint16_t d)
{
    uint8_t frame[LENGTH];
    rig_hps_frame(frame, address, a, b, c, d);
    assert_int_equal(rig_send(frame, LENGTH, loop_us), status);
}

static void hears_example(void) { assert_int_equal(rig_send(example, LENGTH, loop_us), FATHOM_OK); }

/* The driver that asks the same device. */
static void ask_too(void)
{
    modbus = fathom_modbus_client(&rig.line);
    const fathom_hps167s_config_t asked = {.modbus.timeout_us = 300000};
    assert_int_equal(fathom_hps167s_init(&driver, &modbus, &asked), FATHOM_OK);
    fathom_hps167s_auto_follow(&hps, &driver);
}

/* ---- frames ---- */

TEST(only_its_address_counts)
{
    config.address = 32;
    begin();
    hears(FATHOM_PENDING, 31, 1000, 0, 0, 0);
    hears(FATHOM_PENDING, 1, 1000, 0, 0, 0);
    hears(FATHOM_OK, 32, 2000, 0, 0, 0);
    assert_int_equal(rig.sample.address, 32);
}

TEST(what_is_not_of_this_shape_is_passed_over)
{
    for (unsigned at = 1; at != 3; at++) {
        uint8_t frame[LENGTH];
        rig_hps_frame(frame, 1, 1000, 0, 0, 0);
        frame[at] = at == 1 ? 0x04 : 0x0A;
        rig_hps_seal(frame);
        PENDS(rig_send(frame, LENGTH, loop_us));
    }
    hears_example();
}

/* Up to 12 bytes of a frame that broke off, and at once a whole one. */
TEST(a_frame_is_found_behind_the_beginning_of_another)
{
    for (unsigned truncated = 0; truncated != LENGTH; truncated++) {
        uint8_t bytes[2 * LENGTH];
        memcpy(bytes, example, truncated);
        memcpy(bytes + truncated, example, LENGTH);
        assert_int_equal(rig_send(bytes, truncated + LENGTH, loop_us), FATHOM_OK);
    }
}

TEST(lost_bytes_end_a_frame)
{
    const fathom_rx_t lost = {0, FATHOM_RX_OVERRUN};
    fake_receive(&rig.fake, 0, example, 6);
    rig_run(1000, 1000);
    assert_int_equal(hps.held_count, 6);
    fake_receive_rx(&rig.fake, 0, example + 6, LENGTH - 6, lost);
    rig_run(20000, 1000);
    assert_int_equal(rig.samples, 0);
    assert_int_equal(hps.held_count, 0);
    hears_example();
}

TEST(of_several_frames_the_newest_is_told_and_the_others_are_counted)
{
    uint8_t frame[LENGTH];
    hps.missed = 65533;
    hears_example();
    assert_int_equal(hps.missed, 65533); /* the one before has been told */
    for (uint16_t i = 1; i != 6; i++) {
        rig_hps_frame(frame, 1, (uint16_t)(1000 * i), 0, 0, 0);
        fake_receive(&rig.fake, 0, frame, LENGTH);
    }
    rig_run(20000, 20000);
    assert_int_equal(rig.samples, 2);
    assert_int_equal(rig.sample.distance_mm, 5000);
    assert_int_equal(hps.missed, 65535);
}

/* A line whose buffer holds no frame is refused. */
TEST(the_buffer_of_the_line_holds_13_bytes)
{
    for (uint8_t size = 12; size != 14; size++) {
        rig.line_parts.frame_size = size;
        assert_int_equal(fathom_hps167s_auto_init(&hps, &rig.line, &config),
                         size == 12 ? FATHOM_ERR_ARGUMENT : FATHOM_OK);
    }
}

static void receives(const uint8_t *bytes, size_t length, fathom_status_t status)
{
    fake_receive(&rig.fake, 0, bytes, length);
    rig.fake.now_us += 100;
    assert_int_equal(rig_poll(), status);
}

static void counts(unsigned dropped_bytes, unsigned damaged)
{
    assert_int_equal(hps.dropped_bytes, dropped_bytes);
    assert_int_equal(hps.damaged, damaged);
}

/* 12 bytes of a frame without the first: none can be in a frame, but the last 01 may begin one; a wrong CRC: 41 for 42.
 * Each byte ends in a frame, is dropped, or is held. */
TEST(dropped_bytes_and_damaged_frames_are_counted)
{
    uint8_t wrong[LENGTH];
    memcpy(wrong, example, LENGTH);
    wrong[LENGTH - 1] = 0x42;
    receives(example, LENGTH, FATHOM_OK);
    counts(0, 0);
    receives(example + 1, LENGTH - 1, FATHOM_PENDING);
    counts(12, 0);
    for (unsigned i = 1; i <= 3; i++) {
        receives(wrong, LENGTH, FATHOM_PENDING);
        counts(12 + 13 * i, i);
    }
    receives(example, 5, FATHOM_PENDING);
    counts(12 + 13 * 3, 3); /* 5 are held */
    fake_receive_rx(&rig.fake, 0, example, LENGTH, (fathom_rx_t){0, FATHOM_RX_OVERRUN});
    rig.fake.now_us += 100;
    assert_int_equal(rig_poll(), FATHOM_OK);
    counts(12 + 13 * 3 + 5, 3);
    hps.dropped_bytes = hps.damaged = UINT16_MAX;
    receives(wrong, LENGTH, FATHOM_PENDING);
    counts(UINT16_MAX, UINT16_MAX);
}

/* ---- time ---- */

TEST(frames_that_are_no_samples_do_not_postpone_the_error)
{
    hears_example();
    for (unsigned i = 0; i != 10; i++) {
        hears(FATHOM_ERR_MALFORMED, 1, 31000, 0, 0, 0);
        hears(FATHOM_PENDING, 2, 2083, 0xDCB2, 0x0701, 0);
    }
    rig_run(100000, loop_us); /* 20 frames, each 100 ms after the one before, end 2 s after the good one */
    assert_int_equal(rig.damaged, 1);
    assert_int_equal(rig.stales, 0);
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
    fathom_line_poll(&rig.line); /* another driver's poll brings a frame */
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 0);
    assert_int_equal(rig_poll(), FATHOM_OK);
}

/* ---- beside a driver that asks ---- */

TEST(its_address_is_that_of_the_driver_that_asks)
{
    ask_too();
    hears(FATHOM_OK, 1, 1000, 0, 0, 0);
    driver.unit.address = 7;
    hears(FATHOM_PENDING, 1, 1000, 0, 0, 0);
    hears(FATHOM_OK, 7, 1000, 0, 0, 0);
    assert_int_equal(rig.sample.address, 7);
}

/* The driver asks #2 now, and would take a 255 mm of these figures for its response. */
#define LOOKS_LIKE_2 0x00FF, 0x0500, 0x0000, 0xB401

/* The driver asks meanwhile, if it has not ended before; returns what has come of it. */
static fathom_status_t run_both(uint32_t for_us, fathom_status_t (*command)(void))
{
    fathom_status_t status = FATHOM_PENDING;
    for (uint32_t passed_us = 0; passed_us < for_us; passed_us += loop_us) {
        rig.fake.now_us += loop_us;
        if (status == FATHOM_PENDING) status = command();
        while (rig_poll() == FATHOM_OK) {
        }
    }
    return status;
}

static fathom_hps167s_configuration_t is;
static fathom_status_t ask_2(void) { return fathom_hps167s_get_configuration(&driver, &is); }

static fathom_hps167s_version_t version;
static fathom_status_t ask_1(void) { return fathom_hps167s_get_interface_version(&driver, &version); }

TEST(a_response_to_2_that_comes_by_itself_is_no_measurement)
{
    ask_too();
    hears(FATHOM_OK, 1, LOOKS_LIKE_2); /* 255 mm, while no driver asks */
    assert_int_equal(run_both(2000000, ask_2), FATHOM_ERR_NO_RESPONSE);
    hears(FATHOM_PENDING, 1, LOOKS_LIKE_2); /* asked and not answered: this may be the response */
    assert_int_equal(hps.implausible, 1);
    hears(FATHOM_PENDING, 1, 0x00FF, 0x0500, 0x0003, 0xE800); /* whatever its rate and reconnect time are */
    assert_int_equal(hps.implausible, 2);
    hears(FATHOM_OK, 1, 0xFFFF, 0x0000, 0x00FF, 0xFFFF); /* but not the abnormal packet */
    assert_int_equal(run_both(2000000, ask_1), FATHOM_ERR_NO_RESPONSE);
    hears(FATHOM_OK, 1, LOOKS_LIKE_2); /* there was another request */
}

TEST(what_was_told_last_is_no_measurement_at_any_time)
{
    static const uint16_t registers[4] = {LOOKS_LIKE_2};
    ask_too();
    hears(FATHOM_OK, 1, 1000, 0, 0, 0);
    memcpy(driver.last_configuration, registers, sizeof registers);
    hears(FATHOM_PENDING, 1, LOOKS_LIKE_2);
    assert_int_equal(hps.implausible, 1);
    hears(FATHOM_OK, 1, 0x00FF, 0x0500, 0x0000, 0xB402);
}

/* A target that stays at 255 mm, with figures that stay as well; and command #5: "If a sensor failure occurs during
 * continuous measurement, an abnormal data packet will be returned". Each is sent every 100 ms while #2 is asked. */
TEST(a_held_value_or_a_fault_is_never_taken_for_the_configuration)
{
    static const uint16_t held[][4] = {{LOOKS_LIKE_2}, {0xFFFF, 0x0000, 0x00FF, 0xFFFF}};
    for (unsigned n = 0; n != 2; n++) {
        uint8_t frame[LENGTH];
        fathom_status_t status = FATHOM_PENDING;
        (void)set_up(state);
        ask_too();
        if (n == 0) hears(FATHOM_OK, 1, LOOKS_LIKE_2);
        rig_hps_frame(frame, 1, held[n][0], held[n][1], held[n][2], held[n][3]);
        for (unsigned i = 0; i != 60 && status == FATHOM_PENDING; i++) {
            fake_trickle(&rig.fake, 60000, RIG_BYTE_US, frame, LENGTH);
            status = run_both(100000, ask_2);
        }
        assert_int_equal(status, FATHOM_ERR_MALFORMED);
        assert_int_equal(fathom_modbus_unit_responses(fathom_hps167s_unit(&driver)),
                         32); /* hps167s_info.c: the most. */
    }
}

TEST(commands_are_answered_while_frames_arrive)
{
    static const uint8_t response_1[] = {0x01, 0x03, 0x06, 0x14, 0x09, 0x1B, 0x02, 0x01, 0x00, 0x58, 0xD4};
    ask_too();
    rig_run(10000, 1000);
    PENDS(run_both(20000, ask_1));
    assert_int_equal(rig.fake.written, 1);
    fake_trickle(&rig.fake, 0, RIG_BYTE_US, example, LENGTH);
    fake_trickle(&rig.fake, 20000, RIG_BYTE_US, response_1, sizeof response_1);
    fake_trickle(&rig.fake, 50000, RIG_BYTE_US, example, LENGTH);
    assert_int_equal(run_both(100000, ask_1), FATHOM_OK);
    assert_int_equal(version.year, 2020);
    assert_int_equal(rig.samples, 2);
}

TEST(no_target_and_the_abnormal_packet_are_samples_too_and_the_limits_are_options)
{
    fathom_hps167s_limits_t limits = {.max_mm = 18000, .over_range_mm = 65500};
    fathom_hps167s_limits_t wrong = {.over_range_mm = 65535};
    hears(FATHOM_OK, 1, 65530, 0, 0, 0);
    assert_int_equal(rig.sample.kind, FATHOM_NO_TARGET);
    hears(FATHOM_OK, 1, 0xFFFF, 0, 0x00FF, 0xFFFF);
    assert_int_equal(rig.sample.kind, FATHOM_FAULT);
    assert_int_equal(fathom_hps167s_auto_set_limits(&hps, &limits), FATHOM_OK);
    assert_int_equal(fathom_hps167s_auto_set_limits(&hps, &wrong), FATHOM_ERR_ARGUMENT);
    hears(FATHOM_ERR_MALFORMED, 1, 18001, 0, 0, 0);
    hears(FATHOM_OK, 1, 65500, 0, 0, 0);
    assert_int_equal(rig.sample.kind, FATHOM_NO_TARGET);
}
