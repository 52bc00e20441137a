/* SPDX-License-Identifier: MIT */
#include "desk.h"
#include "fathom/engine/internal/modbus_setting.h"

/* A command or setting that its caller begins and never calls again (modbus_unit.h, rules 5 and 6). */

enum {
    UNIT = 9,
    OTHER = 5,
    TIMEOUT_US = 300000,
    ABANDONED_US = 5000000,
    STEP_US = 100000,
    SLOW_US = 7000000
};

static fathom_modbus_unit_t unit;
static uint16_t value;

static const fathom_modbus_unit_request_t measure = {&value, 0x0100, 1, 3, 1};
static const fathom_modbus_unit_request_t version = {&value, 0x0001, 1, 3, 0x81};
static const fathom_modbus_unit_request_t details = {&value, 0x0003, 1, 3, 0x83};

static fathom_status_t look(const fathom_modbus_setting_t *setting, uint32_t *is)
{
    const fathom_status_t status = ask_unit(setting->driver, &version);
    if (status == FATHOM_OK) *is = value;
    return status;
}

static const fathom_modbus_setting_t move = {look, &unit, {NULL, 0x0200, OTHER, 6, 0xC8}, OTHER, NULL, OTHER};
static const fathom_modbus_setting_t other_setting = {look, &unit, {NULL, 0x0201, 1, 6, 0xC9}, 1, NULL, 0};

static const fathom_modbus_config_t config = {.address = UNIT};

