/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake_modbus.h"
#include "fathom/modbus_setting.h"

/* A device with a setting in register 0x0206, as a driver sees it; the seam plays the device. */
enum { HERE = 1, THERE = 5, OLD = 1000, NEW = 2000 };
enum { READ = 0x03, WRITE = 0x06 };

static fake_modbus_t fake;
static fathom_modbus_unit_t unit;
static uint16_t found;
static uint16_t wanted;
static fathom_modbus_setting_t setting;

static const fathom_line_settings_t fast = {57600, FATHOM_PARITY_EVEN, 1};

static const fathom_modbus_question_t look = {1000, 0, 0, NULL, &found, 0x0206, 1, 0, true, 0};
static const fathom_modbus_question_t put = {1000, 0, 0, NULL, &wanted, 0x0206, 1, 0, true, WRITE};
static const fathom_modbus_question_t measure = {1000, 0, 0, NULL, &found, 0x0100, 1, 0, false, 0};
static const fathom_modbus_question_t command = {1000, 0, 0, NULL, &found, 0x0101, 1, 0, true, 0};

static fathom_status_t read_it(void *driver, uint32_t *value)
{
    const fathom_status_t status = fathom_modbus_unit_ask(driver, &look);
    if (status == FATHOM_READY) *value = found;
    return status;
}

