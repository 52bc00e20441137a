/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "fathom/engine/modbus_client.h"
#include "hps_desk.h"

/* Commands #1, #3 and #5; test_driver_contract.c has what every driver promises. */

enum { PACE_US = 18519 };

static fathom_hps167s_version_t version;
static fathom_hps167s_details_t details;

static const uint16_t detailed[11] = {0xB000, 0x3900, 0x2542, 0x3457, 0x1420, 0x3438,
                                      0x3501, 0x0607, 0x0513, 0x0917, 0x0309};

/* These three at their one right length (tables 9, 13, 17), and nothing else whatever happened: 0009 is
 * a factory reset. */
static int nothing_else_was_sent(void **state)
{
    static const uint8_t allowed[3][5] = {{3, 0, 1, 0, 3}, {3, 0, 3, 0, 11}, {3, 0, 8, 0, 4}};
    for (unsigned i = 0; i != fake.submits; i++) {
        unsigned found = 0;
        for (unsigned n = 0; n != 3; n++) found += memcmp(fake.log[i] + 1, allowed[n], 5) == 0;
        if (found == 1) continue;
        print_error("sent: function %u, first %02X%02X\n", fake.log[i][1], fake.log[i][2], fake.log[i][3]);
        return -1;
    }
    return 0;
}

static const suite_t suite = {.set_up = hps_set_up, .tear_down = nothing_else_was_sent};

static fathom_status_t ask_version(void)
{
    memset(&version, GUARD, sizeof version);
    const fathom_status_t status = fathom_hps167s_get_interface_version(&hps, &version);
    if (status != FATHOM_OK) assert_guard(&version, sizeof version);
    return status;
}

static fathom_status_t ask_details(void)
{
    memset(&details, GUARD, sizeof details);
    const fathom_status_t status = fathom_hps167s_get_details(&hps, &details);
    if (status != FATHOM_OK) assert_guard(&details, sizeof details);
    return status;
}

static fathom_status_t after(uint32_t us, fathom_status_t (*call)(void))
{
    fake.now_us += us;
    return call();
}

static void is_after(uint32_t us, fathom_status_t (*call)(void), fathom_status_t status)
{
    assert_int_equal(after(us, call), status);
}

/* ---- measurements ---- */

TEST(the_least_period_is_at_most_54_a_second) { assert_true(54 * FATHOM_HPS167S_MIN_PERIOD_US >= 1000000); }

/* Command #5: distance, ambient and precision all FF, magnitude 00; what the exponent is stands nowhere. */
TEST(the_abnormal_packet_is_a_fault)
{
    static const uint16_t exponents[] = {0x0000, 0x1100, 0xFF00};
    for (uint16_t i = 0; i != 3; i++) {
        PLAY(desk_poll, OK, HPS_5(OK, 0xFFFF, 0x0000, exponents[i] | 0xFF, 0xFFFF));
        assert_sample(&desk.sample, (fathom_sample_t){.time_us = fake.heard_us,
                                                      .raw = 65535,
                                                      .sequence = (uint16_t)(i + 1),
                                                      .precision = 65535,
                                                      .kind = FATHOM_FAULT,
                                                      .model = FATHOM_HPS167S,
                                                      .address = 1,
                                                      .probe = 1,
                                                      .ambient = 255});
    }
}

/* ---- commands ---- */

TEST(details_with_any_other_ack_byte_are_malformed)
{
    uint16_t registers[11];
    memcpy(registers, detailed, sizeof registers);
    for (unsigned ack = 0; ack != 256; ack++) {
        registers[0] = (uint16_t)(ack * 256);
        is_after(PACE_US, ask_details, FATHOM_PENDING);
        fake_modbus_response(&fake, registers, 11);
        is_after(9000, ask_details, ack == 0xB0 ? OK : FATHOM_ERR_MALFORMED);
        assert_int_equal(nothing_else_was_sent(NULL), 0);
        fake.submits = 0;
    }
}

/* ---- over a line ---- */

static void start_line(void)
{
    static fathom_modbus_t modbus;
    rig_start(RIG_START_US);
    modbus = fathom_modbus_client(&rig.line);
    hps_transport = &modbus;
    hps_start();
    rig.sensor = desk.sensor;
}

TEST(commands_1_3_and_5_go_over_a_line_byte_for_byte)
{
    static const uint8_t ask_5[] = {0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB}; /* table 17 */
    static const uint8_t say_5[] = {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2,
                                    0x07, 0x01, 0x00, 0x00, 0xFD, 0x41};
    static const uint8_t ask_3[] = {0x01, 0x03, 0x00, 0x03, 0x00, 0x0B, 0xF4, 0x0D}; /* table 13 */
    static const uint8_t ask_1[] = {0x01, 0x03, 0x00, 0x01, 0x00, 0x03, 0x54, 0x0B}; /* table 9 */
    static const uint8_t say_1[] = {0x01, 0x03, 0x06, 0x14, 0x09, 0x1B, 0x02, 0x01, 0x00, 0x58, 0xD4};
    static const uint8_t say_3[] = {0x01, 0x03, 0x16, 0xB0, 0x00, 0x39, 0x00, 0x25, 0x42,
                                    0x34, 0x57, 0x14, 0x20, 0x34, 0x38, 0x35, 0x01, 0x06,
                                    0x07, 0x05, 0x13, 0x09, 0x17, 0x03, 0x09, 0x1A, 0xDC};
    start_line();
    assert_int_equal(rig_transaction(rig_poll, ask_5, 8, say_5, sizeof say_5), OK);
    assert_int_equal(rig.sample.distance_mm, 2083);
    assert_int_equal(rig.sample.magnitude, 7231744);
    assert_int_equal(rig_transaction(ask_details, ask_3, 8, say_3, sizeof say_3), OK);
    assert_int_equal(details.year, 2019);
    assert_int_equal(rig_transaction(ask_version, ask_1, 8, say_1, sizeof say_1), OK);
    assert_int_equal(version.year, 2020);
    assert_int_equal(version.revision, 0);
}

/* 27 bytes for the details (hps167s.h), 13 for a measurement. */
TEST(a_line_with_less_room_than_a_response_says_capacity)
{
    start_line();
    rig.line_parts.frame_size = 26;
    assert_int_equal(ask_details(), FATHOM_ERR_CAPACITY);
    rig.line_parts.frame_size = 12;
    assert_int_equal(rig_poll(), FATHOM_ERR_CAPACITY);
    rig.line_parts.frame_size = 13;
    PENDS(rig_poll());
    PENDS(ask_version());
}
