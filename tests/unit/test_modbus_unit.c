/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake_modbus.h"
#include "fathom/modbus_unit.h"

enum { UNIT = 9, PACE_US = 100000, TIMEOUT_US = 300000, GUARD16 = 0xA5A5 };

static fake_modbus_t fake;
static fathom_modbus_unit_t unit;
static uint16_t values[11];

/* As drivers use them: one repeated question, and two commands. */
static const fathom_modbus_question_t measure = {TIMEOUT_US, PACE_US, 0, NULL,  values,
                                                 0x0100,     1,       2, false, 0};
static const fathom_modbus_question_t version = {1000000, PACE_US, 0, NULL, values, 0x0001, 3, 0, true, 0};
static const fathom_modbus_question_t details = {1000000, PACE_US, 0, NULL, values, 0x0003, 11, 0, true, 0};

static const uint16_t one_value[] = {754};
static const uint16_t three_values[] = {0x1409, 0x1B02, 0x0100};

static int set_up_at(uint32_t now_us)
{
    fake_modbus_init(&fake);
    fake.now_us = now_us;
    memset(values, 0xA5, sizeof values);
    memset(&unit, 0x5A, sizeof unit);
    assert_int_equal(fathom_modbus_unit_init(&unit, &fake.modbus, &fake.clock, UNIT), FATHOM_READY);
    return 0;
}

static int set_up(void **state) { return set_up_at(5000); }

static const suite_t suite = {.set_up = set_up};

static fathom_status_t read_after(uint32_t us, const fathom_modbus_question_t *question)
{
    fake.now_us += us;
    return fathom_modbus_unit_ask(&unit, question);
}

static void pending_after(uint32_t us, const fathom_modbus_question_t *question)
{
    assert_int_equal(read_after(us, question), FATHOM_PENDING);
}

/* The question is asked, and its request is on the wire. */
static void ask_and_send(const fathom_modbus_question_t *question)
{
    const unsigned before = fake.submits;
    pending_after(0, question);
    assert_int_equal(fake.submits, before + 1);
    fake_modbus_send(&fake);
    pending_after(0, question);
}

static uint32_t due(void) { return fathom_modbus_unit_due_us(&unit); }

/* ---- setting up ---- */

TEST(a_unit_needs_a_carrier_a_clock_and_an_address_of_one_device)
{
    fathom_modbus_unit_t other;
    assert_int_equal(fathom_modbus_unit_init(&other, NULL, &fake.clock, 1), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_modbus_unit_init(&other, &fake.modbus, NULL, 1), FATHOM_ERR_ARGUMENT);
    for (unsigned address = 0; address != 256; address++)
        assert_int_equal(fathom_modbus_unit_init(&other, &fake.modbus, &fake.clock, (uint8_t)address),
                         address == 0 || address == 255 ? FATHOM_ERR_ARGUMENT : FATHOM_READY);
    assert_int_equal(fake.polls + fake.submits, 0);
}

TEST(the_first_question_goes_out_at_once_just_as_it_was_asked)
{
    pending_after(0, &measure);
    fake_modbus_assert_asked(&fake, 1, UNIT, 0x0100, 1);
    assert_int_equal(fake.request->exchange.timeout_us, TIMEOUT_US);
    assert_int_equal(fake.request->exchange.retries, 2);
    assert_ptr_equal(fake.request->message.values, values);
}

/* ---- outcomes ---- */

TEST(an_answer_is_handed_over_once)
{
    ask_and_send(&measure);
    fake.heard_us = 4711;
    fake_modbus_answer(&fake, one_value, 1);
    assert_int_equal(read_after(10, &measure), FATHOM_READY);
    assert_int_equal(values[0], 754);
    assert_int_equal(unit.heard_us, 4711);
    assert_int_equal(unit.answers, 1);
    assert_int_equal(unit.failures, 0);
    for (unsigned i = 0; i != 5; i++) pending_after(10, &measure);
    assert_int_equal(fake.submits, 1);
}

TEST(every_error_is_handed_over_once_and_the_next_attempt_follows)
{
    static const fathom_status_t errors[] = {FATHOM_ERR_NO_ANSWER, FATHOM_ERR_CHECKSUM, FATHOM_ERR_EXCEPTION,
                                             FATHOM_ERR_MALFORMED, FATHOM_ERR_PORT,     FATHOM_ERR_CANCELLED};
    for (unsigned i = 0; i != sizeof errors / sizeof *errors; i++) {
        ask_and_send(&measure);
        fake.exception = 4;
        fake_modbus_fail(&fake, errors[i]);
        assert_int_equal(read_after(10, &measure), errors[i]);
        assert_int_equal(unit.failures, i + 1);
        assert_int_equal(unit.answers, 0);
        assert_int_equal(values[0], GUARD16);
        pending_after(PACE_US - 11, &measure);
        assert_int_equal(fake.submits, i + 1);
        fake.now_us += 1;
    }
    assert_int_equal(unit.request.message.exception, 0);
}

