/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

static const suite_t suite = {.set_up = set_up};
static const suite_t asked = {.set_up = set_up_asked};
static const suite_t quarantined = {.set_up = set_up_quarantined};

/* ---- what is not the response ---- */

TEST_IN(asked, noise_before_a_response_is_dropped_in_the_same_poll)
{
    receive_hex("00 FF 81 00 55 01 03 02 02 F2 38 A1");
    run(GAP_US + 200);
    expect_mm(754);
    expect_count(FATHOM_LINE_DROPPED_BYTES, 5);
}

TEST_IN(asked, noise_that_looks_like_the_start_of_a_long_response_costs_one_gap_at_most)
{
    receive_hex("01 03 14"); /* 25 bytes are promised */
    receive_all(response_1_754);
    run(GAP_US + 200);
    expect_mm(754);
}

TEST_IN(asked, another_units_response_is_a_stray_and_the_wait_goes_on)
{
    receive_response(2, 222);
    run(1000);
    expect_failed(FATHOM_PENDING);
    expect_count(FATHOM_LINE_STRAYS, 1);
    response_1(111);
}

TEST_IN(asked, a_response_of_the_wrong_shape_is_malformed_unless_the_right_one_follows)
{
    receive_all(response_1_three);
    expect_after(1000, FATHOM_PENDING);
    response_1(111);

    set_up_asked(state);
    receive_all(response_1_three);
    run(TIMEOUT_US);
    expect_failed(FATHOM_ERR_MALFORMED);
    expect_count(FATHOM_LINE_MALFORMED, 1);
}

TEST_IN(asked, a_damaged_response_ends_the_attempt_at_the_first_gap)
{
    receive_damaged();
    expect_after(GAP_US - 200, FATHOM_PENDING);
    run(400);
    expect_failed(FATHOM_ERR_CHECKSUM);
    expect_count(FATHOM_LINE_CHECKSUM_ERRORS, 1);
}

/* USB adapters say up to 16 ms late that a request has left; the response may be here by then. */
TEST(a_damaged_response_counts_although_the_port_says_late_that_the_request_has_left)
{
    bench.fake.never_sent = true;
    ask_1(1);
    run(20000);
    receive_damaged();
    run(1000);
    bench.fake.never_sent = false;
    run(GAP_US + 400);
    expect_count(FATHOM_LINE_CHECKSUM_ERRORS, 1);
    expect_sent(2 * TIMEOUT_US - GAP_US - 1500,
                2000); /* it might have been noise: quarantined for twice the time-out */
}

TEST(a_response_that_breaks_off_is_a_checksum_error)
{
    for (size_t length = 3; length != sizeof response_1_754; length++) {
        set_up_asked(state);
        receive(response_1_754, length);
        run(GAP_US + 400);
        expect_failed(FATHOM_ERR_CHECKSUM);
    }
}

TEST_IN(asked, less_than_three_bytes_are_noise_and_end_nothing)
{
    receive(response_1_754, 2);
    expect_after(GAP_US + 400, FATHOM_PENDING);
    response_1(754);
}

TEST(a_frame_longer_than_the_memory_is_dropped_without_overrun)
{
    uint8_t flood[201];
    memset(flood, 0x01, sizeof flood);
    for (size_t i = 1; i < sizeof flood; i += 3)
        flood[i] = 0x03, flood[i + 1] = 0xF8; /* promises 253 bytes */
    ask_1_and_send(0);
    receive_all(flood);
    run(1000);
    receive_response(1, 111);
    run(GAP_US + 100);
    expect_mm(111);
}

/* ---- late responses ---- */

/* The shape of both responses is the same, so only the quarantine can tell them apart. */
TEST(a_late_response_is_never_the_reading_of_the_next_request)
{
    for (uint32_t late_us = TIMEOUT_US + 300; late_us < 2 * TIMEOUT_US - 1000; late_us += 1000) {
        set_up_asked(state);
        fake_receive(&bench.fake, late_us, response_1_754, sizeof response_1_754);
        expect_after(TIMEOUT_US + 200, FATHOM_ERR_NO_RESPONSE);
        ask_other(1);
        expect_written_after(late_us - TIMEOUT_US, 1); /* it was not even asked */
        expect_count(FATHOM_LINE_LATE_RESPONSES, 1);
        expect_written_after(T3_5_US + 9 * BYTE_US, 2);
        expect_other(FATHOM_PENDING);
        assert_int_equal(bench.other_value, 0xDEAD);
        response_other(1, 751);
    }
}

TEST_IN(quarantined, a_quarantined_unit_is_asked_again_after_twice_the_time_out)
{
    ask_other(1);
    expect_sent(TIMEOUT_US - 1000, 1500);
}

TEST_IN(quarantined, other_units_are_asked_while_one_is_quarantined)
{
    ask_1(0);
    ask_other(2);
    expect_written_after(T3_5_US + 9 * BYTE_US, 2);
    expect_unit(1, 2);
    response_other(2, 222);
    expect(FATHOM_PENDING);
}

TEST_IN(quarantined, a_late_response_during_another_units_transaction_is_counted_and_harmless)
{
    ask_other(2);
    run(T3_5_US + 9 * BYTE_US);
    deliver_response(1, 111);
    expect_count(FATHOM_LINE_LATE_RESPONSES, 1);
    expect_other(FATHOM_PENDING);
    response_other(2, 222);
}

