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

TEST(a_new_unit_has_heard_nothing_and_may_be_asked_at_once)
{
    static const uint8_t fills[] = {0xA5, 0xFF};
    for (unsigned i = 0; i != sizeof fills; i++) {
        set_up_on(fills[i]);
        assert_int_equal(fathom_modbus_unit_responses(&unit), 0);
        assert_int_equal(fathom_modbus_unit_failures(&unit), 0);
        assert_int_equal(unit.address, UNIT);
        assert_int_equal(fathom_modbus_unit_exception(&unit), 0);
        assert_null(unit.line_settings);
        assert_false(fathom_modbus_unit_is_warming_up(&unit));
        assert_int_equal(fathom_modbus_unit_due_us(&unit), 0);
        assert_int_equal(ask_after(0), FATHOM_PENDING);
        assert_int_equal(fake.submits, 1);
        assert_null(fake.request->transaction.line_settings);
        for (unsigned n = 0; n != 2; n++) { /* the third is the first after which it is left alone */
            silence();
            assert_int_equal(ask_after(0), FATHOM_PENDING);
            assert_int_equal(fake.submits, n + 2);
        }
    }
}

/* "backoff_us ... up to 2^31 - 1. 0: 16 time-outs": 16 of 2^28 would be 2^32. 2^31 - 1 is the longest. */
TEST(without_a_cap_the_longest_back_off_is_2_to_the_31_less_1)
{
    static const uint32_t backoff_left_us[] = {0,          0,          0x10000000, 0x20000000,
                                               0x40000000, 0x7FFFFFFF, 0x7FFFFFFF};
    unit.timeout_us = 0x10000000;
    for (unsigned n = 0; n != sizeof backoff_left_us / sizeof *backoff_left_us; n++) {
        assert_int_equal(ask_after(0), FATHOM_PENDING);
        assert_int_equal(fake.submits, n + 1);
        silence();
        assert_int_equal(fathom_modbus_unit_due_us(&unit), backoff_left_us[n]);
        fake.now_us += backoff_left_us[n];
    }
}

/* "for warm_us ... its silence [is] FATHOM_ERR_WARMING_UP", from the call on, whenever the unit was asked last. */
TEST(warming_up_lasts_for_all_of_its_time_after_a_long_rest)
{
    fake.now_us += 10000000;
    fathom_modbus_unit_power_on(&unit, 1000000);
    assert_int_equal(ask_after(0), FATHOM_PENDING);
    assert_true(fathom_modbus_unit_is_warming_up(&unit));
    ask_after(999999);
    assert_true(fathom_modbus_unit_is_warming_up(&unit));
    ask_after(1);
    assert_false(fathom_modbus_unit_is_warming_up(&unit));
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
