/* SPDX-License-Identifier: MIT */
#include "libmodbus_rig.h"

/* A Modbus TCP gateway between the port and its units (fathom_libmodbus.h, rules 6 and 8). */

enum { SECOND_US = 1000000, HOLD_US = 5 * SECOND_US };

static fathom_modbus_request_t other; /* to unit 1, while rig.request is to unit 9 */

static int set_up(void **state)
{
    const fathom_libmodbus_config_t config = {.clock = &rig.fake.clock};
    (void)rig_tcp_set_up(state);
    memset(&rig.port, 0xA5, sizeof rig.port);
    assert_int_equal(fathom_libmodbus_init(&rig.port, rig.modbus, &config), FATHOM_OK);
    rig.transport = rig.port.modbus;
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = rig_tear_down};

/* The request of rig_ask_three to `unit` has this transaction. */
static void expect_request_to(uint8_t unit, uint8_t transaction)
{
    uint8_t request[] = {REQUEST(transaction)};
    request[6] = unit;
    rig_expect_sent(request, sizeof request);
}

/* Asks unit 9, whose request is transaction 1. */
static void ask_9(uint8_t retries)
{
    rig_ask_three(&rig.request, 9, retries);
    rig_run_fine(FINE_US);
    expect_request_to(9, 1);
}

static void ask_1(void) { rig_ask_three(&other, 1, 0); }

/* An exception for transaction `transaction`, as from `unit`. */
static void say_exception(uint8_t transaction, uint8_t unit, uint8_t number)
{
    const uint8_t exception[] = {0xF0, transaction, 0, 0, 0, 3, unit, 0x83, number};
    rig_say(exception, sizeof exception);
}

/* The request to unit 1 leaves after this time and not before. */
static void expect_held(uint32_t for_us, uint8_t transaction)
{
    rig_run_fine(for_us - 500);
    rig_expect_sent(NULL, 0);
    rig_run_fine(1000);
    expect_request_to(1, transaction);
}

/* ---- a gateway that tries a dead unit again ---- */

TEST(no_request_leaves_while_a_response_is_pending)
{
    ask_9(0);
    ask_1();
    rig_run_fine(2200000);
    assert_int_equal(status(), FATHOM_ERR_NO_RESPONSE); /* since RIG_TIMEOUT_US */
    rig_expect_sent(NULL, 0);
    say_exception(1, 9, 0x0B);
    rig_run_fine(2 * FINE_US);
    expect_request_to(1, 2);
    rig_say_response(2);
    rig_run_fine(FINE_US);
    assert_int_equal(other.transaction.status, FATHOM_OK);
    assert_in_range(rig.port.response_us, FINE_US, 2 * FINE_US);
}

TEST(a_request_is_held_back_for_5_s_at_most_also_if_the_other_one_is_cancelled)
{
    for (unsigned is_cancelled = 0; is_cancelled != 2; is_cancelled++) {
        if (is_cancelled != 0) assert_int_equal(rig_tear_down(NULL) + set_up(state), 0);
        ask_9(0);
        if (is_cancelled != 0) fathom_line_cancel(rig.transport.line, &rig.request.transaction);
        ask_1();
        expect_held(HOLD_US, 2);
    }
}

TEST(due_says_when_a_held_request_leaves)
{
    ask_9(0);
    ask_1();
    rig_run_fine(SECOND_US);
    assert_in_range(fathom_line_due_us(rig.transport.line), HOLD_US - SECOND_US - 1000, HOLD_US - SECOND_US);
}

TEST(hold_us_of_the_configuration_counts)
{
    const fathom_libmodbus_config_t config = {.clock = &rig.fake.clock, .hold_us = SECOND_US};
    assert_int_equal(fathom_libmodbus_init(&rig.port, rig.modbus, &config), FATHOM_OK);
    ask_9(0);
    ask_1();
    expect_held(SECOND_US, 2);
}

TEST(hold_us_above_2_31_is_refused)
{
    fathom_libmodbus_config_t config = {.clock = &rig.fake.clock, .hold_us = 0x80000000u};
    assert_int_equal(fathom_libmodbus_init(&rig.port, rig.modbus, &config), FATHOM_ERR_ARGUMENT);
    config.hold_us--;
    assert_int_equal(fathom_libmodbus_init(&rig.port, rig.modbus, &config), FATHOM_OK);
}