TEST(the_number_of_an_exception_stands_in_the_request)
{
    ask_and_send(&measure);
    fake_modbus_refuse(&fake, 171);
    assert_int_equal(read_after(10, &measure), FATHOM_ERR_EXCEPTION);
    assert_int_equal(unit.request.message.exception, 171);
}

TEST(a_request_that_the_carrier_does_not_take_is_tried_again_each_time)
{
    static const fathom_status_t errors[] = {FATHOM_ERR_ARGUMENT, FATHOM_ERR_CAPACITY, FATHOM_ERR_BUSY};
    for (unsigned i = 0; i != 3; i++) {
        fake.refuses = errors[i];
        assert_int_equal(read_after(1, &measure), errors[i]);
        assert_int_equal(read_after(1, &measure), errors[i]);
        assert_int_equal(due(), 0);
    }
    fake.refuses = 0;
    ask_and_send(&measure);
    assert_int_equal(unit.failures, 0);
}

TEST(the_counters_stop_at_65535)
{
    unit.answers = 65534;
    unit.failures = 65534;
    for (unsigned i = 0; i != 3; i++) {
        ask_and_send(&measure);
        fake_modbus_answer(&fake, one_value, 1);
        assert_int_equal(read_after(PACE_US, &measure), FATHOM_READY);
        ask_and_send(&measure);
        fake_modbus_fail(&fake, FATHOM_ERR_NO_ANSWER);
        assert_int_equal(read_after(PACE_US, &measure), FATHOM_ERR_NO_ANSWER);
        assert_int_equal(unit.answers, 65535);
        assert_int_equal(unit.failures, 65535);
    }
}

/* ---- pace ---- */

TEST(the_pace_counts_from_the_request_on_the_wire)
{
    pending_after(0, &measure);
    for (unsigned i = 0; i != 100; i++) pending_after(PACE_US, &measure); /* in a long queue */
    fake_modbus_send(&fake);
    pending_after(20, &measure); /* in this poll it leaves */
    fake_modbus_answer(&fake, one_value, 1);
    assert_int_equal(read_after(40000, &measure), FATHOM_READY);
    pending_after(PACE_US - 40001, &measure);
    assert_int_equal(fake.submits, 1);
    pending_after(1, &measure);
    assert_int_equal(fake.submits, 2);
}

TEST(the_pace_does_not_count_what_passed_before_the_poll_that_sent_it)
{
    pending_after(0, &measure);
    fake_modbus_answer(&fake, one_value, 1); /* a slow loop: sent and answered since the last poll */
    assert_int_equal(read_after(3 * PACE_US, &measure), FATHOM_READY);
    pending_after(PACE_US - 1, &measure);
    assert_int_equal(fake.submits, 1);
    pending_after(1, &measure);
    assert_int_equal(fake.submits, 2);
}

/* modbus_unit.h: "from this request to the next one to the unit, at least"; a retry is a request too. */
TEST(the_pace_counts_from_the_last_attempt)
{
    ask_and_send(&measure);
    pending_after(6 * PACE_US, &measure);
    fake_modbus_send(&fake);
    pending_after(0, &measure);
    assert_int_equal(fake.request->exchange.attempts, 2);
    fake_modbus_answer(&fake, one_value, 1);
    assert_int_equal(read_after(25000, &measure), FATHOM_READY);
    pending_after(PACE_US - 25001, &measure);
    assert_int_equal(fake.submits, 1);
    pending_after(1, &measure);
    assert_int_equal(fake.submits, 2);
}

TEST(an_answer_slower_than_the_pace_is_followed_at_once)
{
    ask_and_send(&measure);
    fake_modbus_answer(&fake, one_value, 1);
    assert_int_equal(read_after(PACE_US, &measure), FATHOM_READY);
    pending_after(0, &measure);
    assert_int_equal(fake.submits, 2);
}

