/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake_modbus.h"
#include "fathom/codec/dyp_55aa.h"
#include "fathom/sensor/a05_dyp.h"
#include "fathom/sensor/a05_modbus.h"

/* The misprints in the datasheet of the A05, one test each: what is printed is refused, what is right is taken. Of the
 * A16 the start byte is in test_frames.c; that the two speeds of sound of A16 1(4) differ is in tests/unit, with
 * the pulse; the HPS-167S has a file of its own. */

TEST(a05_2_3_3_prints_60_as_the_sum_of_the_response_which_is_62)
{
    /* 55 + AA + 01 + 01 + 03 + E8 + 07 + D0 + 07 + A1 + 0D + EA = 462; 60 is the sum of the frame of 1(3) */
    uint8_t response[] = {0x55, 0xAA, 0x01, 0x01, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x60};
    assert_false(fathom_dyp_55aa_is_valid(response, sizeof response));
    response[12] = 0x62;
    assert_true(fathom_dyp_55aa_is_valid(response, sizeof response));
}

TEST(a05_2_3_5_prints_command_10_for_setting_the_address_which_is_03)
{
    /* its own example: 55 AA 05 03, sum 07, and the same as the response */
    static const uint8_t example[] = {0x55, 0xAA, 0x05, 0x03, 0x07};
    uint8_t request[FATHOM_DYP_REQUEST_LENGTH];
    assert_int_equal(fathom_dyp_55aa_encode_request(request, 5, FATHOM_DYP_SET_ADDRESS), sizeof example);
    assert_memory_equal(request, example, sizeof example);
    assert_int_not_equal(FATHOM_DYP_SET_ADDRESS, 0x10);
}

TEST(a05_2_3_5_prints_a_response_with_a_distance_and_it_has_none)
{
    static const uint8_t example[] = {0x55, 0xAA, 0x05, 0x03, 0x07};
    assert_int_equal(fathom_dyp_55aa_response_length(FATHOM_DYP_SET_ADDRESS), 5);
    assert_int_equal(fathom_dyp_55aa_value_count(FATHOM_DYP_SET_ADDRESS), 0);
    assert_int_equal(fathom_dyp_55aa_frame_length(example, 4), 5);
    assert_true(fathom_dyp_55aa_is_valid(example, sizeof example));
}

TEST(a05_2_3_prints_data_1h_twice_and_the_second_is_data_1l)
{
    /* the example: 03E8 is 1000, 07D0 2000; of two high bytes it would be 0303 and 0707 */
    static const uint8_t response[] = {0x55, 0xAA, 0x01, 0x01, 0x03, 0xE8, 0x07,
                                       0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x62};
    uint16_t values[4] = {0, 0, 0, 0};
    fathom_dyp_55aa_decode(response, values);
    assert_int_equal(values[0], 1000);
    assert_int_equal(values[1], 2000);
}

/* ---- A05 3(3): asked through the driver, with a transport that answers at once ---- */

static uint8_t head[6];

static fathom_status_t submit(fathom_line_t *line, fathom_modbus_request_t *request)
{
    (void)line;
    memcpy(head, request->message.head, sizeof head);
    for (uint8_t i = 0; i != head[5]; i++) request->message.values[i] = (uint16_t)(1000u + head[3] + i);
    request->transaction.attempts = 1;
    request->transaction.status = FATHOM_OK;
    request->transaction.link.heard_us = 0;
    return FATHOM_PENDING;
}

/* The one wanted probe of an A05 whose registers begin there: what is asked, and as which probe it comes. */
static uint8_t probe_of(uint8_t wanted, uint16_t registers)
{
    fake_modbus_t bus;
    const fathom_modbus_t modbus = {.line = &bus.line, .submit = submit};
    const fathom_a05_modbus_config_t config = {.probes = wanted, .registers = registers};
    fathom_a05_modbus_t sensor;
    fathom_sample_t sample;
    fake_modbus_init(&bus);
    assert_int_equal(fathom_a05_modbus_init(&sensor, &modbus, &config), FATHOM_OK);
    const fathom_sensor_t driver = fathom_a05_modbus_sensor(&sensor);
    assert_int_equal(fathom_poll(&driver, &sample), FATHOM_PENDING);
    assert_int_equal(fathom_poll(&driver, &sample), FATHOM_OK);
    return sample.probe;
}

TEST(a05_3_3_prints_0109_as_probe_3_and_it_is_probe_4)
{
    static const uint8_t asked[] = {0x01, 0x03, 0x01, 0x09, 0x00, 0x01};
    assert_int_equal(probe_of(0x08, FATHOM_A05_REGISTERS), 4);
    assert_memory_equal(head, asked, sizeof asked);
}

TEST(a05_3_3_prints_that_four_registers_are_those_of_three)
{
    /* remark 2: 0010 to 0013 "have the same function as 0106 to 0108": it is 0109 */
    for (uint8_t probe = 1; probe <= 4; probe++) {
        assert_int_equal(probe_of((uint8_t)(1u << (probe - 1)), FATHOM_A05_REGISTERS_ALIAS), probe);
        assert_int_equal(head[2] * 256 + head[3], 0x0010 + probe - 1);
        assert_int_equal(probe_of((uint8_t)(1u << (probe - 1)), FATHOM_A05_REGISTERS), probe);
        assert_int_equal(head[2] * 256 + head[3], 0x0106 + probe - 1);
    }
}