/* Many gateways report nothing about a dead unit. They cost hold_us once. */
TEST(a_server_that_reports_nothing_is_waited_for_only_once)
{
    ask_9(0);
    ask_1();
    expect_held(HOLD_US, 2);
    rig_say_response(2);
    rig_run_fine(FINE_US);
    rig_ask_three(&rig.request, 9, 0);
    rig_run_fine(FINE_US);
    expect_request_to(9, 3);
    ask_1();
    expect_held(RIG_TIMEOUT_US, 4);
}

/* The gateway tries unit 9 for 3 s and reports nothing, so the response of unit 1 is late once. */
TEST(how_long_a_dead_unit_keeps_the_gateway_busy_is_measured_once)
{
    static fathom_modbus_request_t third;
    ask_9(0);
    ask_1();
    expect_held(HOLD_US, 2);
    rig_say_response(2);
    rig_run_fine(FINE_US);
    rig_ask_three(&rig.request, 9, 0);
    rig_run_fine(FINE_US);
    expect_request_to(9, 3);
    ask_1();
    expect_held(RIG_TIMEOUT_US, 4);
    rig_ask_three(&third, 2, 0);
    rig_run_fine(3 * SECOND_US - RIG_TIMEOUT_US - 500);
    rig_expect_sent(NULL, 0); /* two requests in a row have no response */
    assert_int_equal(other.transaction.status, FATHOM_ERR_NO_RESPONSE);
    rig_say_response(4);
    rig_run_fine(2 * FINE_US);
    expect_request_to(2, 5);
    say_exception(5, 2, 0x02);
    rig_run_fine(FINE_US);
    for (uint8_t transaction = 6; transaction != 12; transaction += 2) {
        rig_ask_three(&rig.request, 9, 0);
        rig_run_fine(FINE_US);
        expect_request_to(9, transaction);
        ask_1();
        expect_held(3750000, transaction + 1); /* 3 s and a quarter */
        rig_say_response(transaction + 1);
        rig_run_fine(FINE_US);
        assert_int_equal(other.transaction.status, FATHOM_OK);
    }
}

static void ask_9_again(uint8_t transaction)
{
    rig_ask_three(&rig.request, 9, 0);
    rig_run_fine(FINE_US);
    expect_request_to(9, transaction);
}

/* Unit 1 is silent at first, and its response to request 4 shows nothing: it was sent after 5 s. */
TEST(with_two_dead_units_a_response_in_time_to_a_second_request_ends_the_waiting)
{
    ask_9(0);
    ask_1();
    expect_held(HOLD_US, 2);
    rig_run_fine(RIG_TIMEOUT_US);
    assert_int_equal(other.transaction.status, FATHOM_ERR_NO_RESPONSE);
    ask_9_again(3);
    ask_1();
    expect_held(HOLD_US, 4);
    rig_say_response(4);
    rig_run_fine(FINE_US);
    ask_9_again(5);
    ask_1();
    expect_held(RIG_TIMEOUT_US, 6);
    rig_say_response(6);
    rig_run_fine(RIG_TIMEOUT_US); /* unit 9 is in quarantine for twice its time-out */
    ask_9_again(7);
    ask_1();
    expect_held(RIG_TIMEOUT_US, 8);
    rig_run_fine(RIG_TIMEOUT_US);
    ask_9_again(9);
}

TEST(a_late_response_shows_that_waiting_helps)
{
    ask_9(0);
    ask_1();
    expect_held(HOLD_US, 2);
    say_exception(1, 9, 0x0B); /* the gateway gave up after 5 s */
    rig_say_response(2);
    rig_run_fine(FINE_US);
    assert_int_equal(other.transaction.status, FATHOM_OK);
    assert_int_equal(rig.port.late_responses, 1);
    rig_ask_three(&rig.request, 9, 0);
    rig_run_fine(FINE_US);
    expect_request_to(9, 3);
    ask_1();
    rig_run_fine(HOLD_US - SECOND_US);
    rig_expect_sent(NULL, 0);
}

