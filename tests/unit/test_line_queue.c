/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* Exchanges that wait: for their turn, for a retry, for what is owed; and how long that is. */

static const suite_t suite = {.set_up = set_up};

TEST(one_that_waits_can_be_cancelled_without_harm_to_the_one_on_the_wire)
{
    ask_1_and_send(0);
    ask(&bench.other, 2, &bench.other_value, 0);
    fathom_line_cancel(&bench.line, &bench.other.exchange);
    assert_int_equal(status_of(&bench.other), FATHOM_ERR_CANCELLED);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    receive(answer_1_754, sizeof answer_1_754);
    run(100);
    assert_int_equal(bench.value, 754);
    ask(&bench.other, 2, &bench.other_value, 0); /* it was never asked, so it owes nothing */
    run(T3_5_US + 8 * BYTE_US + 400);
    assert_int_equal(bench.fake.written, 2);
    receive_answer(2, 222);
    ask(&bench.request, 1, &bench.value, 0); /* nor does the one that has answered */
    run(T3_5_US + 400);
    assert_int_equal(bench.fake.written, 3);
}

TEST(one_in_the_middle_of_the_queue_can_be_cancelled)
{
    fathom_modbus_request_t third;
    uint16_t third_value;
    memset(&third, 0, sizeof third);
    ask_1_and_send(0);
    ask(&bench.other, 2, &bench.other_value, 0);
    ask(&third, 3, &third_value, 0);
    fathom_line_cancel(&bench.line, &bench.other.exchange);
    receive(answer_1_754, sizeof answer_1_754);
    run(T3_5_US + 8 * BYTE_US + 400);
    assert_int_equal(bench.fake.written, 2);
    assert_int_equal(bench.fake.writes[1].bytes[0], 3);
    receive_answer(3, 333);
    run(100);
    assert_int_equal(third_value, 333);
}

/* From the unit that owes one, but three registers instead of one. */
TEST(a_late_frame_that_does_not_answer_the_retry_clears_the_debt_and_no_more)
{
    ask_1_and_send(1);
    run(TIMEOUT_US + 200);
    receive(answer_1_three, sizeof answer_1_three);
    run(100);
    assert_int_equal(counter(FATHOM_LINE_LATE_ANSWERS), 1);
    assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), sizeof answer_1_three);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    assert_int_equal(bench.value, 0xDEAD);
    run(T3_5_US + 8 * BYTE_US + 400);
    assert_int_equal(bench.fake.written, 2); /* it owes nothing any more */
    receive_answer(1, 111);
    run(100);
    assert_int_equal(bench.value, 111);
}

TEST(a_late_exception_ends_the_retry)
{
    ask_1_and_send(1);
    run(TIMEOUT_US + 200);
    receive(exception_1_2, sizeof exception_1_2);
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_EXCEPTION);
    assert_int_equal(bench.request.message.exception, 2);
}

/* ---- how long until poll has something to do ---- */

TEST(after_a_long_silence_a_request_is_due_at_once)
{
    run(20000);
    assert_true(fathom_line_due_us(&bench.line) == FATHOM_NO_DEADLINE);
    ask(&bench.request, 1, &bench.value, 0);
    assert_int_equal(fathom_line_due_us(&bench.line), 0);
    fathom_line_poll(&bench.line);
    assert_int_equal(bench.fake.written, 1);
    assert_int_equal(fathom_line_due_us(&bench.line), 1000); /* while it leaves */
}

TEST(the_end_of_a_damaged_answer_is_due_at_its_gap)
{
    static const uint8_t damaged[] = {0x01, 0x03, 0x02, 0x02, 0xF2, 0x00, 0x00}; /* the CRC is 38 A1 */
    ask_1_and_send(0);
    receive(damaged, sizeof damaged);
    fathom_line_poll(&bench.line);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    assert_int_equal(fathom_line_due_us(&bench.line), GAP_US);
    run_in_steps(GAP_US, GAP_US);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_CHECKSUM);
}

TEST(what_only_waits_for_a_debt_is_due_when_that_is_forgotten)
{
    ask_1_and_send(0);
    run(TIMEOUT_US + 200);
    ask(&bench.request, 1, &bench.value, 0);
    const uint32_t due_us = fathom_line_due_us(&bench.line);
    assert_true(due_us > TIMEOUT_US - 1000 && due_us <= TIMEOUT_US);
    run_in_steps(due_us, due_us);
    assert_int_equal(bench.fake.written, 2);
}
