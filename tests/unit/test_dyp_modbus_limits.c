/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake_modbus.h"
#include "fathom/sensor/a05_modbus.h"
#include "fathom/sensor/a16_settings.h"

/* a05_modbus.h and a16_modbus.h, a16_settings.h: what their registers and configs can say, to the end of the range. */

static fake_modbus_t fake;
static fathom_a05_modbus_t a05;
static fathom_a16_modbus_t a16;
static fathom_sensor_t sensor;
static fathom_sample_t sample;

static void start_a05(uint32_t backoff_us)
{
    const fathom_a05_modbus_config_t config = {.modbus.backoff_us = backoff_us};
    fake_modbus_init(&fake);
    memset(&a05, 0x5A, sizeof a05);
    assert_int_equal(fathom_a05_modbus_init(&a05, &fake.modbus, &config), FATHOM_OK);
    sensor = fathom_a05_modbus_sensor(&a05);
}

static void start_a16(uint32_t backoff_us)
{
    const fathom_a16_modbus_config_t config = {.modbus.backoff_us = backoff_us};
    fake_modbus_init(&fake);
    memset(&a16, 0x5A, sizeof a16);
    assert_int_equal(fathom_a16_modbus_init(&a16, &fake.modbus, &config), FATHOM_OK);
    sensor = fathom_a16_modbus_sensor(&a16);
}

static fathom_status_t poll_after(uint32_t us)
{
    fake.now_us += us;
    return fathom_poll(&sensor, &sample);
}

static void is_asked_and_sent(void)
{
    assert_int_equal(poll_after(0), FATHOM_PENDING);
    fake_modbus_send(&fake);
    assert_int_equal(poll_after(0), FATHOM_PENDING);
}

/* Four silences, each 2 s after the request: then it is left alone for two time-outs of 1.2 s or 1 s, or for no longer
 * than the config says. The pace has long passed. */
static void is_left_alone_for(uint32_t us)
{
    for (unsigned n = 0; n != 4; n++) {
        is_asked_and_sent();
        fake_modbus_fail(&fake, FATHOM_ERR_NO_RESPONSE);
        assert_int_equal(poll_after(2000000), FATHOM_ERR_NO_RESPONSE);
        if (n != 3) fake.now_us += sensor.due_us(sensor.ctx);
    }
    assert_int_equal(sensor.due_us(sensor.ctx), us);
}

TEST(a_dead_a05_is_left_alone_no_longer_than_its_config_says)
{
    start_a05(123456);
    is_left_alone_for(123456);
}

TEST(a_dead_a16_is_left_alone_no_longer_than_its_config_says)
{
    start_a16(123456);
    is_left_alone_for(123456);
}

/* FATHOM_DYP_DEFAULT_START_US: "how long after power-on silence is no error": 1.5 s. */
TEST(after_power_on_silence_is_no_error_for_1500_ms)
{
    for (unsigned late = 0; late != 2; late++) {
        start_a05(0);
        fathom_a05_modbus_power_on(&a05);
        is_asked_and_sent();
        fake_modbus_fail(&fake, FATHOM_ERR_NO_RESPONSE);
        assert_int_equal(poll_after(1499999 + late),
                         late == 0 ? FATHOM_ERR_WARMING_UP : FATHOM_ERR_NO_RESPONSE);
    }
}

/* "what was under way is forgotten": the other three probes of a response too. */
TEST(after_power_on_no_sample_of_before_is_handed_over)
{
    static const uint16_t four[] = {1000, 2000, 3000, 4000};
    start_a05(0);
    is_asked_and_sent();
    fake_modbus_response(&fake, four, 4);
    assert_int_equal(poll_after(0), FATHOM_OK);
    assert_int_equal(sample.distance_mm, 1000);
    fathom_a05_modbus_power_on(&a05);
    assert_int_equal(poll_after(0), FATHOM_PENDING);
    assert_int_equal(fake.submits, 2);
}

/* "FATHOM_ERR_MALFORMED, where the register says more than 255". */
TEST(an_address_register_says_up_to_255)
{
    static const uint16_t is_255[] = {255};
    static const uint16_t is_256[] = {256};
    uint8_t address = 0;
    start_a05(0);
    assert_int_equal(fathom_a05_modbus_get_address(&a05, &address), FATHOM_PENDING);
    fake_modbus_response(&fake, is_255, 1);
    assert_int_equal(fathom_a05_modbus_get_address(&a05, &address), FATHOM_OK);
    assert_int_equal(address, 255);
    fake.now_us += 1000000;
    assert_int_equal(fathom_a05_modbus_get_address(&a05, &address), FATHOM_PENDING);
    fake_modbus_response(&fake, is_256, 1);
    assert_int_equal(fathom_a05_modbus_get_address(&a05, &address), FATHOM_ERR_MALFORMED);
    assert_int_equal(address, 255);
}

/* a16_settings.h, FATHOM_ERR_MALFORMED: "a value that the register cannot have": 0100 has a low byte of 0. */
TEST(a_register_that_is_0_or_1_is_not_0100)
{
    static const uint16_t is_0100[] = {0x0100};
    fathom_a16_polarity_t polarity = FATHOM_A16_POSITIVE;
    start_a16(0);
    assert_int_equal(fathom_a16_modbus_get_switch_polarity(&a16, &polarity), FATHOM_PENDING);
    fake_modbus_response(&fake, is_0100, 1);
    assert_int_equal(fathom_a16_modbus_get_switch_polarity(&a16, &polarity), FATHOM_ERR_MALFORMED);
    assert_int_equal(polarity, FATHOM_A16_POSITIVE);
}

/* "FATHOM_ERR_ARGUMENT: out of range; nothing was sent": not 256 either, where an enumeration can hold it at all. */
TEST(a_choice_of_256_is_refused)
{
    start_a16(0);
    if (sizeof(fathom_dyp_value_t) == 1) return;
    assert_int_equal(fathom_a16_modbus_measure(&a16, (fathom_dyp_value_t)256, &sample), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_a16_modbus_set_operating_mode(&a16, (fathom_a16_operating_mode_t)256),
                     FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_a16_modbus_set_switch_polarity(&a16, (fathom_a16_polarity_t)256),
                     FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_a16_modbus_set_automatic_value(&a16, (fathom_dyp_value_t)256),
                     FATHOM_ERR_ARGUMENT);
    assert_int_equal(fake.submits, 0);
}

/* dyp_modbus.h: "of registers that differ in their bits 0 to 3, 8 or 9"; one is under way, and the other has to
 * wait. */
TEST(commands_of_two_registers_are_told_apart)
{
    static const uint16_t registers[] = {0x0010, 0x0011, 0x0110, 0x0210};
    uint16_t value = 0;
    for (unsigned i = 0; i != 4; i++)
        for (unsigned j = 0; j != 4; j++) {
            start_a16(0);
            assert_int_equal(fathom_dyp_modbus_get_register(&a16.base, registers[i], &value), FATHOM_PENDING);
            assert_int_equal(fathom_dyp_modbus_get_register(&a16.base, registers[j], &value),
                             i == j ? FATHOM_PENDING : FATHOM_ERR_BUSY);
        }
}