static int set_up(void **state)
{
    desk_begin(0xFFFFF000u); /* the clock wraps soon */
    memset(&unit, 0x5A, sizeof unit);
    assert_int_equal(init_unit(&unit, &fake.modbus, &config, TIMEOUT_US, 0), FATHOM_OK);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static fathom_status_t asks(const fathom_modbus_unit_request_t *request)
{
    fake.submits = 0;
    fathom_modbus_unit_poll(&unit);
    return ask_unit(&unit, request);
}

static fathom_status_t sets(const fathom_modbus_setting_t *setting)
{
    fake.submits = 0;
    fathom_modbus_unit_poll(&unit);
    return fathom_modbus_set(&unit, setting);
}

static void responds(uint16_t with) { fake_modbus_response(&fake, &with, 1); }

/* Measures every STEP_US until the measurement is on the wire, and returns how long that took. */
static uint32_t until_measuring(void)
{
    uint32_t took_us = 0;
    for (; fake.request == NULL || unit.current != measure.id; took_us += STEP_US) {
        assert_true(took_us < 2 * ABANDONED_US);
        fake.now_us += STEP_US;
        PENDS(asks(&measure));
    }
    return took_us;
}

/* Until one more call of another function finds the command abandoned. */
static void others_call(void)
{
    for (unsigned i = 1; i != ABANDONED_US / STEP_US; i++) {
        fake.now_us += STEP_US;
        PENDS(asks(&measure));
    }
    fake.now_us += STEP_US;
    fathom_modbus_unit_poll(&unit);
}

static void measures(void)
{
    responds(754);
    assert_int_equal(asks(&measure), FATHOM_OK);
}

TEST(an_abandoned_setting_gives_way_and_the_driver_stays_where_it_was)
{
    PENDS(sets(&move));
    responds(UNIT); /* it has another value: the new address is probed next */
    PENDS(sets(&move));
    assert_int_equal(unit.address, OTHER);
    assert_int_equal(until_measuring(), ABANDONED_US);
    assert_int_equal(fake.request->message.head[0], UNIT);
    measures();
}

TEST(the_setting_after_an_abandoned_blind_setting_is_not_blind)
{
    assert_int_equal(fathom_modbus_write_next_unchecked(&unit), FATHOM_OK);
    PENDS(sets(&other_setting));
    assert_int_equal(fake.request->message.head[1], 6);
    others_call();
    PENDS(sets(&move));
    assert_int_equal(fake.request->message.head[1], 3); /* its present value is read first */
}

TEST(a_setting_that_begins_behind_an_abandoned_command_is_carried_out_whole)
{
    PENDS(asks(&details));
    responds(8);
    for (unsigned i = 0; i != ABANDONED_US / STEP_US; i++) {
        fake.now_us += STEP_US;
        PENDS(asks(&measure));
        if (unit.current == measure.id) break;
    }
    /* Abandoned again: this time the setting is the next to call. */
    responds(754);
    assert_int_equal(asks(&measure), FATHOM_OK);
    PENDS(asks(&details));
    responds(8);
    fathom_modbus_unit_poll(&unit);
    unit.kept_us = (uint32_t)(fake.now_us - FATHOM_MODBUS_ABANDONED_US);
    unit.calls_left = 0;
    PENDS(sets(&other_setting));
    assert_int_equal(unit.setting, other_setting.write.id);
    responds(0);
    PENDS(sets(&other_setting)); /* the write */
    assert_true(unit.is_written);
    fake_modbus_acknowledge(&fake);
    PENDS(sets(&other_setting)); /* the read back */
    responds(1);
    assert_int_equal(sets(&other_setting), FATHOM_OK);
}

/* modbus_unit.h, fathom_modbus_unit_due_us(): a program that sleeps for it is not kept out longer than another. */
TEST(a_program_that_sleeps_until_it_is_due_meets_the_limit)
{
    uint32_t slept_us = 0;
    fake.due_us = 1000;
    PENDS(asks(&version));
    responds(7);
    for (unsigned polls = 0; fake.request == NULL || unit.current != measure.id; polls++) {
        assert_true(polls < 40000);
        const uint32_t due_us = fathom_modbus_unit_due_us(&unit);
        assert_true(due_us <= ABANDONED_US);
        fake.now_us += due_us + 100; /* a poll takes its time */
        slept_us += due_us + 100;
        PENDS(asks(&measure));
    }
    assert_in_range(slept_us, ABANDONED_US, ABANDONED_US + 2200);
}

/* Halfway to the limit a poll is due after 1 ms at least, and after a sixteenth of the limit at most. */
TEST(while_an_abandoned_command_is_on_the_wire_a_poll_is_due_when_the_line_is)
{
    static const struct {
        uint32_t line_us, due_us;
    } rows[] = {{0, 1000}, {1000, 1000}, {1001, 1001}, {312500, 312500}, {312501, 312500}};
    PENDS(asks(&version));
    for (unsigned i = 0; i != 25; i++) {
        fake.now_us += STEP_US;
        PENDS(asks(&measure));
    }
    fake.due_us = 312501;
    assert_int_equal(fathom_modbus_unit_due_us(&unit), 312501); /* 2.5 s are left */
    fake.now_us += 1;
    PENDS(asks(&measure));
    for (unsigned i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        fake.due_us = rows[i].line_us;
        assert_int_equal(fathom_modbus_unit_due_us(&unit), rows[i].due_us);
    }
}

TEST(a_command_that_has_ended_delays_no_poll)
{
    PENDS(asks(&version));
    responds(7);
    assert_int_equal(asks(&version), FATHOM_OK);
    for (unsigned i = 0; i != 30; i++) {
        fake.now_us += STEP_US;
        fathom_modbus_unit_poll(&unit);
        assert_int_equal(fathom_modbus_unit_due_us(&unit), 0);
    }
}

TEST(a_request_that_the_line_has_forgotten_is_cancelled_within_65_ms_and_the_next_one_follows)
{
    PENDS(asks(&measure));
    for (unsigned i = 0; i != 100; i++) {
        fake.now_us += 1000;
        PENDS(asks(&measure));
    }
    fake_modbus_forget(&fake);
    fathom_status_t status = FATHOM_PENDING;
    for (unsigned ms = 0; status == FATHOM_PENDING; ms++) {
        assert_true(ms <= 65);
        fake.now_us += 1000;
        status = asks(&measure);
    }
    assert_int_equal(status, FATHOM_ERR_CANCELLED);
    PENDS(asks(&measure));
    assert_int_equal(fake.submits, 1);
    measures();
}

/* The program initialised the line again, and fathom_line_init() refused the new parts. */
TEST(a_line_that_is_not_initialised_any_more_is_reported_and_serves_the_unit_again_after_its_next_init)
{
    PENDS(asks(&measure));
    fake_modbus_forget(&fake);
    fake.line.parts = NULL;
    fake.now_us += 1000;
    fake.polls = 0;
    assert_int_equal(asks(&measure), FATHOM_ERR_ARGUMENT);
    assert_int_equal(asks(&version), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_modbus_unit_due_us(&unit), 0);
    fathom_modbus_unit_power_on(&unit, 1000);
    fathom_modbus_unit_cancel(&unit);
    assert_int_equal(fake.submits + fake.polls + fake.cancels, 0);
    fake.line.parts = &fake.parts;
    fake.now_us += TIMEOUT_US;
    PENDS(asks(&measure));
    measures();
}

TEST(an_abandoned_setting_gives_way_to_a_blind_setting)
{
    PENDS(sets(&move));
    responds(UNIT);
    PENDS(sets(&move));
    assert_int_equal(fathom_modbus_write_next_unchecked(&unit), FATHOM_ERR_BUSY);
    others_call();
    assert_int_equal(fathom_modbus_write_next_unchecked(&unit), FATHOM_OK);
    assert_int_equal(unit.address, UNIT);
    PENDS(sets(&other_setting)); /* the write at once */
    assert_int_equal(fake.request->message.head[1], 6);
    fake_modbus_acknowledge(&fake);
    assert_int_equal(sets(&other_setting), FATHOM_ERR_UNCONFIRMED);
}
