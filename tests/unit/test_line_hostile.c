/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

static const suite_t suite = {.set_up = set_up};

/* ---- what is not the answer ---- */

TEST(noise_before_an_answer_is_dropped_in_the_same_poll)
{
    static const uint8_t noise[] = {0x00, 0xFF, 0x81, 0x00, 0x55};
    uint8_t glued[sizeof noise + sizeof answer_1_754];
    memcpy(glued, noise, sizeof noise);
    memcpy(glued + sizeof noise, answer_1_754, sizeof answer_1_754);
    ask_1_and_send(0);
    receive(glued, sizeof glued);
    run(GAP_US + 200);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_int_equal(bench.value, 754);
    assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), sizeof noise);
}

TEST(noise_that_looks_like_the_start_of_a_long_answer_costs_one_gap_at_most)
{
    static const uint8_t begun[] = {0x01, 0x03, 0x14}; /* 25 bytes are promised */
    ask_1_and_send(0);
    receive(begun, sizeof begun);
    receive(answer_1_754, sizeof answer_1_754);
    run(GAP_US + 200);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_int_equal(bench.value, 754);
}

TEST(another_units_answer_is_a_stray_and_the_wait_goes_on)
{
    ask_1_and_send(0);
    receive_answer(2, 222);
    run(1000);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    assert_int_equal(bench.value, 0xDEAD);
    assert_int_equal(counter(FATHOM_LINE_STRAYS), 1);
    receive_answer(1, 111);
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_int_equal(bench.value, 111);
}

TEST(an_answer_of_the_wrong_shape_is_malformed_unless_the_right_one_follows)
{
    ask_1_and_send(0);
    receive(answer_1_three, sizeof answer_1_three);
    run(1000);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    receive_answer(1, 111);
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);

    set_up(state);
    ask_1_and_send(0);
    receive(answer_1_three, sizeof answer_1_three);
    run(TIMEOUT_US);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_MALFORMED);
    assert_int_equal(bench.value, 0xDEAD);
    assert_int_equal(counter(FATHOM_LINE_MALFORMED), 1);
}

TEST(a_damaged_answer_ends_the_attempt_at_the_first_gap)
{
    uint8_t damaged[sizeof answer_1_754];
    memcpy(damaged, answer_1_754, sizeof damaged);
    damaged[4] ^= 0x10;
    ask_1_and_send(0);
    receive(damaged, sizeof damaged);
    run(GAP_US - 200);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    run(400);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_CHECKSUM);
    assert_int_equal(bench.value, 0xDEAD);
    assert_int_equal(counter(FATHOM_LINE_CHECKSUM_ERRORS), 1);
}

/* USB adapters say up to 16 ms late that a request has left; the answer may be here by then. */
TEST(a_damaged_answer_counts_although_the_port_says_late_that_the_request_has_left)
{
    uint8_t damaged[sizeof answer_1_754];
    memcpy(damaged, answer_1_754, sizeof damaged);
    damaged[4] ^= 0x10;
    bench.fake.never_sent = true;
    ask(&bench.request, 1, &bench.value, 1);
    run(20000);
    receive(damaged, sizeof damaged);
    run(1000);
    bench.fake.never_sent = false;
    run(GAP_US + 400);
    assert_int_equal(counter(FATHOM_LINE_CHECKSUM_ERRORS), 1);
    run(2 * TIMEOUT_US - GAP_US - 1500); /* it might have been noise: owes for twice the time-out */
    assert_int_equal(bench.fake.written, 1);
    run(2000);
    assert_int_equal(bench.fake.written, 2);
}

TEST(an_answer_that_breaks_off_is_a_checksum_error)
{
    for (size_t length = 3; length != sizeof answer_1_754; length++) {
        set_up(state);
        ask_1_and_send(0);
        receive(answer_1_754, length);
        run(GAP_US + 400);
        assert_int_equal(status_of(&bench.request), FATHOM_ERR_CHECKSUM);
        assert_int_equal(bench.value, 0xDEAD);
    }
}

TEST(less_than_three_bytes_are_noise_and_end_nothing)
{
    ask_1_and_send(0);
    receive(answer_1_754, 2);
    run(GAP_US + 400);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    receive(answer_1_754, sizeof answer_1_754);
    run(100);
    assert_int_equal(bench.value, 754);
}

