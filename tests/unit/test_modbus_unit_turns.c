/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake_modbus.h"
#include "fathom/engine/internal/modbus_unit.h"

/* modbus_unit.h: whose turn it is, and when, where requests are cancelled, wait behind others, or the port breaks. */
enum { UNIT = 9, PACE_US = 100000, TIMEOUT_US = 300000, WRITE = FATHOM_MODBUS_WRITE_SINGLE_REGISTER };

static fake_modbus_t fake;
static fathom_modbus_unit_t unit;
static uint16_t values[3];
static const uint16_t response[3] = {1, 2, 3};

static const fathom_modbus_unit_request_t measure = {values, 0x0100, 1, 3, 1};
static const fathom_modbus_unit_request_t version = {values, 0x0001, 3, 3, 0x81};

static int set_up(void **state)
{
    fake_modbus_init(&fake);
    memset(&unit, 0, sizeof unit);
    assert_int_equal(
        init_unit(&unit, &fake.modbus, &(fathom_modbus_config_t){.address = UNIT}, TIMEOUT_US, PACE_US),
        FATHOM_OK);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static fathom_status_t ask_after(uint32_t us, const fathom_modbus_unit_request_t *request)
{
    fake.now_us += us;
    fathom_modbus_unit_poll(&unit);
    return ask_unit(&unit, request);
}

static void pending_after(uint32_t us, const fathom_modbus_unit_request_t *request)
{
    assert_int_equal(ask_after(us, request), FATHOM_PENDING);
}

static void ask_and_send(const fathom_modbus_unit_request_t *request)
{
    const unsigned before = fake.submits;
    pending_after(0, request);
    assert_int_equal(fake.submits, before + 1);
    fake_modbus_send(&fake);
    pending_after(0, request);
}

/* ---- commands and the repeated request ---- */

/* An outcome of the repeated request may be replaced by a newer one: once it has given way it is not handed over. */
TEST(an_outcome_that_gave_way_to_a_command_is_not_handed_over)
{
    ask_and_send(&measure);
    fake_modbus_response(&fake, response, 1);
    pending_after(0, &version); /* within the pace */
    pending_after(0, &measure);
    assert_int_equal(fake.submits, 1);
    pending_after(PACE_US, &version);
    assert_int_equal(fake.submits, 2);
}

/* "how long until something can happen": to take it is something. */
TEST(the_outcome_of_a_command_is_due_at_once_within_the_pace)
{
    ask_and_send(&version);
    fake_modbus_response(&fake, response, 3);
    pending_after(0, &measure); /* in which the command ends */
    assert_int_equal(fathom_modbus_unit_due_us(&unit), 0);
}
