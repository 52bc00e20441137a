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
static const fathom_modbus_unit_request_t read_200 = {values, 0x0200, 1, 3, 0xA0};
static const fathom_modbus_unit_request_t read_100 = {values, 0x0100, 1, 3, 0x90};
static const fathom_modbus_unit_request_t write_200 = {NULL, 0x0200, 1, WRITE, 0xE0};
static const fathom_modbus_unit_request_t write_201 = {NULL, 0x0201, 1, WRITE, 0xE1};

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

/* Is the request asked after the time, and not one microsecond sooner? */
static void asked_after(uint32_t us, const fathom_modbus_unit_request_t *request)
{
    const unsigned before = fake.submits;
    pending_after(us - 1, request);
    assert_int_equal(fake.submits, before);
    pending_after(1, request);
    assert_int_equal(fake.submits, before + 1);
}

/* ---- the pace: "from this request to the next one to the unit, at least" ---- */

/* It has not left, so nothing was counted down; another driver's requests may hold it for long. */
TEST(the_pace_begins_when_a_request_ends_that_was_never_sent)
{
    pending_after(0, &measure);
    for (unsigned n = 0; n != 10; n++) pending_after(PACE_US, &measure);
    fathom_modbus_unit_cancel(&unit);
    asked_after(PACE_US, &measure);
}

/* Settings that the port cannot do, or a port that breaks, end a request before it is sent. */
TEST(a_request_that_the_line_ends_unsent_is_not_asked_again_before_its_pace)
{
    static const fathom_status_t ends[] = {FATHOM_ERR_UNSUPPORTED, FATHOM_ERR_PORT};
    for (unsigned i = 0; i != 2; i++) {
        set_up(state);
        pending_after(0, &measure);
        fake.ends = ends[i];
        assert_int_equal(ask_after(0, &measure), ends[i]);
        asked_after(PACE_US, &measure);
    }
}

/* The request leaves within the poll of another user of the line; its unit hears of that by being cancelled. */
TEST(a_cancelled_request_does_not_begin_its_pace_anew_at_the_next_call)
{
    pending_after(0, &measure);
    fake_modbus_send(&fake);
    fathom_line_poll(&fake.line);
    fathom_modbus_unit_cancel(&unit);
    asked_after(PACE_US, &measure);
}

/* ---- commands and the repeated request ---- */

/* "A command waits for nothing but another command and for what is on its way; the repeated request lets commands
 * pass": whatever its register is. */
TEST(the_repeated_request_lets_every_command_pass_that_waits)
{
    static const fathom_modbus_unit_request_t *const commands[] = {&version, &read_200, &write_200};
    for (unsigned i = 0; i != 3; i++) {
        set_up(state);
        ask_and_send(&measure);
        pending_after(0, commands[i]);
        fake_modbus_response(&fake, response, 1);
        assert_int_equal(ask_after(PACE_US, &measure), FATHOM_OK);
        pending_after(0, &measure);
        assert_int_equal(fake.submits, 1);
        pending_after(0, commands[i]);
        assert_int_equal(fake.submits, 2);
    }
}

TEST(a_command_is_told_busy_while_another_waits)
{
    ask_and_send(&measure);
    pending_after(0, &read_100);
    assert_int_equal(ask_after(0, &read_200), FATHOM_ERR_BUSY);
}

/* "FATHOM_ERR_BUSY: another command ... is not finished", or its outcome was not taken. */
TEST(writes_of_neighbouring_registers_are_two_commands)
{
    ask_and_send(&write_200);
    assert_int_equal(ask_after(0, &write_201), FATHOM_ERR_BUSY);
    fake_modbus_acknowledge(&fake);
    assert_int_equal(ask_after(0, &write_201), FATHOM_ERR_BUSY);
    assert_int_equal(ask_after(0, &write_200), FATHOM_OK);
    pending_after(PACE_US, &write_201);
    assert_int_equal(fake.submits, 2);
}

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

/* ---- "FATHOM_ERR_PORT: ... and nothing was asked" ---- */

static void break_port(void)
{
    fake_modbus_fail(&fake, FATHOM_ERR_PORT);
    fake.transport = FATHOM_ERR_PORT;
}

TEST(a_waiting_command_that_was_told_of_a_broken_port_keeps_no_turn)
{
    ask_and_send(&measure);
    pending_after(0, &version);
    break_port();
    assert_int_equal(ask_after(0, &version), FATHOM_ERR_PORT);
    fake.transport = FATHOM_PENDING;
    assert_int_equal(ask_after(PACE_US, &measure), FATHOM_ERR_PORT); /* its own outcome */
    pending_after(0, &measure);
    assert_int_equal(fake.submits, 2);
}

TEST(a_waiting_command_keeps_its_turn_when_another_request_ends_with_the_broken_port)
{
    ask_and_send(&measure);
    pending_after(0, &version);
    break_port();
    assert_int_equal(ask_after(0, &measure), FATHOM_ERR_PORT); /* its own outcome */
    assert_int_equal(ask_after(0, &measure), FATHOM_ERR_PORT);
    assert_int_equal(ask_after(0, &read_200), FATHOM_ERR_PORT);
    fake.transport = FATHOM_PENDING;
    pending_after(PACE_US, &measure);
    assert_int_equal(ask_after(0, &read_200), FATHOM_ERR_BUSY);
    assert_int_equal(fake.submits, 1);
    pending_after(0, &version);
    assert_int_equal(fake.submits, 2);
}
