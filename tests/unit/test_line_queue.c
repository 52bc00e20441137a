/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* Transactions that wait: for their turn, for a retry, for the end of a quarantine; and how long that is. */

static const suite_t suite = {.set_up = set_up};
static const suite_t asked = {.set_up = set_up_asked};
static const suite_t quarantined = {.set_up = set_up_quarantined};

TEST_IN(asked, one_that_waits_can_be_cancelled_without_harm_to_the_one_on_the_wire)
{
    ask_other(2);
    cancel(&bench.other);
    expect_other(FATHOM_ERR_CANCELLED);
    expect(FATHOM_PENDING);
    response_1(754);
    ask_other(2); /* it was never asked, so it is not quarantined */
    expect_written_after(REQUEST_US, 2);
    receive_response(2, 222);
    ask_1(0); /* nor is the one that has answered */
    expect_written_after(T3_5_US + 400, 3);
}

TEST(one_in_the_middle_of_the_queue_can_be_cancelled)
{
    fathom_modbus_request_t third;
    uint16_t third_value;
    memset(&third, 0, sizeof third);
    ask_1_and_send(0);
    ask_other(2);
    ask(&third, 3, &third_value, 0);
    cancel(&bench.other);
    receive_all(response_1_754);
    expect_written_after(REQUEST_US, 2);
    expect_unit(1, 3);
    deliver_response(3, 333);
    assert_int_equal(third_value, 333);
}

/* From the quarantined unit, but three registers instead of one. */
TEST(a_late_frame_that_does_not_answer_the_retry_ends_the_quarantine_and_no_more)
{
    ask_1_and_send(1);
    run(TIMEOUT_US + 200);
    deliver_all(response_1_three);
    expect_count(FATHOM_LINE_LATE_RESPONSES, 1);
    expect_count(FATHOM_LINE_DROPPED_BYTES, sizeof response_1_three);
    expect_failed(FATHOM_PENDING);
    expect_written_after(REQUEST_US, 2); /* it is quarantined no more */
    response_1(111);
}

/* The long quarantine of unit 2 has ended; what is left of its time is not unit 1's. */
TEST(a_quarantine_lasts_no_longer_because_of_one_that_has_ended)
{
    ask_other(2);
    bench.other.transaction.timeout_us = 10 * TIMEOUT_US;
    run(REQUEST_US);
    cancel(&bench.other);
    deliver_response(2, 222);
    expect_count(FATHOM_LINE_LATE_RESPONSES, 1);
    ask_1(1);
    run(REQUEST_US + TIMEOUT_US);
    expect_written(2);
    expect_written_after(TIMEOUT_US + 400, 3);
}

TEST(a_late_exception_ends_the_retry)
{
    ask_1_and_send(1);
    run(TIMEOUT_US + 200);
    deliver_all(exception_1_2);
    expect(FATHOM_ERR_EXCEPTION);
    assert_int_equal(bench.request.message.exception, 2);
}

/* ---- how long until poll has something to do ---- */

TEST_IN(quarantined, what_only_waits_for_a_quarantine_is_due_when_that_ends)
{
    ask_1(0);
    const uint32_t due_us = due();
    assert_true(due_us > TIMEOUT_US - 1000 && due_us <= TIMEOUT_US);
    run_in_steps(due_us, due_us);
    expect_written(2);
}