TEST(a_silent_unit_lets_others_go_first_8_times)
{
    enum { MOST = 8 };
    static fathom_modbus_request_t healthy[MOST + 1];
    ask_9(0);
    rig_run_fine(HOLD_US);
    rig_ask_three(&rig.request, 9, 0);
    rig_run_fine(HOLD_US + 1000);
    expect_request_to(9, 2);
    rig_ask_three(&rig.request, 9, 0);
    for (unsigned i = 0; i != MOST + 1; i++) rig_ask_three(&healthy[i], 1, 0);
    for (uint8_t i = 0; i != MOST; i++) {
        rig_run_fine(2 * FINE_US);
        expect_request_to(1, 3 + i);
        rig_say_response(3 + i);
    }
    rig_run_fine(2 * FINE_US);
    expect_request_to(9, 3 + MOST);
}

TEST(a_silent_unit_goes_in_its_turn_after_9_requests_to_others)
{
    ask_9(0);
    rig_run_fine(HOLD_US);
    for (uint8_t i = 0; i != 9; i++) {
        ask_1();
        rig_run_fine(2 * FINE_US);
        expect_request_to(1, 2 + i);
        rig_say_response(2 + i);
        rig_run_fine(FINE_US);
    }
    rig_ask_three(&rig.request, 9, 0);
    ask_1();
    rig_run_fine(2 * FINE_US);
    expect_request_to(9, 11);
}

/* The gateway responds to unit 1 at once, and gives unit 9 up after that. */
TEST(a_late_response_behind_one_in_time_shows_nothing)
{
    ask_9(0);
    ask_1();
    expect_held(HOLD_US, 2);
    rig_say_response(2);
    say_exception(1, 9, 0x0B);
    rig_run_fine(FINE_US);
    assert_int_equal(rig.port.late_responses, 1);
    ask_9_again(3);
    ask_1();
    expect_held(RIG_TIMEOUT_US, 4);
}

TEST(no_response_to_a_broadcast_is_waited_for)
{
    rig.request.transaction.timeout_us = RIG_TIMEOUT_US;
    fathom_modbus_write_single_register(&rig.request.message, 0, 0x0010, 7);
    assert_int_equal(rig.transport.submit(rig.transport.line, &rig.request), FATHOM_PENDING);
    rig_run_fine(FINE_US);
    rig_expect_sent((const uint8_t[]){0xF0, 1, 0, 0, 0, 6, 0, 0x06, 0x00, 0x10, 0x00, 0x07}, 12);
    ask_1();
    expect_held(RIG_TIMEOUT_US, 2);
}

TEST(no_response_is_pending_on_a_new_connection)
{
    ask_9(0);
    rig_hang_up();
    rig_expect_broken(FATHOM_LIBMODBUS_ERR_HUNG_UP);
    rig_connect();
    ask_1();
    rig_run_fine(FINE_US);
    expect_request_to(1, 2);
}

/* ---- a gateway's final word ---- */

TEST(a_final_word_ends_the_attempt_at_once_and_the_retry_leaves)
{
    static const struct {
        uint8_t unit, number;
    } words[] = {{9, 0x0A}, {9, 0x0B}, {0, 0x0B}, {255, 0x06}, {0, 0x06}, {255, 0x04}};
    for (size_t i = 0; i != sizeof words / sizeof words[0]; i++) {
        if (i != 0) assert_int_equal(rig_tear_down(NULL) + set_up(state), 0);
        ask_9(1);
        say_exception(1, words[i].unit, words[i].number);
        rig_run_fine(3 * FINE_US);
        assert_int_equal(status(), FATHOM_PENDING);
        expect_request_to(9, 2);
        rig_run_fine(30000);
        say_exception(2, words[i].unit, words[i].number);
        rig_run_fine(FINE_US);
        assert_int_equal(status(), FATHOM_ERR_NO_RESPONSE); /* a write may have been executed */
        assert_int_equal(rig.request.message.exception, 0);
        assert_int_equal(rig.port.gateway_exception, words[i].number);
        assert_int_equal(rig.port.gateway_unit, 9);
        assert_int_equal(rig.port.gateway_refusals, 2);
        assert_in_range(rig.port.response_us, 30000, 30000 + 2 * FINE_US);
        rig_expect_none();
    }
}

