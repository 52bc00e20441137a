/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake.h"
#include "fathom/hps167s_info.h"
#include "fathom/modbus_client.h"

/* The driver over a real line, at 19200 8E1: a character is 573 us, t3.5 is 2006 us. */

static fathom_hps167s_t hps;
static fathom_sample_t sample;
static fathom_hps167s_version_t version;
static fathom_hps167s_details_t details;

TEST(commands_3_and_5_go_over_a_line_byte_for_byte)
{
    static const uint8_t ask_5[] = {0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB}; /* table 17 */
    static const uint8_t say_5[] = {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2,
                                    0x07, 0x01, 0x00, 0x00, 0xFD, 0x41};
    static const uint8_t ask_3[] = {0x01, 0x03, 0x00, 0x03, 0x00, 0x0B, 0xF4, 0x0D}; /* table 13 */
    static const uint8_t say_3[] = {0x01, 0x03, 0x16, 0xB0, 0x00, 0x39, 0x00, 0x25, 0x42,
                                    0x34, 0x57, 0x14, 0x20, 0x34, 0x38, 0x35, 0x01, 0x06,
                                    0x07, 0x05, 0x13, 0x09, 0x17, 0x03, 0x09, 0x1A, 0xDC};
    static fake_t uart;
    uint8_t frame[27];
    fathom_line_t line;
    fathom_status_t status = FATHOM_PENDING;
    fake_init(&uart);
    uart.byte_us = 573;
    const fathom_line_config_t line_config = {&uart.uart, &uart.clock, frame, 27, FATHOM_LINE_ECHO_AUTO,
                                              2006,       5000};
    assert_int_equal(fathom_line_init(&line, &line_config), FATHOM_READY);
    const fathom_modbus_t modbus = fathom_modbus_client(&line);
    const fathom_hps167s_config_t config = {.modbus = &modbus, .clock = &uart.clock};
    assert_int_equal(fathom_hps167s_init(&hps, &config), FATHOM_READY);
    const fathom_sensor_t sensor = fathom_hps167s_sensor(&hps);
    for (unsigned i = 0; i != 300 && status == FATHOM_PENDING; i++) {
        uart.now_us += 100;
        status = fathom_poll(&sensor, &sample);
        if (i == 100) fake_trickle(&uart, 0, 573, say_5, sizeof say_5);
    }
    assert_int_equal(status, FATHOM_READY);
    assert_int_equal(sample.distance_mm, 2083);
    assert_int_equal(sample.magnitude, 7231744);
    assert_memory_equal(uart.writes[0].bytes, ask_5, 8);

    status = FATHOM_PENDING;
    for (unsigned i = 0; i != 600 && status == FATHOM_PENDING; i++) {
        uart.now_us += 100;
        status = fathom_hps167s_details(&hps, &details);
        if (i == 300) fake_trickle(&uart, 0, 573, say_3, sizeof say_3);
    }
    assert_int_equal(status, FATHOM_READY);
    assert_int_equal(details.year, 2019);
    assert_int_equal(uart.written, 2);
    assert_memory_equal(uart.writes[1].bytes, ask_3, 8);
}

/* 27 bytes for the details (hps167s.h), 13 for a measurement. */
TEST(a_line_with_less_room_than_an_answer_says_capacity)
{
    static fake_t uart;
    uint8_t frame[26];
    fathom_line_t line;
    fake_init(&uart);
    fathom_line_config_t line_config = {&uart.uart, &uart.clock, frame, 26, FATHOM_LINE_ECHO_AUTO,
                                        2006,       5000};
    assert_int_equal(fathom_line_init(&line, &line_config), FATHOM_READY);
    const fathom_modbus_t modbus = fathom_modbus_client(&line);
    const fathom_hps167s_config_t config = {.modbus = &modbus, .clock = &uart.clock};
    assert_int_equal(fathom_hps167s_init(&hps, &config), FATHOM_READY);
    const fathom_sensor_t sensor = fathom_hps167s_sensor(&hps);
    assert_int_equal(fathom_hps167s_details(&hps, &details), FATHOM_ERR_CAPACITY);
    line_config.frame_size = 12;
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_ERR_CAPACITY);
    line_config.frame_size = 13;
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_PENDING);
    assert_int_equal(fathom_hps167s_interface_version(&hps, &version), FATHOM_PENDING);
}
