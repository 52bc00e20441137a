/* SPDX-License-Identifier: MIT */
#include "desk.h"
#include "fathom/engine/internal/modbus_setting.h"

/* A device with a setting in register 0x020F, as a driver sees it; the transport plays the device. The id of the write
 * has the last of the 16 doubts. */
enum { HERE = 1, THERE = 5, OLD = 1000, NEW = 2000, REGISTER = 0x020F };

static fathom_modbus_unit_t unit;
static uint16_t found;
static fathom_modbus_setting_t setting;

static const fathom_line_settings_t fast = {57600, FATHOM_PARITY_EVEN, 1};

/* Requests of one register. */
static const fathom_modbus_unit_request_t look = {&found, REGISTER, 1, 3, 0x81};
static const fathom_modbus_unit_request_t put = {NULL, REGISTER, NEW, 6, 0xCF};
static const fathom_modbus_unit_request_t measure = {&found, 0x0100, 1, 3, 1};

static fathom_status_t asks(const fathom_modbus_unit_request_t *request)
{
    fathom_modbus_unit_poll(&unit);
    return ask_unit(&unit, request);
}

static fathom_status_t read_it(const fathom_modbus_setting_t *of, uint32_t *value)
{
    const fathom_status_t status = ask_unit(of->driver, &look);
    if (status == FATHOM_OK) *value = found;
    return status;
}