TEST(the_pace_holds_across_the_wrap_of_the_clock)
{
    for (uint32_t before_us = 0; before_us <= PACE_US; before_us += 10000) {
        set_up_at(UINT32_MAX - before_us);
        ask_and_send(&measure);
        fake_modbus_answer(&fake, one_value, 1);
        assert_int_equal(read_after(30000, &measure), FATHOM_READY);
        assert_int_equal(due(), PACE_US - 30000);
        pending_after(PACE_US - 30001, &measure);
        assert_int_equal(fake.submits, 1);
        pending_after(1, &measure);
        assert_int_equal(fake.submits, 2);
    }
}

/* ---- commands beside the repeated question ---- */

TEST(a_command_waits_for_a_measurement_and_takes_its_place)
{
    ask_and_send(&measure);
    pending_after(10, &version);
    assert_int_equal(fake.submits, 1);
    fake_modbus_answer(&fake, one_value, 1);
    pending_after(10, &version); /* the measurement's outcome is dropped */
    pending_after(PACE_US - 21, &version);
    assert_int_equal(fake.submits, 1);
    pending_after(1, &version);
    fake_modbus_assert_asked(&fake, 2, UNIT, 0x0001, 3);
    assert_int_equal(unit.answers, 1);
    fake_modbus_answer(&fake, three_values, 3);
    assert_int_equal(read_after(10, &version), FATHOM_READY);
    assert_memory_equal(values, three_values, sizeof three_values);
}

TEST(a_measurement_waits_until_the_outcome_of_a_command_was_taken)
{
    ask_and_send(&version);
    pending_after(10, &measure);
    fake_modbus_answer(&fake, three_values, 3);
    for (unsigned i = 0; i != 5; i++) pending_after(PACE_US, &measure);
    assert_int_equal(fake.submits, 1);
    assert_memory_equal(values, three_values, sizeof three_values);
    assert_int_equal(read_after(10, &version), FATHOM_READY);
    assert_int_equal(unit.answers, 1);
    pending_after(0, &measure);
    fake_modbus_assert_asked(&fake, 2, UNIT, 0x0100, 1);
}

TEST(an_error_of_a_command_waits_for_who_asked_too)
{
    ask_and_send(&version);
    fake_modbus_refuse(&fake, 2);
    pending_after(PACE_US, &measure);
    pending_after(PACE_US, &measure);
    assert_int_equal(read_after(0, &version), FATHOM_ERR_EXCEPTION);
    assert_int_equal(unit.request.message.exception, 2);
}

TEST(a_second_command_is_told_busy_until_the_first_was_taken)
{
    ask_and_send(&version);
    assert_int_equal(read_after(10, &details), FATHOM_ERR_BUSY);
    fake_modbus_answer(&fake, three_values, 3);
    assert_int_equal(read_after(10, &details), FATHOM_ERR_BUSY);
    assert_int_equal(read_after(PACE_US, &details), FATHOM_ERR_BUSY);
    assert_int_equal(fake.submits, 1);
    assert_int_equal(read_after(10, &version), FATHOM_READY);
    pending_after(10, &details);
    fake_modbus_assert_asked(&fake, 2, UNIT, 0x0003, 11);
}

TEST(another_repeated_question_replaces_the_first_when_that_has_ended)
{
    const fathom_modbus_question_t other = {TIMEOUT_US, PACE_US, 0, NULL, values, 0x0101, 1, 0, false, 0};
    ask_and_send(&measure);
    pending_after(10, &other);
    fake_modbus_answer(&fake, one_value, 1);
    pending_after(PACE_US, &other);
    fake_modbus_assert_asked(&fake, 2, UNIT, 0x0101, 1);
}

TEST(registers_with_one_equal_byte_are_two_questions)
{
    const fathom_modbus_question_t high = {TIMEOUT_US, PACE_US, 0, NULL, values, 0x0000, 1, 0, false, 0};
    const fathom_modbus_question_t low = {TIMEOUT_US, PACE_US, 0, NULL, values, 0x0101, 1, 0, false, 0};
    ask_and_send(&version); /* 0001 */
    fake_modbus_answer(&fake, three_values, 3);
    pending_after(PACE_US, &high);
    pending_after(PACE_US, &measure); /* 0100 */
    pending_after(PACE_US, &low);
    assert_int_equal(read_after(0, &version), FATHOM_READY);
}

/* ---- cancel ---- */

TEST(cancel_ends_a_request_under_way_once)
{
    ask_and_send(&version);
    fathom_modbus_unit_cancel(&unit);
    fathom_modbus_unit_cancel(&unit);
    assert_int_equal(fake.cancels, 1);
    assert_null(fake.request);
    pending_after(PACE_US - 1, &measure); /* and keeps the pace */
    assert_int_equal(fake.submits, 1);
    pending_after(1, &measure);
    fake_modbus_assert_asked(&fake, 2, UNIT, 0x0100, 1);
}

