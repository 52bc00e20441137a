/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake_modbus.h"
#include "fathom/a05_modbus.h"
#include "fathom/a16_settings.h"

/* A driver that has measured and then moved its device to another address: samples say where they were read. */

enum { SECOND_US = 1000000 };

static fake_modbus_t fake;
static fathom_a16_modbus_t a16;
static fathom_a05_modbus_t a05;

static fathom_status_t set_a16(uint8_t address) { return fathom_a16_set_address(&a16, address); }
static fathom_status_t set_a05(uint8_t address) { return fathom_a05_modbus_set_address(&a05, address); }

static const uint16_t one_mm[] = {1000};
static const uint16_t four_mm[] = {1000, 2000, 1953, 3562};

/* One answer is measured: from this address, and all its samples say so. */
static void assert_measures_at(fathom_sensor_t sensor, uint8_t address, const uint16_t *values, uint8_t count)
{
    fathom_sample_t sample;
    fake.now_us += SECOND_US;
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_PENDING);
    assert_non_null(fake.request);
    assert_int_equal(fake.request->message.head[0], address);
    fake_modbus_answer(&fake, values, count);
    for (uint8_t i = 0; i != count; i++) {
        assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_READY);
        assert_int_equal(sample.unit, address);
        assert_int_equal(sample.distance_mm, values[i]);
    }
}

/* What the call asks next is on its way. */
static void asks(fathom_status_t (*set)(uint8_t), uint8_t unit, uint8_t function)
{
    fake.now_us += SECOND_US;
    assert_int_equal(set(5), FATHOM_PENDING);
    assert_non_null(fake.request);
    assert_int_equal(fake.request->message.head[0], unit);
    assert_int_equal(fake.request->message.head[1], function);
}

static void moves(fathom_sensor_t sensor, fathom_status_t (*set)(uint8_t), const uint16_t *values,
                  uint8_t count)
{
    static const uint16_t old_address[] = {1};
    static const uint16_t new_address[] = {5};
    assert_measures_at(sensor, 1, values, count);
    asks(set, 1, 3);
    fake_modbus_answer(&fake, old_address, 1);
    assert_int_equal(set(5), FATHOM_PENDING);
    asks(set, 5, 3);
    fake_modbus_fail(&fake, FATHOM_ERR_NO_ANSWER);
    assert_int_equal(set(5), FATHOM_PENDING);
    asks(set, 1, 6);
    fake_modbus_acknowledge(&fake);
    assert_int_equal(set(5), FATHOM_PENDING);
    asks(set, 5, 3);
    fake_modbus_answer(&fake, new_address, 1);
    assert_int_equal(set(5), FATHOM_READY);
    assert_measures_at(sensor, 5, values, count);
}

static int set_up(void **state)
{
    fake_modbus_init(&fake);
    const fathom_a16_modbus_config_t a16_config = {.modbus = &fake.modbus, .clock = &fake.clock};
    const fathom_a05_modbus_config_t a05_config = {.modbus = &fake.modbus, .clock = &fake.clock};
    memset(&a16, 0x5A, sizeof a16);
    memset(&a05, 0x5A, sizeof a05);
    assert_int_equal(fathom_a16_modbus_init(&a16, &a16_config), FATHOM_READY);
    return fathom_a05_modbus_init(&a05, &a05_config) == FATHOM_READY ? 0 : -1;
}

static const suite_t suite = {.set_up = set_up};

TEST(an_a16_that_has_moved_measures_at_its_new_address)
{
    moves(fathom_a16_modbus_sensor(&a16), set_a16, one_mm, 1);
}

TEST(an_a05_that_has_moved_measures_at_its_new_address)
{
    moves(fathom_a05_modbus_sensor(&a05), set_a05, four_mm, 4);
}
