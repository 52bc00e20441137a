/* SPDX-License-Identifier: MIT */
#include "line_conversation.h"

/* Unit 255, the one that answers first, and a unit that has another address from now on. */

/* FF + FF + 10 = 20E. */
static void ask_any(void)
{
    const size_t before = bench.fake.written;
    ask_dyp(&bench.request, 255, 1, &bench.value);
    run(T3_5_US + 200);
    expect_hex(before, "55 AA FF 10 0E");
    run(5 * BYTE_US + 100);
}

static const suite_t suite = {.set_up = set_up};

TEST(any_unit_may_answer_who_asked_them_all)
{
    for (unsigned unit = 1; unit != 255; unit++) {
        set_up(state);
        ask_any();
        /* 07xx mm at probe 1, where xx is the unit; 55 + AA + 10 + 07 = 116 */
        const uint8_t low = (uint8_t)unit;
        const uint8_t frame[] = {0x55, 0xAA, low, 0x10, 0x07, low, (uint8_t)(0x116 + 2 * low)};
        deliver_all(frame);
        expect_mm((uint16_t)(0x0700 + unit));
        assert_int_equal(bench.request.message.head[0], unit);
    }
}

TEST(after_a_request_to_unit_255_none_is_asked_until_twice_its_time_out)
{
    for (unsigned unit = 1; unit != 255; unit++) {
        set_up(state);
        ask_any();
        expect_after(TIMEOUT_US + 200, FATHOM_ERR_NO_RESPONSE);
        ask_other((uint8_t)unit);
        run_in_steps(TIMEOUT_US - 1000, 500);
        expect_written(1);
        expect_written_after(1500, 2);
    }
}

#define ASK_ANY       STEP(ask_any, .which = A)
#define QUEUE_DYP(to) STEP(queue_dyp, .which = B, .unit = (to))

static void play_ask_any(const step_t *step) { ask_any(); }
static void play_queue_dyp(const step_t *step) { ask_dyp(&bench.other, step->unit, 1, &bench.other_value); }

static const conversation_t conversations[] = {
    /* FF + 09 + 10 + 07 + A1 = 1C0 */
    ROW("a_late_response_to_a_request_to_unit_255_is_no_other_requests",
        COUNTS(.no_responses = 1, .late = 1, .dropped = 7), ASK_ANY, WAIT(TIMEOUT_US + 200), QUEUE_DYP(9),
        WAIT(20000), RECEIVE("55 AA 09 10 07 A1 C0"), COUNT(LATE_RESPONSES, 1), PENDS(B)),
    ROW("a_cancelled_request_to_unit_255_quarantines_all", COUNTS(0), ASK_ANY, CANCEL(A), QUEUE(B, 77),
        SENT(2 * TIMEOUT_US - 1000, 2000)),
    /* two A05 respond to FF, the second one 10 ms later (A05 2(3)1: 65..75 ms); FF + FE + 10 + 07 + A1 = 2B5 */
    ROW("the_second_response_to_unit_255_is_not_the_next_requests",
        COUNTS(.responses = 1, .late = 1, .dropped = 7), ASK_ANY, WAIT(65000),
        RECEIVE("55 AA 05 10 07 A1 BC"), READS(A, 1953), QUEUE_DYP(254), WAIT(10000),
        RECEIVE("55 AA FE 10 07 A1 B5"), PENDS(B)),
};
CONVERSATIONS(set_up, conversations)

/* ---- a unit that has another address from now on: what was asked of the old one ends, and nothing else ---- */

static fathom_modbus_request_t requests[4];
static uint16_t values[4];

/* Submits one request a unit, in this order. */
static void ask_all(const uint8_t units[4])
{
    memset(requests, 0, sizeof requests);
    for (unsigned i = 0; i != 4; i++) ask(&requests[i], units[i], &values[i], 0);
}

static void assert_statuses(fathom_status_t first, fathom_status_t second, fathom_status_t third,
                            fathom_status_t fourth)
{
    assert_int_equal(status_of(&requests[0]), first);
    assert_int_equal(status_of(&requests[1]), second);
    assert_int_equal(status_of(&requests[2]), third);
    assert_int_equal(status_of(&requests[3]), fourth);
}

TEST(all_that_wait_for_a_unit_end_and_the_others_go_out_in_their_order)
{
    static const uint8_t units[4] = {3, 2, 3, 4};
    ask_all(units);
    fathom_line_cancel_unit(&bench.line, 3);
    assert_statuses(FATHOM_ERR_CANCELLED, FATHOM_PENDING, FATHOM_ERR_CANCELLED, FATHOM_PENDING);
    run(REQUEST_US);
    receive_response(2, 222);
    run(REQUEST_US);
    deliver_response(4, 444);
    assert_statuses(FATHOM_ERR_CANCELLED, FATHOM_OK, FATHOM_ERR_CANCELLED, FATHOM_OK);
    assert_int_equal(values[1], 222);
    assert_int_equal(values[3], 444);
    expect_written(2);
    expect_unit(0, 2);
    expect_unit(1, 4);
}

TEST(one_on_its_way_ends_too_and_its_response_is_late)
{
    static const uint8_t units[4] = {1, 1, 2, 1};
    ask_all(units);
    expect_written_after(REQUEST_US, 1);
    fathom_line_cancel_unit(&bench.line, 1);
    assert_statuses(FATHOM_ERR_CANCELLED, FATHOM_ERR_CANCELLED, FATHOM_PENDING, FATHOM_ERR_CANCELLED);
    receive_all(response_1_754);
    run(REQUEST_US);
    expect_count(FATHOM_LINE_LATE_RESPONSES, 1);
    expect_written(2);
    receive_response(2, 222);
    run(400);
    assert_int_equal(status_of(&requests[2]), FATHOM_OK);
    assert_int_equal(values[0], 0xDEAD);
}

TEST(one_on_its_way_to_another_is_answered)
{
    static const uint8_t units[4] = {1, 2, 2, 2};
    ask_all(units);
    run(REQUEST_US);
    fathom_line_cancel_unit(&bench.line, 2);
    assert_statuses(FATHOM_PENDING, FATHOM_ERR_CANCELLED, FATHOM_ERR_CANCELLED, FATHOM_ERR_CANCELLED);
    receive_all(response_1_754);
    run(400);
    assert_int_equal(status_of(&requests[0]), FATHOM_OK);
    assert_int_equal(values[0], 754);
    expect_due(FATHOM_NO_DEADLINE);
}

TEST(a_request_to_all_or_to_any_is_no_units_own)
{
    static const uint8_t units[4] = {5, 6, 7, 8};
    ask_all(units);
    requests[0].transaction.address = FATHOM_LINE_ANY_UNIT;
    requests[1].transaction.address = FATHOM_LINE_ALL_UNITS;
    fathom_line_cancel_unit(&bench.line, 7);
    assert_statuses(FATHOM_PENDING, FATHOM_PENDING, FATHOM_ERR_CANCELLED, FATHOM_PENDING);
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
