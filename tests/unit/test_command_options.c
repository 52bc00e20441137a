/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "auto_rig.h"
#include "fake_modbus.h"
#include "fathom/a05_auto.h"
#include "fathom/a05_dyp.h"
#include "fathom/a05_modbus.h"
#include "fathom/a16_auto.h"
#include "fathom/a16_settings.h"
#include "fathom/hps167s_info.h"

/* What is not in the datasheets is an option of each driver: how long a command may take, how long a sensor may be
 * silent after power-on, and what 0, FFFD and FFFE mean. */

enum { COMMAND_US = 123456, START_US = 700000 };

static fake_modbus_t fake;

static int set_up(void **state)
{
    fake_modbus_init(&fake);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* ---- the time-out of a command, and the time after power-on ---- */

/* The command was asked with this time-out; and with silence after power-on the sensor is said to be warming up for so
 * long and no longer. */
static void assert_times(fathom_sensor_t sensor, uint32_t asked_us, uint32_t command_us, uint32_t start_us)
{
    fathom_sample_t sample;
    const uint32_t on_us = fake.now_us;
    fathom_status_t status = FATHOM_ERR_WARMING_UP;
    assert_int_equal(asked_us, command_us);
    while (status == FATHOM_ERR_WARMING_UP || status == FATHOM_PENDING) {
        assert_true(fake.now_us - on_us < 2 * start_us);
        fake.now_us += 10000;
        status = fathom_poll(&sensor, &sample);
        if (fake.request != NULL) fake_modbus_fail(&fake, FATHOM_ERR_NO_ANSWER);
    }
    assert_int_equal(status, FATHOM_ERR_NO_ANSWER);
    assert_in_range(fake.now_us - on_us, start_us, start_us + 400000);
}

TEST(an_a16s_command_and_start_take_as_long_as_the_config_says)
{
    fathom_a16_modbus_t a16;
    uint8_t address;
    for (unsigned i = 0; i != 2; i++) {
        const fathom_a16_modbus_config_t config = {.modbus = &fake.modbus,
                                                   .clock = &fake.clock,
                                                   .command_timeout_us = i * COMMAND_US,
                                                   .start_us = i * START_US};
        assert_int_equal(fathom_a16_modbus_init(&a16, &config), FATHOM_READY);
        assert_int_equal(fathom_a16_address(&a16, &address), FATHOM_PENDING);
        const uint32_t asked_us = fake.request->exchange.timeout_us;
        fathom_a16_modbus_power_on(&a16);
        assert_times(fathom_a16_modbus_sensor(&a16), asked_us, i == 0 ? 1000000 : COMMAND_US,
                     i == 0 ? 1500000 : START_US);
        fathom_a16_cancel(&a16);
    }
}

TEST(an_a05s_command_and_start_take_as_long_as_the_config_says)
{
    fathom_a05_modbus_t a05;
    uint8_t address;
    for (unsigned i = 0; i != 2; i++) {
        const fathom_a05_modbus_config_t config = {.modbus = &fake.modbus,
                                                   .clock = &fake.clock,
                                                   .command_timeout_us = i * COMMAND_US,
                                                   .start_us = i * START_US};
        assert_int_equal(fathom_a05_modbus_init(&a05, &config), FATHOM_READY);
        assert_int_equal(fathom_a05_modbus_address(&a05, &address), FATHOM_PENDING);
        const uint32_t asked_us = fake.request->exchange.timeout_us;
        fathom_a05_modbus_power_on(&a05);
        assert_times(fathom_a05_modbus_sensor(&a05), asked_us, i == 0 ? 1000000 : COMMAND_US,
                     i == 0 ? 1500000 : START_US);
        fathom_a05_modbus_cancel(&a05);
    }
}

TEST(an_a05s_start_takes_as_long_with_55_aa)
{
    static const uint32_t starts_us[] = {0, START_US};
    for (unsigned i = 0; i != 2; i++) {
        fathom_a05_dyp_t a05;
        fathom_sample_t sample;
        rig_start(RIG_START_US);
        const fathom_a05_dyp_config_t config = {.line = &rig.line, .start_us = starts_us[i]};
        assert_int_equal(fathom_a05_dyp_init(&a05, &config), FATHOM_READY);
        const fathom_sensor_t sensor = fathom_a05_dyp_sensor(&a05);
        fathom_a05_dyp_power_on(&a05);
        const uint32_t on_us = rig.fake.now_us;
        fathom_status_t status = FATHOM_PENDING;
        while (status == FATHOM_PENDING || status == FATHOM_ERR_WARMING_UP) {
            rig.fake.now_us += 1000;
            status = fathom_poll(&sensor, &sample);
        }
        assert_int_equal(status, FATHOM_ERR_NO_ANSWER);
        const uint32_t start_us = i == 0 ? 1500000 : START_US;
        assert_in_range(rig.fake.now_us - on_us, start_us, start_us + 1600000); /* a time-out, and a debt */
    }
}

TEST(an_hps167s_command_takes_as_long_as_the_config_says)
{
    for (unsigned i = 0; i != 2; i++) {
        fathom_hps167s_t hps;
        fathom_hps167s_version_t version;
        const fathom_hps167s_config_t config = {
            .modbus = &fake.modbus, .clock = &fake.clock, .command_timeout_us = i * COMMAND_US};
        assert_int_equal(fathom_hps167s_init(&hps, &config), FATHOM_READY);
        assert_int_equal(fathom_hps167s_interface_version(&hps, &version), FATHOM_PENDING);
        assert_int_equal(fake.request->exchange.timeout_us, i == 0 ? 1000000 : COMMAND_US);
        fathom_hps167s_deinit(&hps);
    }
}

/* ---- 0, FFFD and FFFE ---- */

/* FF H L SUM by hand: FF + FF + FD = 2FB, FF + FF + FE = 2FC, FF + 0 + 0 = FF. */
static const uint8_t codes[][4] = {{0xFF, 0xFF, 0xFD, 0xFB}, {0xFF, 0xFF, 0xFE, 0xFC}, {0xFF, 0, 0, 0xFF}};

TEST(the_codes_of_sister_models_are_refused_where_a_module_does_not_send_them)
{
    for (unsigned no_codes = 0; no_codes != 2; no_codes++) {
        for (size_t i = 0; i != sizeof codes / sizeof codes[0]; i++) {
            fathom_a16_auto_t a16;
            rig_start(RIG_START_US);
            const fathom_a16_auto_config_t config = {.line = &rig.line,
                                                     .window = {.no_codes = no_codes != 0}};
            assert_int_equal(fathom_a16_auto_init(&a16, &config), FATHOM_READY);
            rig.sensor = fathom_a16_auto_sensor(&a16);
            rig_send(codes[i], 4, 500);
            assert_int_equal(rig.malformed, no_codes);
            assert_int_equal(rig.samples, 1 - no_codes);
            if (no_codes == 0) assert_int_equal(rig.sample.kind, FATHOM_NO_TARGET);
        }
    }
}

TEST(without_codes_they_are_distances_if_the_window_lets_them_pass)
{
    fathom_a16_modbus_t a16;
    fathom_sample_t sample;
    static const uint16_t value = 0xFFFE;
    const fathom_a16_modbus_config_t config = {
        .modbus = &fake.modbus, .clock = &fake.clock, .window = {.max_mm = 65535, .no_codes = true}};
    assert_int_equal(fathom_a16_modbus_init(&a16, &config), FATHOM_READY);
    const fathom_sensor_t sensor = fathom_a16_modbus_sensor(&a16);
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_PENDING);
    fake_modbus_answer(&fake, &value, 1);
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_READY);
    assert_int_equal(sample.kind, FATHOM_TARGET);
    assert_int_equal(sample.distance_mm, 65534);
    assert_false(sample.interference);
}