TEST(cancel_forgets_an_outcome_that_nobody_took)
{
    ask_and_send(&version);
    fake_modbus_answer(&fake, three_values, 3);
    pending_after(10, &measure);
    fathom_modbus_unit_cancel(&unit);
    assert_int_equal(fake.cancels, 0);
    pending_after(PACE_US, &version);
    assert_int_equal(fake.submits, 2);
}

TEST(cancel_of_nothing_does_nothing)
{
    fathom_modbus_unit_cancel(&unit);
    assert_int_equal(fake.cancels, 0);
    ask_and_send(&measure);
}

/* ---- due ---- */

TEST(it_is_due_at_once_when_it_may_ask)
{
    assert_int_equal(due(), 0);
    fake.now_us += 1000000;
    assert_int_equal(due(), 0);
}

TEST(it_is_due_when_the_carrier_is_while_it_waits)
{
    ask_and_send(&measure);
    fake.due_us = 1234;
    assert_int_equal(due(), 1234);
    fake.due_us = FATHOM_NO_DEADLINE;
    assert_true(due() == FATHOM_NO_DEADLINE);
}

TEST(it_is_due_after_the_pause_counted_from_now)
{
    ask_and_send(&measure);
    fake_modbus_answer(&fake, one_value, 1);
    assert_int_equal(read_after(30000, &measure), FATHOM_READY);
    assert_int_equal(due(), PACE_US - 30000);
    fake.now_us += 50000;
    assert_int_equal(due(), PACE_US - 80000);
    fake.now_us += 20000;
    assert_int_equal(due(), 0);
    fake.now_us += 1;
    assert_int_equal(due(), 0);
}

TEST(it_is_due_at_once_with_an_outcome_to_take)
{
    ask_and_send(&version);
    fake_modbus_answer(&fake, three_values, 3);
    pending_after(10, &measure);
    assert_int_equal(due(), 0);
}

/* Several drivers share a carrier, so that one driver's poll may end another's request. */
TEST(it_is_due_at_once_when_anothers_poll_has_ended_its_request)
{
    ask_and_send(&measure);
    fake_modbus_answer(&fake, one_value, 1);
    fake.modbus.poll(fake.modbus.ctx);
    assert_int_equal(due(), 0);
}

/* ---- a broken carrier ---- */

TEST(a_broken_carrier_is_said_by_every_read_and_nothing_is_asked)
{
    fake.carrier = FATHOM_ERR_PORT;
    assert_int_equal(read_after(0, &measure), FATHOM_ERR_PORT);
    assert_int_equal(read_after(0, &version), FATHOM_ERR_PORT);
    assert_int_equal(fake.submits, 0);
    fake.carrier = FATHOM_PENDING;
    pending_after(0, &measure);
    assert_int_equal(fake.submits, 1);
}

TEST(what_was_under_way_when_the_carrier_broke_has_its_own_outcome_first)
{
    ask_and_send(&measure);
    fake.carrier = FATHOM_ERR_PORT;
    fake_modbus_answer(&fake, one_value, 1);
    assert_int_equal(read_after(0, &measure), FATHOM_READY);
    assert_int_equal(read_after(0, &measure), FATHOM_ERR_PORT);
}

/* ---- whose turn it is ---- */

TEST(a_command_that_waits_for_the_pause_comes_before_the_repeated_question)
{
    ask_and_send(&measure);
    fake_modbus_answer(&fake, one_value, 1);
    assert_int_equal(read_after(1000, &measure), FATHOM_READY);
    pending_after(1000, &version);
    pending_after(PACE_US, &measure); /* the pause is over, but a command waits */
    assert_int_equal(fake.submits, 1);
    assert_int_equal(read_after(0, &details), FATHOM_ERR_BUSY); /* another one must not overtake it */
    pending_after(0, &version);
    fake_modbus_assert_asked(&fake, 2, UNIT, 0x0001, 3);
}

TEST(cancel_gives_up_a_command_that_waits)
{
    ask_and_send(&measure);
    fake_modbus_answer(&fake, one_value, 1);
    assert_int_equal(read_after(1000, &measure), FATHOM_READY);
    pending_after(1000, &version);
    fathom_modbus_unit_cancel(&unit);
    pending_after(PACE_US, &measure);
    fake_modbus_assert_asked(&fake, 2, UNIT, 0x0100, 1);
}
