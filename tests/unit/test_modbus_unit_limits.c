/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake_modbus.h"
#include "fathom/engine/internal/modbus_unit.h"

/* modbus_unit.h: memory that is not zero, the longest back-off, and power-on. */
enum { UNIT = 9 };

static fake_modbus_t fake;
static fathom_modbus_unit_t unit;
static uint16_t values[1];
static const uint16_t response[1] = {754};
static const fathom_modbus_unit_request_t measure = {values, 0x0100, 1, 3, 1};

static void set_up_on(uint8_t fill)
{
    fake_modbus_init(&fake);
    memset(&unit, fill, sizeof unit);
    assert_int_equal(init_unit(&unit, &fake.modbus, &(fathom_modbus_config_t){.address = UNIT}, 100000, 0),
                     FATHOM_OK);
}

static int set_up(void **state)
{
    set_up_on(0);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static fathom_status_t ask_after(uint32_t us)
{
    fake.now_us += us;
    fathom_modbus_unit_poll(&unit);
    return ask_unit(&unit, &measure);
}

static void silence(void)
{
    fake_modbus_fail(&fake, FATHOM_ERR_NO_RESPONSE);
    assert_int_equal(ask_after(unit.timeout_us), FATHOM_ERR_NO_RESPONSE);
}

/* "what was asked is forgotten": the silences of a device without power too. */
TEST(after_power_on_a_unit_that_was_left_alone_is_asked_at_once)
{
    for (unsigned n = 0; n != 3; n++) {
        assert_int_equal(ask_after(0), FATHOM_PENDING);
        silence();
    }
    assert_int_equal(ask_after(0), FATHOM_PENDING);
    assert_int_equal(fake.submits, 3); /* it is left alone */
    fathom_modbus_unit_power_on(&unit, 0);
    assert_int_equal(fathom_modbus_unit_due_us(&unit), 0);
    assert_int_equal(ask_after(0), FATHOM_PENDING);
    assert_int_equal(fake.submits, 4);
}

TEST(after_power_on_three_time_outs_in_a_row_are_needed_again)
{
    for (unsigned n = 0; n != 3; n++) {
        assert_int_equal(ask_after(0), FATHOM_PENDING);
        silence();
    }
    fathom_modbus_unit_power_on(&unit, 0);
    for (unsigned n = 0; n != 3; n++) {
        assert_int_equal(ask_after(0), FATHOM_PENDING);
        assert_int_equal(fake.submits, n + 4);
        silence();
    }
    assert_int_equal(ask_after(0), FATHOM_PENDING);
    assert_int_equal(fake.submits, 6);
    assert_int_equal(ask_after(100000), FATHOM_PENDING);
    assert_int_equal(fake.submits, 7);
    fake_modbus_response(&fake, response, 1);
    assert_int_equal(ask_after(0), FATHOM_OK);
}