TEST(a_final_word_is_that_of_its_unit_until_the_unit_responds)
{
    ask_9(0);
    say_exception(1, 9, 0x0B);
    ask_1();
    rig_run_fine(3 * FINE_US);
    expect_request_to(1, 2);
    rig_say_response(2);
    rig_run_fine(FINE_US);
    assert_int_equal(rig.port.gateway_exception, 0x0B);
    rig_ask_three(&rig.request, 9, 0);
    rig_run_fine(FINE_US);
    expect_request_to(9, 3);
    assert_int_equal(rig.port.gateway_exception, 0x0B);
    rig_say((const uint8_t[]){0xF0, 3, 0, 0, 0, 9, 9, 0x03, 6, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A}, 15);
    rig_run_fine(FINE_US);
    rig_expect_three();
    assert_int_equal(rig.port.gateway_exception, 0);
}

/* ---- responses that are not ours ---- */

TEST(data_of_another_unit_are_counted_and_end_the_attempt)
{
    static const uint8_t units[] = {0, 2, 255};
    for (size_t i = 0; i != sizeof units; i++) {
        if (i != 0) assert_int_equal(rig_tear_down(NULL) + set_up(state), 0);
        rig_ask(0);
        rig_say((const uint8_t[]){0xF0, 1, 0, 0, 0, 9, units[i], 0x03, 6, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A},
                15);
        rig_run_fine(FINE_US);
        assert_int_equal(status(), FATHOM_ERR_NO_RESPONSE);
        assert_int_equal(rig.port.other_units, 1);
        assert_int_equal(rig.port.other_unit, units[i]);
        rig_expect_none();
    }
}

TEST(an_exception_of_another_unit_is_no_word_of_the_gateway)
{
    ask_9(0);
    say_exception(1, 2, 0x02);
    rig_run_fine(FINE_US);
    assert_int_equal(status(), FATHOM_ERR_NO_RESPONSE);
    assert_int_equal(rig.port.gateway_refusals, 0);
}

TEST(a_response_to_an_old_request_is_late_and_not_measured)
{
    rig.port.sent_count = 0x8000; /* it stops there */
    rig.port.transaction = 0xF0FF;
    rig_ask_three(&rig.request, 1, 0);
    rig_run_fine(FINE_US);
    rig_say((const uint8_t[]){OTHER(9)}, 15);
    rig_run_fine(FINE_US);
    assert_int_equal(rig.port.late_responses, 1);
    assert_int_equal(rig.port.response_us, 0);
}

/* Each response has the identifier of the request before. */
TEST(an_identifier_that_the_server_has_used_is_made_up)
{
    rig_ask(0);
    rig_say((const uint8_t[]){OTHER(0)}, 15);
    rig_run_fine(RIG_TIMEOUT_US + 1000);
    rig_expect_none();
    rig_ask_three(&other, 2, 0);
    rig_run_fine(FINE_US);
    expect_request_to(2, 2);
    rig_say((const uint8_t[]){OTHER(1)}, 15);
    rig_run_fine(RIG_TIMEOUT_US + 1000);
    assert_int_equal(other.transaction.status, FATHOM_ERR_NO_RESPONSE);
    assert_int_equal(rig.port.foreign_responses, 2);
    assert_int_equal(rig.port.late_responses, 0);
}

/* Unit 255 stands for the unit that responds (modbus.h). */
TEST(a_request_to_any_unit_is_answered_by_any)
{
    rig_ask_three(&rig.request, 255, 0);
    rig_run_fine(FINE_US);
    expect_request_to(255, 1);
    rig_answered(1);
    assert_int_equal(rig.port.other_units, 0);
}

TEST(a_server_that_makes_up_identifiers_is_counted_and_not_waited_for)
{
    rig_ask(0);
    rig_say((const uint8_t[]){OTHER(2)}, 15);
    rig_run_fine(RIG_TIMEOUT_US + 1000);
    assert_int_equal(status(), FATHOM_ERR_NO_RESPONSE);
    rig_expect_none();
    assert_int_equal(rig.port.foreign_responses, 1);
    assert_int_equal(rig.port.late_responses, 0);
    rig_ask_three(&other, 2, 0);
    rig_run_fine(FINE_US);
    expect_request_to(2, 2);
}

TEST(a_late_response_is_measured)
{
    ask_9(0);
    rig_run_fine(2500000);
    rig_say((const uint8_t[]){0xF0, 1, 0, 0, 0, 9, 9, 0x03, 6, 0, 1, 0, 2, 0, 3}, 15);
    rig_run_fine(FINE_US);
    assert_in_range(rig.port.response_us, 2500000, 2500000 + 2 * FINE_US);
    rig_expect_none();
}