static int set_up(void **state)
{
    fake_modbus_init(&fake);
    fake.now_us = 0xFFFFF000u; /* the clock wraps soon */
    memset(&unit, 0x5A, sizeof unit);
    assert_int_equal(fathom_modbus_unit_init(&unit, &fake.modbus, &fake.clock, HERE), FATHOM_READY);
    setting = (fathom_modbus_setting_t){.read = read_it, .driver = &unit, .write = &put, .value = NEW};
    wanted = NEW;
    found = 0;
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static fathom_status_t set(void)
{
    fake.now_us += 1000;
    return fathom_modbus_set(&unit, &setting);
}

/* The request that is under way: `function` to `unit_asked`, of register 0x0206; a write carries NEW. */
static void assert_asks(uint8_t unit_asked, uint8_t function)
{
    const uint8_t head[] = {unit_asked,
                            function,
                            0x02,
                            0x06,
                            function == WRITE ? NEW >> 8 : 0,
                            function == WRITE ? NEW & 0xFF : 1};
    assert_int_equal(set(), FATHOM_PENDING);
    assert_non_null(fake.request);
    assert_memory_equal(fake.log[fake.submits - 1], head, sizeof head);
}

static void answers(uint8_t unit_asked, uint16_t value)
{
    static uint16_t said;
    said = value;
    assert_asks(unit_asked, READ);
    fake_modbus_answer(&fake, &said, 1);
}

static void fails(uint8_t unit_asked, uint8_t function, fathom_status_t status)
{
    assert_asks(unit_asked, function);
    if (status == FATHOM_ERR_EXCEPTION)
        fake_modbus_refuse(&fake, 2);
    else
        fake_modbus_fail(&fake, status);
}

static void acknowledges(uint8_t unit_asked)
{
    assert_asks(unit_asked, WRITE);
    fake_modbus_acknowledge(&fake);
}

static void ends(fathom_status_t status, unsigned submits, uint8_t address)
{
    assert_int_equal(set(), status);
    assert_null(fake.request);
    assert_int_equal(fake.submits, submits);
    assert_int_equal(unit.address, address);
}

/* ---- where it is ---- */

TEST(what_is_so_already_is_not_written)
{
    answers(HERE, NEW);
    ends(FATHOM_READY, 1, HERE);
}

TEST(a_value_is_read_written_once_and_read_back)
{
    answers(HERE, OLD);
    acknowledges(HERE);
    answers(HERE, NEW);
    ends(FATHOM_READY, 3, HERE);
    assert_int_equal(fake.unit_cancels, 0);
}

TEST(a_setting_can_be_made_again)
{
    a_value_is_read_written_once_and_read_back(state);
    fake.submits = 0;
    a_value_is_read_written_once_and_read_back(state);
}

TEST(what_cannot_be_looked_at_is_not_written)
{
    static const fathom_status_t errors[] = {FATHOM_ERR_NO_ANSWER, FATHOM_ERR_CHECKSUM, FATHOM_ERR_MALFORMED,
                                             FATHOM_ERR_EXCEPTION, FATHOM_ERR_PORT};
    for (size_t i = 0; i != sizeof errors / sizeof errors[0]; i++) {
        set_up(state);
        fails(HERE, READ, errors[i]);
        ends(errors[i], 1, HERE);
    }
}

TEST(a_refusal_ends_it)
{
    answers(HERE, OLD);
    fails(HERE, WRITE, FATHOM_ERR_EXCEPTION);
    ends(FATHOM_ERR_EXCEPTION, 2, HERE);
}

TEST(what_is_never_sent_ends_it)
{
    static const fathom_status_t errors[] = {FATHOM_ERR_ARGUMENT, FATHOM_ERR_CAPACITY,
                                             FATHOM_ERR_UNSUPPORTED};
    for (size_t i = 0; i != sizeof errors / sizeof errors[0]; i++) {
        set_up(state);
        answers(HERE, OLD);
        fake.refuses = errors[i];
        ends(errors[i], 1, HERE);
    }
}

TEST(a_device_that_acknowledges_and_does_not_obey_is_found_out)
{
    answers(HERE, OLD);
    acknowledges(HERE);
    answers(HERE, OLD);
    ends(FATHOM_ERR_MALFORMED, 3, HERE);
}

TEST(a_lost_acknowledgement_is_no_failure_if_the_value_holds)
{
    static const fathom_status_t errors[] = {FATHOM_ERR_NO_ANSWER, FATHOM_ERR_CHECKSUM, FATHOM_ERR_MALFORMED,
                                             FATHOM_ERR_ECHO};
    for (size_t i = 0; i != sizeof errors / sizeof errors[0]; i++) {
        set_up(state);
        answers(HERE, OLD);
        fails(HERE, WRITE, errors[i]);
        answers(HERE, NEW);
        ends(FATHOM_READY, 3, HERE);
    }
}

TEST(a_write_that_was_not_heard_is_told_as_it_failed)
{
    answers(HERE, OLD);
    fails(HERE, WRITE, FATHOM_ERR_NO_ANSWER);
    answers(HERE, OLD);
    ends(FATHOM_ERR_NO_ANSWER, 3, HERE);
}

TEST(without_a_reading_afterwards_it_is_unconfirmed)
{
    answers(HERE, OLD);
    acknowledges(HERE);
    fails(HERE, READ, FATHOM_ERR_NO_ANSWER);
    ends(FATHOM_ERR_UNCONFIRMED, 3, HERE);
}

TEST(what_cannot_be_read_is_acknowledged_or_not)
{
    setting.read = NULL;
    acknowledges(HERE);
    ends(FATHOM_READY, 1, HERE);
    fails(HERE, WRITE, FATHOM_ERR_NO_ANSWER);
    ends(FATHOM_ERR_NO_ANSWER, 2, HERE);
}

/* ---- to another address ---- */

TEST(an_address_is_looked_at_first_and_followed)
{
    setting.address = THERE;
    answers(HERE, OLD);
    fails(THERE, READ, FATHOM_ERR_NO_ANSWER);
    acknowledges(HERE);
    assert_int_equal(fake.unit_cancels, 0);
    answers(THERE, NEW);
    assert_int_equal(fake.unit_cancels, 1);
    assert_int_equal(fake.cancelled_unit, HERE);
    ends(FATHOM_READY, 4, THERE);
}

TEST(an_address_that_answers_is_in_use)
{
    static const fathom_status_t errors[] = {FATHOM_ERR_CHECKSUM, FATHOM_ERR_MALFORMED, FATHOM_ERR_EXCEPTION};
    setting.address = THERE;
    answers(HERE, OLD);
    answers(THERE, OLD);
    ends(FATHOM_ERR_IN_USE, 2, HERE);
    for (size_t i = 0; i != sizeof errors / sizeof errors[0]; i++) {
        fake.submits = 0;
        answers(HERE, OLD);
        fails(THERE, READ, errors[i]);
        ends(FATHOM_ERR_IN_USE, 2, HERE);
    }
}

TEST(a_port_that_breaks_before_the_write_is_told_and_nothing_was_changed)
{
    setting.address = THERE;
    answers(HERE, OLD);
    fails(THERE, READ, FATHOM_ERR_PORT);
    ends(FATHOM_ERR_PORT, 2, HERE);
}

TEST(an_address_that_was_not_taken_is_found_at_the_old_one)
{
    setting.address = THERE;
    answers(HERE, OLD);
    fails(THERE, READ, FATHOM_ERR_NO_ANSWER);
    fails(HERE, WRITE, FATHOM_ERR_CHECKSUM);
    fails(THERE, READ, FATHOM_ERR_NO_ANSWER);
    answers(HERE, OLD);
    ends(FATHOM_ERR_CHECKSUM, 5, HERE);
}

TEST(a_device_that_answers_at_neither_is_at_one_of_the_two)
{
    setting.address = THERE;
    answers(HERE, OLD);
    fails(THERE, READ, FATHOM_ERR_NO_ANSWER);
    acknowledges(HERE);
    fails(THERE, READ, FATHOM_ERR_NO_ANSWER);
    fails(HERE, READ, FATHOM_ERR_NO_ANSWER);
    ends(FATHOM_ERR_UNCONFIRMED, 5, HERE);
}

/* ---- to other line settings ---- */

static const fathom_line_settings_t *asked_at(void) { return fake.request->exchange.settings; }

TEST(line_settings_are_followed_without_a_look_at_the_new_ones)
{
    setting.settings = &fast;
    answers(HERE, OLD);
    assert_null(asked_at());
    acknowledges(HERE);
    assert_null(asked_at());
    answers(HERE, NEW);
    assert_ptr_equal(asked_at(), &fast);
    assert_int_equal(fake.cancelled_unit, HERE); /* what waits names the settings of before */
    ends(FATHOM_READY, 3, HERE);
    assert_ptr_equal(unit.settings, &fast);
}

TEST(settings_that_take_effect_later_are_read_at_the_old_ones)
{
    setting.settings = &fast;
    answers(HERE, OLD);
    acknowledges(HERE);
    fails(HERE, READ, FATHOM_ERR_NO_ANSWER);
    answers(HERE, NEW);
    assert_null(asked_at());
    ends(FATHOM_READY, 4, HERE);
    assert_null(unit.settings);
}

/* ---- meanwhile ---- */

TEST(measurements_rest_and_other_commands_are_refused_meanwhile)
{
    static const fathom_modbus_question_t other = {1000, 0, 0, NULL, &wanted, 0x0205, 1, 0, true, WRITE};
    const fathom_modbus_setting_t another = {.read = read_it, .driver = &unit, .write = &other, .value = 1};
    answers(HERE, OLD);
    assert_int_equal(fathom_modbus_unit_ask(&unit, &measure), FATHOM_PENDING); /* ends the look ... */
    assert_int_equal(fathom_modbus_unit_ask(&unit, &command), FATHOM_ERR_BUSY);
    assert_int_equal(fathom_modbus_set(&unit, &another), FATHOM_ERR_BUSY);
    assert_int_equal(fake.submits, 1); /* ... and asks nothing of its own */
    acknowledges(HERE);
    answers(HERE, NEW);
    ends(FATHOM_READY, 3, HERE);
    assert_int_equal(fathom_modbus_unit_ask(&unit, &measure), FATHOM_PENDING);
    assert_int_equal(fake.submits, 4);
}

/* The application asks for the same register as the setting does: the answer is the setting's. */
TEST(the_outcome_of_a_settings_own_question_is_kept_for_it)
{
    answers(HERE, OLD);
    assert_int_equal(fathom_modbus_unit_ask(&unit, &look), FATHOM_ERR_BUSY);
    assert_null(fake.request); /* it has ended */
    assert_int_equal(fathom_modbus_unit_ask(&unit, &look), FATHOM_ERR_BUSY);
    acknowledges(HERE);
    assert_int_equal(fathom_modbus_unit_ask(&unit, &look), FATHOM_ERR_BUSY);
    assert_int_equal(fathom_modbus_unit_ask(&unit, &put), FATHOM_ERR_BUSY);
    answers(HERE, NEW);
    ends(FATHOM_READY, 3, HERE);
}

TEST(a_setting_waits_for_no_command_of_somebody_else)
{
    assert_int_equal(fathom_modbus_unit_ask(&unit, &command), FATHOM_PENDING);
    assert_int_equal(set(), FATHOM_ERR_BUSY);
    fake_modbus_answer(&fake, (const uint16_t[]){3}, 1);
    assert_int_equal(fathom_modbus_unit_ask(&unit, &command), FATHOM_READY);
    fake.submits = 0;
    a_value_is_read_written_once_and_read_back(state);
}

TEST(the_same_register_measured_is_another_question)
{
    static const fathom_modbus_question_t same = {1000, 0, 0, NULL, &wanted, 0x0206, 1, 0, false, 0};
    assert_int_equal(fathom_modbus_unit_ask(&unit, &same), FATHOM_PENDING);
    assert_int_equal(set(), FATHOM_PENDING);
    fake_modbus_answer(&fake, (const uint16_t[]){NEW}, 1);
    assert_asks(HERE, READ); /* the look comes after it, and is no part of it */
    assert_int_equal(fake.submits, 2);
}

TEST(what_is_given_up_in_the_middle_leaves_the_driver_where_it_was)
{
    setting.address = THERE;
    setting.settings = &fast;
    answers(HERE, OLD);
    assert_asks(THERE, READ);
    assert_ptr_equal(asked_at(), &fast);
    fathom_modbus_unit_cancel(&unit);
    assert_null(fake.request);
    assert_int_equal(unit.address, HERE);
    assert_null(unit.settings);
    assert_int_equal(fathom_modbus_unit_ask(&unit, &command), FATHOM_PENDING);
}

/* ---- after power-on ---- */

TEST(after_power_on_silence_refusal_and_damage_are_warming_up)
{
    static const struct {
        fathom_status_t is, told;
    } rows[] = {{FATHOM_ERR_NO_ANSWER, FATHOM_ERR_WARMING_UP},
                {FATHOM_ERR_CHECKSUM, FATHOM_ERR_WARMING_UP},
                {FATHOM_ERR_EXCEPTION, FATHOM_ERR_WARMING_UP},
                {FATHOM_ERR_MALFORMED, FATHOM_ERR_MALFORMED},
                {FATHOM_ERR_PORT, FATHOM_ERR_PORT}};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        set_up(state);
        fathom_modbus_unit_power_on(&unit, 50000);
        assert_true(fathom_modbus_unit_is_warming_up(&unit));
        fails(HERE, READ, rows[i].is);
        ends(rows[i].told, 1, HERE);
        fake.now_us += 50000;
        fails(HERE, READ, rows[i].is);
        ends(rows[i].is, 2, HERE);
        assert_false(fathom_modbus_unit_is_warming_up(&unit));
    }
}

TEST(a_unit_that_warms_up_is_not_left_alone)
{
    fathom_modbus_unit_power_on(&unit, 10000000);
    for (unsigned i = 0; i != 10; i++) {
        assert_int_equal(fathom_modbus_unit_ask(&unit, &measure), FATHOM_PENDING);
        assert_int_equal(fake.submits, i + 1);
        fake_modbus_fail(&fake, FATHOM_ERR_NO_ANSWER);
        assert_int_equal(fathom_modbus_unit_ask(&unit, &measure), FATHOM_ERR_WARMING_UP);
    }
}

TEST(power_ends_what_was_under_way)
{
    setting.address = THERE;
    answers(HERE, OLD);
    assert_asks(THERE, READ);
    fathom_modbus_unit_power_on(&unit, 0);
    assert_null(fake.request);
    assert_int_equal(unit.address, HERE);
    assert_false(fathom_modbus_unit_is_warming_up(&unit));
}