TEST(a_late_response_serves_the_retry_that_waits_for_it)
{
    ask_1_and_send(1);
    expect_after(TIMEOUT_US + 200, FATHOM_PENDING);
    response_1(111);
    expect_written(1);
    expect_count(FATHOM_LINE_LATE_RESPONSES, 1);
    expect_count(FATHOM_LINE_RESPONSES, 1);
}

TEST(a_damaged_response_quarantines_for_what_is_left_of_the_time_out)
{
    ask_1_and_send(1);
    receive_damaged();
    run(GAP_US + 300);
    expect_count(FATHOM_LINE_CHECKSUM_ERRORS, 1);
    expect_sent(TIMEOUT_US - GAP_US - 1500, 2000);
}

/* What broke off may have been noise, and the response come late. */
TEST(a_response_that_broke_off_quarantines_for_twice_the_time_out)
{
    ask_1_and_send(1);
    receive(response_1_754, 5);
    run(GAP_US + 300);
    expect_count(FATHOM_LINE_CHECKSUM_ERRORS, 1);
    expect_sent(2 * TIMEOUT_US - GAP_US - 1500, 2000);
}

TEST(retries_are_the_callers_number_and_the_last_error_stays)
{
    ask_1(2);
    expect_after(8 * TIMEOUT_US, FATHOM_ERR_NO_RESPONSE);
    assert_int_equal(bench.request.transaction.attempts, 3);
    expect_written(3);
    expect_count(FATHOM_LINE_NO_RESPONSES, 3);
}

TEST(a_stray_while_nothing_is_asked_is_dropped)
{
    deliver_response(1, 111);
    expect_count(FATHOM_LINE_DROPPED_BYTES, 7);
    assert_int_equal(bench.line.received_count, 0);
}

/* ---- a port that fails ---- */

TEST_IN(asked, a_port_that_cannot_be_read_ends_every_transaction_and_recovers)
{
    ask_other(2);
    break_port();
    expect(FATHOM_ERR_PORT);
    expect_other(FATHOM_ERR_PORT);
    expect_count(FATHOM_LINE_PORT_ERRORS, 1);
    ask_other(2);
    run(20000);
    response_other(2, 222);
}

TEST_IN(asked, a_unit_that_was_asked_when_the_port_broke_is_still_quarantined)
{
    break_port();
    ask_1(0);
    expect_written_after(20000, 1);
    deliver_response(1, 111); /* to the request of before */
    assert_int_equal(bench.value, 0xDEAD);
    expect_count(FATHOM_LINE_LATE_RESPONSES, 1);
    expect_written_after(20000, 2);
}

TEST_IN(asked, what_was_received_before_the_port_broke_is_forgotten)
{
    deliver(response_1_754, 3);
    break_port();
    receive(response_1_754 + 3, 4); /* no late response: some of it may have been lost */
    run(2 * GAP_US);
    expect_count(FATHOM_LINE_LATE_RESPONSES, 0);
    expect_count(FATHOM_LINE_DROPPED_BYTES, 4);
}

/* Asks unit 1, of a line that is new but for what `fails`, and runs for so long. */
static void ask_while(void **state, bool *fails, uint32_t for_us)
{
    set_up(state);
    *fails = true;
    ask_1(0);
    run(for_us);
}

TEST(a_port_that_cannot_write_or_tears_a_request_ends_the_transaction)
{
    ask_while(state, &bench.fake.write_fails, 5000);
    expect(FATHOM_ERR_PORT);
    ask_while(state, &bench.fake.write_too_short, 5000);
    expect(FATHOM_ERR_PORT);
}

TEST(a_busy_port_gets_the_request_when_it_is_free)
{
    ask_while(state, &bench.fake.write_busy, 50000);
    expect(FATHOM_PENDING);
    bench.fake.write_busy = false;
    run(100);
    expect_bytes(0, ask_1_processed, sizeof ask_1_processed);
}

TEST(a_port_that_takes_nothing_or_sends_nothing_for_a_second_is_broken)
{
    bool *const failures[] = {&bench.fake.write_busy, &bench.fake.never_sent};
    for (size_t i = 0; i != COUNT_OF(failures); i++) {
        ask_while(state, failures[i], FATHOM_LINE_SEND_US);
        expect(FATHOM_PENDING);
        expect_after(T3_5_US + 1000, FATHOM_ERR_PORT);
    }
}

TEST(what_comes_while_the_port_refuses_the_request_is_no_response)
{
    ask_while(state, &bench.fake.write_busy, 50000);
    deliver_all(response_1_754);
    expect_failed(FATHOM_PENDING);
}

TEST(a_request_that_the_port_never_took_quarantines_none_when_it_breaks)
{
    ask_while(state, &bench.fake.write_busy, 50000);
    break_port();
    expect(FATHOM_ERR_PORT);
    bench.fake.write_busy = false;
    ask_1(0);
    expect_written_after(T3_5_US + 200, 1);
}

TEST(a_response_counts_although_the_port_does_not_say_yet_that_the_request_has_left)
{
    ask_while(state, &bench.fake.never_sent, 20000);
    response_1(754);
}