TEST(a_frame_longer_than_the_memory_is_dropped_without_overrun)
{
    uint8_t flood[201];
    memset(flood, 0x01, sizeof flood);
    for (size_t i = 1; i < sizeof flood; i += 3)
        flood[i] = 0x03, flood[i + 1] = 0xF8; /* promises 253 bytes */
    ask_1_and_send(0);
    receive(flood, sizeof flood);
    run(1000);
    receive_answer(1, 111);
    run(GAP_US + 100);
    assert_int_equal(bench.value, 111);
}

/* ---- late answers ---- */

/* The shape of both answers is the same, so only the quarantine can tell them apart. */
TEST(a_late_answer_is_never_the_reading_of_the_next_request)
{
    for (uint32_t late_us = TIMEOUT_US + 300; late_us < 2 * TIMEOUT_US - 1000; late_us += 1000) {
        set_up(state);
        ask_1_and_send(0);
        fake_receive(&bench.fake, late_us, answer_1_754, sizeof answer_1_754);
        run(TIMEOUT_US + 200);
        assert_int_equal(status_of(&bench.request), FATHOM_ERR_NO_ANSWER);
        ask(&bench.other, 1, &bench.other_value, 0);
        run(late_us - TIMEOUT_US);
        assert_int_equal(bench.fake.written, 1); /* it was not even asked */
        assert_int_equal(counter(FATHOM_LINE_LATE_ANSWERS), 1);
        run(T3_5_US + 9 * BYTE_US);
        assert_int_equal(bench.fake.written, 2);
        assert_int_equal(status_of(&bench.other), FATHOM_PENDING);
        assert_int_equal(bench.other_value, 0xDEAD);
        receive(answer_1_751, sizeof answer_1_751);
        run(100);
        assert_int_equal(bench.other_value, 751);
    }
}

TEST(a_unit_that_owes_an_answer_is_asked_again_after_twice_the_time_out)
{
    ask_1_and_send(0);
    run(TIMEOUT_US + 200);
    ask(&bench.other, 1, &bench.other_value, 0);
    run(TIMEOUT_US - 1000);
    assert_int_equal(bench.fake.written, 1);
    run(1500);
    assert_int_equal(bench.fake.written, 2);
}

TEST(other_units_are_asked_while_one_owes)
{
    ask_1_and_send(0);
    run(TIMEOUT_US + 200);
    ask(&bench.request, 1, &bench.value, 0);
    ask(&bench.other, 2, &bench.other_value, 0);
    run(T3_5_US + 9 * BYTE_US);
    assert_int_equal(bench.fake.written, 2);
    assert_int_equal(bench.fake.writes[1].bytes[0], 2);
    receive_answer(2, 222);
    run(100);
    assert_int_equal(bench.other_value, 222);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
}

TEST(a_late_answer_during_another_units_exchange_is_counted_and_harmless)
{
    ask_1_and_send(0);
    run(TIMEOUT_US + 200);
    ask(&bench.other, 2, &bench.other_value, 0);
    run(T3_5_US + 9 * BYTE_US);
    receive_answer(1, 111);
    run(100);
    assert_int_equal(counter(FATHOM_LINE_LATE_ANSWERS), 1);
    assert_int_equal(status_of(&bench.other), FATHOM_PENDING);
    receive_answer(2, 222);
    run(100);
    assert_int_equal(bench.other_value, 222);
}

TEST(a_late_answer_serves_the_retry_that_waits_for_it)
{
    ask_1_and_send(1);
    run(TIMEOUT_US + 200);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    receive_answer(1, 111);
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_int_equal(bench.value, 111);
    assert_int_equal(bench.fake.written, 1);
    assert_int_equal(counter(FATHOM_LINE_LATE_ANSWERS), 1);
    assert_int_equal(counter(FATHOM_LINE_ANSWERS), 1);
}

TEST(a_damaged_answer_owes_for_what_is_left_of_the_time_out)
{
    uint8_t damaged[sizeof answer_1_754];
    memcpy(damaged, answer_1_754, sizeof damaged);
    damaged[5] ^= 1;
    ask_1_and_send(1);
    receive(damaged, sizeof damaged);
    run(GAP_US + 300);
    assert_int_equal(counter(FATHOM_LINE_CHECKSUM_ERRORS), 1);
    run(TIMEOUT_US - GAP_US - 1500);
    assert_int_equal(bench.fake.written, 1);
    run(2000);
    assert_int_equal(bench.fake.written, 2);
}

