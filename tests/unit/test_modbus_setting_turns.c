/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake_modbus.h"
#include "fathom/engine/internal/modbus_setting.h"

/* modbus_setting.h, beside other requests to the same unit and after another setting. The value is in register
 * 0x0206. */
enum { HERE = 1, THERE = 5, OLD = 1000, NEW = 2000, PACE_US = 100000 };

static fake_modbus_t fake;
static fathom_modbus_unit_t unit;
static uint16_t found;
static fathom_modbus_setting_t setting;
static const uint16_t old_value[] = {OLD};
static const uint16_t new_value[] = {NEW};

static const fathom_line_settings_t fast = {57600, FATHOM_PARITY_EVEN, 1};

static const fathom_modbus_unit_request_t look = {&found, 0x0206, 1, 3, 0x81};
static const fathom_modbus_unit_request_t put = {NULL, 0x0206, NEW, 6, 0xC1};
static const fathom_modbus_unit_request_t measure = {&found, 0x0100, 1, 3, 1};

static fathom_status_t read_it(const fathom_modbus_setting_t *of, uint32_t *value)
{
    const fathom_status_t status = ask_unit(of->driver, &look);
    if (status == FATHOM_OK) *value = found;
    return status;
}

static int set_up(void **state)
{
    fake_modbus_init(&fake);
    memset(&unit, 0, sizeof unit);
    assert_int_equal(init_unit(&unit, &fake.modbus,
                               &(fathom_modbus_config_t){.address = HERE, .command_timeout_us = 1000}, 1000,
                               PACE_US),
                     FATHOM_OK);
    setting = (fathom_modbus_setting_t){.read = read_it, .driver = &unit, .write = put, .value = NEW};
    found = 0;
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static fathom_status_t set_after(uint32_t us)
{
    fake.now_us += us;
    fathom_modbus_unit_poll(&unit);
    return fathom_modbus_set(&unit, &setting);
}

static fathom_status_t ask(const fathom_modbus_unit_request_t *request)
{
    fathom_modbus_unit_poll(&unit);
    return ask_unit(&unit, request);
}

/* The setting's next request is on the wire: to whom, with which line settings? */
static void asks(uint8_t address, const fathom_line_settings_t *settings)
{
    const unsigned before = fake.submits;
    assert_int_equal(set_after(0), FATHOM_PENDING); /* the one before ends */
    assert_int_equal(set_after(PACE_US), FATHOM_PENDING);
    assert_int_equal(fake.submits, before + 1);
    assert_int_equal(fake.log[before][0], address);
    assert_ptr_equal(fake.request->transaction.line_settings, settings);
}

/* modbus_unit.h, FATHOM_ERR_BUSY: "another command or setting is not finished". It would be asked at the new address,
 * and its outcome taken for the setting's. */
TEST(between_two_steps_of_a_setting_its_own_command_is_busy_for_others)
{
    setting.address = THERE;
    asks(HERE, NULL);
    fake_modbus_response(&fake, old_value, 1);
    assert_int_equal(set_after(0), FATHOM_PENDING); /* the next one waits for the pace */
    assert_int_equal(fake.submits, 1);
    assert_int_equal(ask(&look), FATHOM_ERR_BUSY);
    fake.now_us += PACE_US;
    assert_int_equal(ask(&look), FATHOM_ERR_BUSY);
    assert_int_equal(ask(&measure), FATHOM_PENDING);
    assert_int_equal(fake.submits, 1);
    asks(THERE, NULL);
}

/* modbus_unit.h: "each outcome once". The measurement was asked before the setting began. */
TEST(a_measurement_on_the_wire_when_a_setting_begins_is_handed_over)
{
    assert_int_equal(ask(&measure), FATHOM_PENDING);
    fake_modbus_send(&fake);
    assert_int_equal(set_after(0), FATHOM_PENDING);
    fake_modbus_response(&fake, old_value, 1);
    assert_int_equal(ask(&measure), FATHOM_OK);
    assert_int_equal(found, OLD);
    assert_int_equal(ask(&measure), FATHOM_PENDING);
    asks(HERE, NULL);
}

/* fathom_modbus_setting_t: "settings ... NULL: as before": as the setting before has made them. */
TEST(a_new_address_is_confirmed_with_the_line_settings_that_the_device_has_by_now)
{
    setting.line_settings = &fast;
    asks(HERE, NULL);
    fake_modbus_response(&fake, old_value, 1);
    asks(HERE, NULL);
    fake_modbus_acknowledge(&fake);
    asks(HERE, &fast);
    fake_modbus_response(&fake, new_value, 1);
    assert_int_equal(set_after(0), FATHOM_OK);

    setting.line_settings = NULL;
    setting.address = THERE;
    asks(HERE, &fast);
    fake_modbus_response(&fake, old_value, 1);
    asks(THERE, &fast);
    fake_modbus_fail(&fake, FATHOM_ERR_NO_RESPONSE);
    asks(HERE, &fast);
    fake_modbus_acknowledge(&fake);
    asks(THERE, &fast);
    fake_modbus_response(&fake, new_value, 1);
    assert_int_equal(set_after(0), FATHOM_OK);
    assert_int_equal(unit.address, THERE);
    assert_ptr_equal(unit.line_settings, &fast);
}
