/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "desk.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/sensor/a16_modbus.h"

/* What test_driver_contract.c does not ask of every driver. */

static fathom_a16_modbus_config_t config;
static const fathom_modbus_t *transport;
static fathom_a16_modbus_t a16;
static fathom_modbus_t modbus;

static int set_up(void **state)
{
    desk_begin(5000);
    config = (fathom_a16_modbus_config_t){0};
    transport = &fake.modbus;
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static fathom_sensor_t start(fathom_a16_modbus_t *sensor)
{
    memset(sensor, 0x5A, sizeof *sensor);
    assert_int_equal(fathom_a16_modbus_init(sensor, transport, &config), FATHOM_OK);
    return fathom_a16_modbus_sensor(sensor);
}

/* A16 6(3): 0101; 0100 is the processed value. */
TEST(the_real_time_value_is_asked_with_300_ms)
{
    config.value = FATHOM_REAL_TIME;
    desk.sensor = start(&a16);
    for (unsigned i = 1; i <= 2; i++) {
        desk_waits(2000000);
        fake_modbus_assert_asked(&fake, i, 1, 0x0101, 1);
        assert_int_equal(fake.request->transaction.timeout_us, 300000);
        config.value = FATHOM_PROCESSED; /* read by init only */
        desk_says(751);
        assert_int_equal(desk_poll(), FATHOM_OK);
    }
}

/* ---- over a line ---- */

static void start_line(void)
{
    rig_start(RIG_START_US);
    modbus = fathom_modbus_client(&rig.line);
    transport = &modbus;
}

/* A16 6(4) examples 1 and 2, byte for byte. */
static const uint8_t requests[][8] = {{0x01, 0x03, 0x01, 0x00, 0x00, 0x01, 0x85, 0xF6},
                                      {0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36}};
static const uint8_t responses[][7] = {{0x01, 0x03, 0x02, 0x02, 0xF2, 0x38, 0xA1},
                                       {0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8}};

TEST(the_examples_of_the_datasheet_go_over_a_line)
{
    for (uint8_t i = 0; i != 2; i++) {
        start_line();
        config.value = i;
        config.modbus.timeout_us = 1000000;
        rig.sensor = start(&a16);
        assert_int_equal(rig_transaction(rig_poll, requests[i], 8, responses[i], 7), FATHOM_OK);
        assert_int_equal(rig.sample.distance_mm, i == 0 ? 754 : 751);
    }
}
