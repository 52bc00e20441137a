/* SPDX-License-Identifier: MIT */
#include "libmodbus_rig.h"

static const uint8_t other_1[] = {OTHER(1)};

static const suite_t suite = {.set_up = rig_tcp_set_up, .tear_down = rig_tear_down};

/* HPS-167S #8: 7 to 0x0010, which is what has to leave. */
static const uint8_t *write_7(uint8_t unit)
{
    static uint8_t write[] = {0xF0, 1, 0, 0, 0, 6, 1, 0x06, 0x00, 0x10, 0x00, 0x07};
    write[6] = unit;
    rig.request.transaction.timeout_us = RIG_TIMEOUT_US;
    fathom_modbus_write_single_register(&rig.request.message, unit, 0x0010, 7);
    assert_int_equal(rig.transport.submit(rig.transport.line, &rig.request), FATHOM_PENDING);
    rig_run_fine(FINE_US);
    rig_expect_sent(write, sizeof write);
    return write;
}

TEST(a_write_is_acknowledged_by_its_own_words_at_once)
{
    rig_say(write_7(1), 12);
    rig_run_fine(FINE_US);
    assert_int_equal(status(), FATHOM_OK); /* TCP has no echo */
}

TEST(a_broadcast_needs_no_response)
{
    (void)write_7(0);
    rig_run_fine(RIG_TIMEOUT_US - 1000);
    assert_int_equal(status(), FATHOM_PENDING);
    rig_run_fine(2000);
    assert_int_equal(status(), FATHOM_OK);
}

TEST(a_loop_of_20_ms_has_the_response_in_the_poll_that_finds_it)
{
    rig_ask_three(&rig.request, 1, 0);
    rig_run(SLOW_US, SLOW_US);
    rig_expect_request(1);
    rig_run(3 * SLOW_US, SLOW_US);
    rig_say_response(1);
    rig_run(SLOW_US, SLOW_US);
    rig_expect_three();
}

TEST(the_wrap_of_the_clock_changes_nothing)
{
    rig.fake.now_us = UINT32_MAX - RIG_TIMEOUT_US / 2;
    (void)fathom_line_poll(rig.transport.line);
    rig_ask(0);
    rig_run_fine(RIG_TIMEOUT_US - 1000);
    assert_int_equal(status(), FATHOM_PENDING);
    assert_int_equal(fathom_line_due_us(rig.transport.line),
                     1100); /* that it has left is seen by the poll after */
    rig_run_fine(1100);
    assert_int_equal(status(), FATHOM_ERR_NO_RESPONSE);
}

TEST(requests_go_in_the_order_of_their_coming_and_a_dead_unit_does_not_hold_up_the_others)
{
    static const uint8_t to_2[] = {0xF0, 2, 0, 0, 0, 6, 2, 3, 1, 7, 0, 3};
    static const uint8_t from_2[] = {0xF0, 2, 0, 0, 0, 9, 2, 3, 6, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A};
    static const uint8_t to_1[] = {REQUEST(3)};
    fathom_modbus_request_t second;
    rig_ask_three(&rig.request, 1, 1);
    rig_ask_three(&second, 2, 0);
    rig_run_fine(FINE_US);
    rig_expect_request(1);
    rig_run_fine(RIG_TIMEOUT_US + FINE_US);
    rig_expect_sent(to_2, sizeof to_2);
    rig_say(from_2, sizeof from_2);
    rig_run_fine(FINE_US);
    assert_int_equal(second.transaction.status, FATHOM_OK);
    assert_int_equal(status(), FATHOM_PENDING);
    rig_run_fine(RIG_TIMEOUT_US);
    rig_expect_sent(to_1, sizeof to_1);
}

TEST(a_cancelled_request_is_forgotten_and_its_response_too)
{
    rig_ask(0);
    fathom_line_cancel(rig.transport.line, &rig.request.transaction);
    assert_int_equal(status(), FATHOM_ERR_CANCELLED);
    rig_ask_three(&rig.request, 1, 0);
    rig_say(other_1, sizeof other_1);
    rig_run_fine(1000);
    assert_int_equal(status(), FATHOM_PENDING);
    rig_expect_none();
    rig_expect_request(2);
    rig_answered(2);
}

TEST(what_was_asked_of_a_unit_is_cancelled_and_the_others_requests_are_not)
{
    fathom_modbus_request_t second, third;
    rig_ask(0);
    rig_ask_three(&second, 2, 0);
    rig_ask_three(&third, 1, 0);
    fathom_line_cancel_unit(rig.transport.line, 1);
    assert_int_equal(status(), FATHOM_ERR_CANCELLED);
    assert_int_equal(third.transaction.status, FATHOM_ERR_CANCELLED);
    assert_int_equal(second.transaction.status, FATHOM_PENDING);
}