static int set_up(void **state)
{
    desk_begin(0xFFFFF000u); /* the clock wraps soon */
    memset(&unit, 0x5A, sizeof unit);
    assert_int_equal(init_unit(&unit, &fake.modbus,
                               &(fathom_modbus_config_t){.address = HERE, .command_timeout_us = 1000}, 1000,
                               0),
                     FATHOM_OK);
    setting = (fathom_modbus_setting_t){.read = read_it, .driver = &unit, .write = put, .value = NEW};
    found = 0;
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static fathom_status_t set(void)
{
    fathom_modbus_unit_poll(&unit);
    return fathom_modbus_set(&unit, &setting);
}

#define OK            FATHOM_OK
#define SILENT        FATHOM_ERR_NO_RESPONSE
#define IS(at, value) READ(at, REGISTER, OK, value)
#define FAILS(at, as) READ(at, REGISTER, as, 2)
#define PUT(ends)     WRITE(HERE, REGISTER, NEW, ends)

/* Exactly these requests are made; it ends so, and the driver asks there. */
#define SETS(status, at, ...)                                                                                \
    do {                                                                                                     \
        PLAY(set, status, __VA_ARGS__);                                                                      \
        assert_int_equal(unit.address, at);                                                                  \
    } while (0)

/* A test that is this; `to`: the address that is set, 0: none. */
#define SETTING(promise, to, status, at, ...)                                                                \
    TEST(promise)                                                                                            \
    {                                                                                                        \
        setting.address = to;                                                                                \
        SETS(status, at, __VA_ARGS__);                                                                       \
    }

/* ---- where it is ---- */

/* modbus_setting.h: "unit->is_written tells whether anything was sent that changes the device". */
static void was_written(bool is) { assert_int_equal(unit.is_written, is); }

TEST(what_is_so_already_is_not_written)
{
    SETS(OK, HERE, IS(HERE, OLD), PUT(OK), IS(HERE, NEW));
    was_written(true);
    SETS(OK, HERE, IS(HERE, NEW));
    was_written(false);
}

TEST(a_value_is_read_written_once_and_read_back_and_can_be_set_again)
{
    for (unsigned i = 0; i != 2; i++) SETS(OK, HERE, IS(HERE, OLD), PUT(OK), IS(HERE, NEW));
    assert_int_equal(fake.unit_cancels, 0);
}

SETTING(a_refusal_ends_it, 0, FATHOM_ERR_EXCEPTION, HERE, IS(HERE, OLD), PUT(FATHOM_ERR_EXCEPTION))

TEST(what_is_never_sent_ends_it)
{
    static const fathom_status_t errors[] = {FATHOM_ERR_ARGUMENT, FATHOM_ERR_CAPACITY,
                                             FATHOM_ERR_UNSUPPORTED};
    for (size_t i = 0; i != COUNT(errors); i++) {
        set_up(state);
        PART(set, IS(HERE, OLD));
        fake.refuses = errors[i];
        assert_int_equal(set(), errors[i]);
        assert_null(fake.request);
        assert_int_equal(fake.submits, 0);
        was_written(false);
    }
    set_up(state); /* the port cannot do the line settings, which is seen when the request is to leave */
    SETS(FATHOM_ERR_UNSUPPORTED, HERE, IS(HERE, OLD), PUT(FATHOM_ERR_UNSUPPORTED));
    was_written(false);
}

static void want(uint16_t value) { setting.value = setting.write.last = value; }

#define PUTS(value) WRITE(HERE, REGISTER, value, OK)

/* HPS-167S #7, #10, #11: from the next power-on; what #2 tells until then, the datasheet does not say. */
TEST(a_value_that_was_written_and_did_not_show_is_taken_back_by_writing)
{
    SETS(FATHOM_ERR_DIFFERS, HERE, IS(HERE, OLD), PUT(OK), IS(HERE, OLD));
    want(OLD); /* what it tells now, and may not keep; so without an acknowledgement that proves nothing */
    SETS(FATHOM_ERR_UNCONFIRMED, HERE, IS(HERE, OLD), WRITE(HERE, REGISTER, OLD, SILENT));
    SETS(OK, HERE, IS(HERE, OLD), PUTS(OLD), IS(HERE, OLD));
    was_written(true);
    SETS(OK, HERE, IS(HERE, OLD));
    was_written(false);
    want(NEW); /* nor is one believed whose acknowledgement was lost */
    SETS(SILENT, HERE, IS(HERE, OLD), PUT(SILENT), IS(HERE, OLD));
    want(OLD);
    SETS(FATHOM_ERR_EXCEPTION, HERE, IS(HERE, OLD), WRITE(HERE, REGISTER, OLD, FATHOM_ERR_EXCEPTION));
    SETS(OK, HERE, IS(HERE, OLD), PUTS(OLD), IS(HERE, OLD));
    want(NEW); /* or of which nothing could be read */
    SETS(FATHOM_ERR_UNCONFIRMED, HERE, IS(HERE, OLD), PUT(OK), FAILS(HERE, SILENT));
    want(OLD);
    SETS(OK, HERE, IS(HERE, OLD), PUTS(OLD), IS(HERE, OLD));
    want(NEW);
    SETS(FATHOM_ERR_UNCONFIRMED, HERE, IS(HERE, OLD), PUT(OK), FAILS(HERE, SILENT));
    SETS(OK, HERE, IS(HERE, NEW)); /* but what it said otherwise before, was given and says now, it has */
    was_written(false);
    want(OLD);
    SETS(OK, HERE, IS(HERE, NEW), PUTS(OLD), IS(HERE, OLD));
    want(NEW); /* or that was written blind */
    assert_int_equal(fathom_modbus_write_next_unchecked(&unit), OK);
    SETS(FATHOM_ERR_UNCONFIRMED, HERE, PUT(OK));
    want(OLD);
    SETS(OK, HERE, IS(HERE, OLD), PUTS(OLD), IS(HERE, OLD));
    want(NEW);
    SETS(FATHOM_ERR_DIFFERS, HERE, IS(HERE, OLD), PUT(OK), IS(HERE, OLD));
    want(OLD); /* nor does a blind write that was lost take anything back: it said OLD all the time */
    assert_int_equal(fathom_modbus_write_next_unchecked(&unit), OK);
    SETS(FATHOM_ERR_UNCONFIRMED, HERE, WRITE(HERE, REGISTER, OLD, SILENT));
    SETS(FATHOM_ERR_UNCONFIRMED, HERE, IS(HERE, OLD), WRITE(HERE, REGISTER, OLD, SILENT));
    fathom_modbus_unit_power_on(&unit, 0);
    want(NEW);
    SETS(OK, HERE, IS(HERE, NEW)); /* what it tells now, it keeps */
    want(OLD);
    SETS(OK, HERE, IS(HERE, OLD));
    was_written(false);
}

TEST(a_value_that_shows_behind_a_lost_write_of_another_one_is_written_again)
{
    SETS(FATHOM_ERR_DIFFERS, HERE, IS(HERE, OLD), PUT(OK), IS(HERE, OLD));
    want(OLD);
    SETS(FATHOM_ERR_UNCONFIRMED, HERE, IS(HERE, OLD), WRITE(HERE, REGISTER, OLD, SILENT));
    want(NEW);
    SETS(OK, HERE, IS(HERE, NEW), PUT(OK), IS(HERE, NEW));
}

TEST(a_lost_acknowledgement_is_no_failure_if_the_value_holds)
{
    static const fathom_status_t errors[] = {SILENT, FATHOM_ERR_CHECKSUM, FATHOM_ERR_MALFORMED,
                                             FATHOM_ERR_ECHO};
    for (size_t i = 0; i != COUNT(errors); i++) SETS(OK, HERE, IS(HERE, OLD), PUT(errors[i]), IS(HERE, NEW));
}

TEST(a_write_that_was_not_heard_is_told_as_it_failed)
{
    SETS(SILENT, HERE, IS(HERE, OLD), PUT(SILENT), IS(HERE, OLD));
    was_written(true);
}

SETTING(without_a_reading_afterwards_it_is_unconfirmed, 0, FATHOM_ERR_UNCONFIRMED, HERE, IS(HERE, OLD),
        PUT(OK), FAILS(HERE, SILENT))

TEST(what_cannot_be_read_is_acknowledged_or_unconfirmed_or_refused)
{
    setting.read = NULL;
    SETS(OK, HERE, PUT(OK));
    SETS(FATHOM_ERR_EXCEPTION, HERE, PUT(FATHOM_ERR_EXCEPTION));
    SETS(FATHOM_ERR_UNCONFIRMED, HERE, PUT(SILENT));
    was_written(true);
}

/* ---- to another address ---- */

TEST(an_address_is_looked_at_first_and_followed)
{
    setting.address = THERE;
    PART(set, IS(HERE, OLD), FAILS(THERE, SILENT), PUT(OK));
    assert_int_equal(fake.unit_cancels, 0);
    SETS(OK, THERE, IS(THERE, NEW));
    assert_int_equal(fake.unit_cancels, 1);
    assert_int_equal(fake.cancelled_unit, HERE);
}

TEST(an_address_that_answers_is_in_use)
{
    static const fathom_status_t responses[] = {OK, FATHOM_ERR_CHECKSUM, FATHOM_ERR_MALFORMED,
                                                FATHOM_ERR_EXCEPTION};
    setting.address = THERE;
    for (size_t i = 0; i != COUNT(responses); i++)
        SETS(FATHOM_ERR_IN_USE, HERE, IS(HERE, OLD), FAILS(THERE, responses[i]));
}

SETTING(a_port_that_breaks_before_the_write_is_told_and_nothing_was_changed, THERE, FATHOM_ERR_PORT, HERE,
        IS(HERE, OLD), FAILS(THERE, FATHOM_ERR_PORT))

SETTING(an_address_that_was_not_taken_is_found_at_the_old_one, THERE, FATHOM_ERR_CHECKSUM, HERE,
        IS(HERE, OLD), FAILS(THERE, SILENT), PUT(FATHOM_ERR_CHECKSUM), FAILS(THERE, SILENT), IS(HERE, OLD))

SETTING(a_device_that_answers_at_neither_is_at_one_of_the_two, THERE, FATHOM_ERR_UNCONFIRMED, HERE,
        IS(HERE, OLD), FAILS(THERE, SILENT), PUT(OK), FAILS(THERE, SILENT), FAILS(HERE, SILENT))

/* ---- to other line settings ---- */

static const row_t is_fast = {{HERE, 3, HIGH(REGISTER), LOW(REGISTER), 0, 1}, OK, {NEW}, 57600};

TEST(line_settings_are_followed_without_a_look_at_the_new_ones)
{
    setting.line_settings = &fast;
    SETS(OK, HERE, IS(HERE, OLD), PUT(OK), is_fast);
    assert_int_equal(fake.cancelled_unit, HERE); /* what waits names the settings of before */
    assert_ptr_equal(unit.line_settings, &fast);
}

/* ---- meanwhile ---- */

/* The application asks for the same register as the setting does: the response is the setting's. */
TEST(the_outcome_of_a_settings_own_request_is_kept_for_it)
{
    PART(set, IS(HERE, OLD));
    assert_int_equal(asks(&look), FATHOM_ERR_BUSY);
    assert_null(fake.request); /* it has ended */
    assert_int_equal(asks(&look), FATHOM_ERR_BUSY);
    PART(set, PUT(OK));
    assert_int_equal(asks(&look), FATHOM_ERR_BUSY);
    assert_int_equal(asks(&put), FATHOM_ERR_BUSY);
    SETS(OK, HERE, IS(HERE, NEW));
}

/* ---- after power-on ---- */

TEST(after_power_on_silence_refusal_and_damage_are_warming_up)
{
    static const fathom_status_t errors[] = {SILENT, FATHOM_ERR_CHECKSUM, FATHOM_ERR_EXCEPTION,
                                             FATHOM_ERR_MALFORMED, FATHOM_ERR_PORT};
    for (size_t i = 0; i != COUNT(errors); i++) {
        set_up(state);
        fathom_modbus_unit_power_on(&unit, 50000);
        assert_true(fathom_modbus_unit_is_warming_up(&unit));
        SETS(i < 3 ? FATHOM_ERR_WARMING_UP : errors[i], HERE, FAILS(HERE, errors[i]));
        fake.now_us += 50000;
        SETS(errors[i], HERE, FAILS(HERE, errors[i]));
        assert_false(fathom_modbus_unit_is_warming_up(&unit));
    }
}

/* A unit that starts keeps no line busy and is no master: to wait would cure neither. */
TEST(after_power_on_a_busy_line_and_another_master_are_told_as_they_are)
{
    static const fathom_status_t errors[] = {FATHOM_ERR_LINE_BUSY, FATHOM_ERR_OTHER_MASTER};
    for (size_t i = 0; i != COUNT(errors); i++) {
        fathom_modbus_unit_power_on(&unit, 10000000);
        PENDS(asks(&measure));
        fake_modbus_fail(&fake, errors[i]);
        assert_int_equal(asks(&measure), errors[i]);
    }
}

TEST(what_is_under_way_cannot_become_blind)
{
    PART(set, IS(HERE, OLD));
    assert_int_equal(fathom_modbus_write_next_unchecked(&unit), FATHOM_ERR_BUSY);
    SETS(OK, HERE, PUT(OK), IS(HERE, NEW));
}

/* ---- a command or setting that its caller begins and never calls again (modbus_unit.h, rules 5 and 6) ---- */

enum { TIMEOUT_US = 300000, ABANDONED_US = 5000000, STEP_US = 100000 };

static const fathom_modbus_unit_request_t details = {&found, 0x0003, 1, 3, 0x83};
static const fathom_modbus_setting_t move = {read_it, &unit, {NULL, 0x0200, THERE, 6, 0xC8},
                                             THERE,   NULL,  THERE};
static const fathom_modbus_setting_t other_setting = {read_it, &unit, {NULL, 0x0201, 1, 6, 0xC9}, 1, NULL, 0};

static int set_up_slow(void **state)
{
    set_up(state);
    assert_int_equal(
        init_unit(&unit, &fake.modbus, &(fathom_modbus_config_t){.address = HERE}, TIMEOUT_US, 0), OK);
    return 0;
}

static const suite_t abandoned = {.set_up = set_up_slow};

static fathom_status_t calls(const fathom_modbus_unit_request_t *request)
{
    fake.submits = 0;
    return asks(request);
}

static fathom_status_t sets(const fathom_modbus_setting_t *of)
{
    fake.submits = 0;
    fathom_modbus_unit_poll(&unit);
    return fathom_modbus_set(&unit, of);
}

static void responds(uint16_t with) { fake_modbus_response(&fake, &with, 1); }

/* Measures every STEP_US until the measurement is on the wire, and returns how long that took. */
static uint32_t until_measuring(void)
{
    uint32_t took_us = 0;
    for (; fake.request == NULL || unit.current != measure.id; took_us += STEP_US) {
        assert_true(took_us < 2 * ABANDONED_US);
        fake.now_us += STEP_US;
        PENDS(calls(&measure));
    }
    return took_us;
}

/* Until one more call of another function finds the command abandoned. */
static void others_call(void)
{
    for (unsigned i = 1; i != ABANDONED_US / STEP_US; i++) {
        fake.now_us += STEP_US;
        PENDS(calls(&measure));
    }
    fake.now_us += STEP_US;
    fathom_modbus_unit_poll(&unit);
}

static void measures(void)
{
    responds(754);
    assert_int_equal(calls(&measure), OK);
}

TEST_IN(abandoned, an_abandoned_setting_gives_way_and_the_driver_stays_where_it_was)
{
    PENDS(sets(&move));
    responds(HERE); /* it has another value: the new address is probed next */
    PENDS(sets(&move));
    assert_int_equal(unit.address, THERE);
    assert_int_equal(until_measuring(), ABANDONED_US);
    assert_int_equal(fake.request->message.head[0], HERE);
    measures();
}

TEST_IN(abandoned, the_setting_after_an_abandoned_blind_setting_is_not_blind)
{
    assert_int_equal(fathom_modbus_write_next_unchecked(&unit), OK);
    PENDS(sets(&other_setting));
    assert_int_equal(fake.request->message.head[1], 6);
    others_call();
    PENDS(sets(&move));
    assert_int_equal(fake.request->message.head[1], 3); /* its present value is read first */
}

TEST_IN(abandoned, a_setting_that_begins_behind_an_abandoned_command_is_carried_out_whole)
{
    PENDS(calls(&details));
    responds(8);
    for (unsigned i = 0; i != ABANDONED_US / STEP_US; i++) {
        fake.now_us += STEP_US;
        PENDS(calls(&measure));
        if (unit.current == measure.id) break;
    }
    /* Abandoned again: this time the setting is the next to call. */
    responds(754);
    assert_int_equal(calls(&measure), OK);
    PENDS(calls(&details));
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
    assert_int_equal(sets(&other_setting), OK);
}

/* modbus_unit.h, fathom_modbus_unit_due_us(): a program that sleeps for it is not kept out longer than another. */
TEST_IN(abandoned, a_program_that_sleeps_until_it_is_due_meets_the_limit)
{
    uint32_t slept_us = 0;
    fake.due_us = 1000;
    PENDS(calls(&look));
    responds(7);
    for (unsigned polls = 0; fake.request == NULL || unit.current != measure.id; polls++) {
        assert_true(polls < 40000);
        const uint32_t due_us = fathom_modbus_unit_due_us(&unit);
        assert_true(due_us <= ABANDONED_US);
        fake.now_us += due_us + 100; /* a poll takes its time */
        slept_us += due_us + 100;
        PENDS(calls(&measure));
    }
    assert_in_range(slept_us, ABANDONED_US, ABANDONED_US + 2200);
}

/* Halfway to the limit a poll is due after 1 ms at least, and after a sixteenth of the limit at most. */
TEST_IN(abandoned, while_an_abandoned_command_is_on_the_wire_a_poll_is_due_when_the_line_is)
{
    static const struct {
        uint32_t line_us, due_us;
    } rows[] = {{0, 1000}, {1000, 1000}, {1001, 1001}, {312500, 312500}, {312501, 312500}};
    PENDS(calls(&look));
    for (unsigned i = 0; i != 25; i++) {
        fake.now_us += STEP_US;
        PENDS(calls(&measure));
    }
    fake.due_us = 312501;
    assert_int_equal(fathom_modbus_unit_due_us(&unit), 312501); /* 2.5 s are left */
    fake.now_us += 1;
    PENDS(calls(&measure));
    for (unsigned i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        fake.due_us = rows[i].line_us;
        assert_int_equal(fathom_modbus_unit_due_us(&unit), rows[i].due_us);
    }
}

TEST_IN(abandoned, a_command_that_has_ended_delays_no_poll)
{
    PENDS(calls(&look));
    responds(7);
    assert_int_equal(calls(&look), OK);
    for (unsigned i = 0; i != 30; i++) {
        fake.now_us += STEP_US;
        fathom_modbus_unit_poll(&unit);
        assert_int_equal(fathom_modbus_unit_due_us(&unit), 0);
    }
}

TEST_IN(abandoned, a_request_that_the_line_has_forgotten_is_cancelled_within_65_ms_and_the_next_one_follows)
{
    PENDS(calls(&measure));
    for (unsigned i = 0; i != 100; i++) {
        fake.now_us += 1000;
        PENDS(calls(&measure));
    }
    fake_modbus_forget(&fake);
    fathom_status_t status = FATHOM_PENDING;
    for (unsigned ms = 0; status == FATHOM_PENDING; ms++) {
        assert_true(ms <= 65);
        fake.now_us += 1000;
        status = calls(&measure);
    }
    assert_int_equal(status, FATHOM_ERR_CANCELLED);
    PENDS(calls(&measure));
    assert_int_equal(fake.submits, 1);
    measures();
}

/* The program initialised the line again, and fathom_line_init() refused the new parts. */
TEST_IN(abandoned,
        a_line_that_is_not_initialised_any_more_is_reported_and_serves_the_unit_again_after_its_next_init)
{
    PENDS(calls(&measure));
    fake_modbus_forget(&fake);
    fake.line.parts = NULL;
    fake.now_us += 1000;
    fake.polls = 0;
    assert_int_equal(calls(&measure), FATHOM_ERR_ARGUMENT);
    assert_int_equal(calls(&look), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_modbus_unit_due_us(&unit), 0);
    fathom_modbus_unit_power_on(&unit, 1000);
    fathom_modbus_unit_cancel(&unit);
    assert_int_equal(fake.submits + fake.polls + fake.cancels, 0);
    fake.line.parts = &fake.parts;
    fake.now_us += TIMEOUT_US;
    PENDS(calls(&measure));
    measures();
}

TEST_IN(abandoned, an_abandoned_setting_gives_way_to_a_blind_setting)
{
    PENDS(sets(&move));
    responds(HERE);
    PENDS(sets(&move));
    assert_int_equal(fathom_modbus_write_next_unchecked(&unit), FATHOM_ERR_BUSY);
    others_call();
    assert_int_equal(fathom_modbus_write_next_unchecked(&unit), OK);
    assert_int_equal(unit.address, HERE);
    PENDS(sets(&other_setting)); /* the write at once */
    assert_int_equal(fake.request->message.head[1], 6);
    fake_modbus_acknowledge(&fake);
    assert_int_equal(sets(&other_setting), FATHOM_ERR_UNCONFIRMED);
}