/* What broke off may have been noise, and the answer come late. */
TEST(an_answer_that_broke_off_owes_for_twice_the_time_out)
{
    ask_1_and_send(1);
    receive(answer_1_754, 5);
    run(GAP_US + 300);
    assert_int_equal(counter(FATHOM_LINE_CHECKSUM_ERRORS), 1);
    run(2 * TIMEOUT_US - GAP_US - 1500);
    assert_int_equal(bench.fake.written, 1);
    run(2000);
    assert_int_equal(bench.fake.written, 2);
}

TEST(retries_are_the_callers_number_and_the_last_error_stays)
{
    ask(&bench.request, 1, &bench.value, 2);
    run(8 * TIMEOUT_US);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(bench.request.exchange.attempts, 3);
    assert_int_equal(bench.fake.written, 3);
    assert_int_equal(counter(FATHOM_LINE_NO_ANSWERS), 3);
}

TEST(a_stray_while_nothing_is_asked_is_dropped)
{
    receive_answer(1, 111);
    run(100);
    assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), 7);
    assert_int_equal(bench.line.have, 0);
}

/* ---- a port that fails ---- */

TEST(a_port_that_cannot_be_read_ends_every_exchange_and_recovers)
{
    ask_1_and_send(0);
    ask(&bench.other, 2, &bench.other_value, 0);
    bench.fake.read_fails = true;
    assert_int_equal(fathom_line_poll(&bench.line), FATHOM_ERR_PORT);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_PORT);
    assert_int_equal(status_of(&bench.other), FATHOM_ERR_PORT);
    assert_int_equal(counter(FATHOM_LINE_PORT_ERRORS), 1);
    bench.fake.read_fails = false;
    ask(&bench.other, 2, &bench.other_value, 0);
    run(20000);
    receive_answer(2, 222);
    run(100);
    assert_int_equal(bench.other_value, 222);
}

TEST(a_unit_that_was_asked_when_the_port_broke_still_owes)
{
    ask_1_and_send(0);
    bench.fake.read_fails = true;
    assert_int_equal(fathom_line_poll(&bench.line), FATHOM_ERR_PORT);
    bench.fake.read_fails = false;
    ask(&bench.request, 1, &bench.value, 0);
    run(20000);
    assert_int_equal(bench.fake.written, 1);
    receive_answer(1, 111); /* to the request of before */
    run(100);
    assert_int_equal(bench.value, 0xDEAD);
    assert_int_equal(counter(FATHOM_LINE_LATE_ANSWERS), 1);
    run(20000);
    assert_int_equal(bench.fake.written, 2);
}

TEST(what_was_received_before_the_port_broke_is_forgotten)
{
    ask_1_and_send(0);
    receive(answer_1_754, 3);
    run(100);
    bench.fake.read_fails = true;
    assert_int_equal(fathom_line_poll(&bench.line), FATHOM_ERR_PORT);
    bench.fake.read_fails = false;
    receive(answer_1_754 + 3, 4); /* no late answer: some of it may have been lost */
    run(2 * GAP_US);
    assert_int_equal(counter(FATHOM_LINE_LATE_ANSWERS), 0);
    assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), 4);
}

TEST(a_port_that_cannot_write_or_tears_a_request_ends_the_exchange)
{
    bench.fake.write_fails = true;
    ask(&bench.request, 1, &bench.value, 0);
    run(5000);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_PORT);

    set_up(state);
    bench.fake.write_torn = true;
    ask(&bench.request, 1, &bench.value, 0);
    run(5000);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_PORT);
}

TEST(a_busy_port_gets_the_request_when_it_is_free)
{
    bench.fake.write_busy = true;
    ask(&bench.request, 1, &bench.value, 0);
    run(50000);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    bench.fake.write_busy = false;
    run(100);
    assert_memory_equal(bench.fake.writes[0].bytes, ask_1_processed, sizeof ask_1_processed);
}

TEST(a_port_that_takes_nothing_or_sends_nothing_for_a_second_is_broken)
{
    bench.fake.write_busy = true;
    ask(&bench.request, 1, &bench.value, 0);
    run(FATHOM_LINE_SEND_US);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    run(T3_5_US + 1000);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_PORT);

    set_up(state);
    bench.fake.never_sent = true;
    ask(&bench.request, 1, &bench.value, 0);
    run(FATHOM_LINE_SEND_US);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    run(T3_5_US + 1000);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_PORT);
}

TEST(an_answer_counts_although_the_port_does_not_say_yet_that_the_request_has_left)
{
    bench.fake.never_sent = true;
    ask(&bench.request, 1, &bench.value, 0);
    run(20000);
    receive(answer_1_754, sizeof answer_1_754);
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
}
