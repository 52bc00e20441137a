/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line_turns.h"
#include "line_bench.h"

/* line.h: whose response is late, whose is a stray, and until when a unit is asked nothing. */

static const suite_t suite = {.set_up = set_up};

static void start_write(void)
{
    fathom_modbus_write_single_register(&bench.request.message, 1, 0x0200, 5);
    bench.request.transaction.timeout_us = TIMEOUT_US;
    assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_PENDING);
}

/* Submits a read and runs until it has left. */
static void ask_and_send(fathom_modbus_request_t *request, uint8_t unit, uint16_t *value, uint32_t timeout_us)
{
    const size_t before = bench.fake.written;
    ask(request, unit, value, 0);
    request->transaction.timeout_us = timeout_us;
    run(T3_5_US + 200);
    assert_int_equal(bench.fake.written, before + 1);
    run(8 * BYTE_US + 100);
}

/* Is what has been submitted sent after one silence? */
static bool goes_out(void)
{
    const size_t before = bench.fake.written;
    run(T3_5_US + 200);
    return bench.fake.written != before;
}

/* One deadline, the latest, serves all units in quarantine: 2 for 300 ms after its time-out, 3 for 10 ms. */
TEST(a_short_quarantine_of_another_unit_does_not_end_a_long_one)
{
    ask_and_send(&bench.request, 2, &bench.value, 300000);
    run(300000);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_NO_RESPONSE);
    ask_and_send(&bench.other, 3, &bench.other_value, 10000);
    run(10000);
    assert_int_equal(status_of(&bench.other), FATHOM_ERR_NO_RESPONSE);
    ask(&bench.request, 2, &bench.value, 0);
    run(200000);
    assert_int_equal(bench.fake.written, 2);
    run(100000);
    assert_int_equal(bench.fake.written, 3);
}

/* 2 is quarantined for 80 ms, and when 3 has been silent for 60 ms it is so for as long again. */
TEST(a_long_quarantine_outlasts_a_short_one_that_was_there_before)
{
    ask_and_send(&bench.request, 2, &bench.value, 80000);
    run(80000);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_NO_RESPONSE);
    ask_and_send(&bench.other, 3, &bench.other_value, 60000);
    run(60000);
    assert_int_equal(status_of(&bench.other), FATHOM_ERR_NO_RESPONSE);
    ask(&bench.other, 3, &bench.other_value, 0);
    run(50000); /* by then the quarantine of 2 is over */
    assert_int_equal(bench.fake.written, 2);
    run(20000);
    assert_int_equal(bench.fake.written, 3);
}

/* LATE_RESPONSES: from a quarantined unit; STRAYS: whole frames that were not asked for. Unit 9 has its bit in the
 * upper byte. */
TEST(a_frame_of_a_unit_not_quarantined_is_a_stray_and_leaves_the_quarantine_of_another)
{
    ask_and_send(&bench.request, 9, &bench.value, TIMEOUT_US);
    run(TIMEOUT_US);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_NO_RESPONSE);
    receive_response(1, 111);
    run(100);
    assert_int_equal(counter(FATHOM_LINE_STRAYS), 1);
    assert_int_equal(counter(FATHOM_LINE_LATE_RESPONSES), 0);
    ask(&bench.request, 9, &bench.value, 0);
    assert_false(goes_out());
}

/* cancel: the unit is then quarantined. The first copy of the request is its echo, the second the response. */
TEST(after_the_echo_of_a_cancelled_write_its_response_is_late_and_ends_the_quarantine)
{
    set_up_echo(FATHOM_LINE_ECHO_AUTO);
    start_write();
    run(T3_5_US + 200);
    fathom_line_cancel(&bench.line, &bench.request.transaction);
    run(8 * BYTE_US);
    receive(set_address_5, sizeof set_address_5);
    run(100);
    assert_int_equal(counter(FATHOM_LINE_STRAYS), 1);
    assert_int_equal(counter(FATHOM_LINE_LATE_RESPONSES), 0);
    receive(set_address_5, sizeof set_address_5);
    run(100);
    assert_int_equal(counter(FATHOM_LINE_STRAYS), 1);
    assert_int_equal(counter(FATHOM_LINE_LATE_RESPONSES), 1);
    ask(&bench.other, 1, &bench.other_value, 0);
    assert_true(goes_out());
}

/* The echo of a request can only come before the next one has left. */
TEST(after_the_next_request_no_echo_of_a_cancelled_one_is_expected)
{
    set_up_echo(FATHOM_LINE_ECHO_AUTO);
    start_write();
    run(T3_5_US + 200);
    fathom_line_cancel(&bench.line, &bench.request.transaction);
    ask(&bench.other, 2, &bench.other_value, 0);
    run(8 * BYTE_US + T3_5_US + 200);
    assert_int_equal(bench.fake.written, 2);
    run(8 * BYTE_US);
    receive(set_address_5, sizeof set_address_5);
    run(100);
    assert_int_equal(counter(FATHOM_LINE_LATE_RESPONSES), 1);
    receive_response(2, 222);
    run(100);
    assert_int_equal(status_of(&bench.other), FATHOM_OK);
    run(66000); /* the late one might have been what a device sends by itself */
    ask(&bench.request, 1, &bench.value, 0);
    assert_true(goes_out());
}

/* "A late response does serve a retry of the same transaction": then it is a response, and none of its bytes is left
 * over. */
static unsigned heard;

static void hear(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                 uint32_t time_us)
{
    (void)listener, (void)bytes, (void)after_gap, (void)time_us;
    heard += count;
}

static void serve_a_retry(fathom_listener_t *listener)
{
    heard = 0;
    ask_1_and_send(1);
    run(TIMEOUT_US);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING); /* the retry waits for the quarantine */
    assert_int_equal(bench.fake.written, 1);
    (void)fathom_line_replace_listener(&bench.line, listener);
    receive(response_1_754, sizeof response_1_754);
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_OK);
    assert_int_equal(bench.value, 754);
    assert_int_equal(counter(FATHOM_LINE_RESPONSES), 1);
    run(2 * GAP_US);
}

TEST(no_byte_of_a_late_response_that_is_taken_is_dropped)
{
    serve_a_retry(NULL);
    assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), 0);
}

TEST(no_byte_of_a_late_response_that_is_taken_goes_to_the_listener)
{
    fathom_listener_t listener = {.receive = hear, .gap_us = 2000};
    serve_a_retry(&listener);
    assert_int_equal(heard, 0);
}

/* A unit that has not been asked cannot answer. */
TEST(what_comes_while_the_port_refuses_the_request_is_no_response_to_it)
{
    bench.fake.write_busy = true;
    ask(&bench.request, 1, &bench.value, 0);
    run(T3_5_US + 200);
    receive(response_1_754, sizeof response_1_754);
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    assert_int_equal(bench.value, 0xDEAD);
    assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), 7);
    bench.fake.write_busy = false;
    assert_true(goes_out());
}

/* cancel: the wire is free for the others, whether the line echoes or not. */
TEST(the_next_request_goes_out_after_one_was_cancelled_on_a_line_of_unknown_echo)
{
    set_up_echo(FATHOM_LINE_ECHO_AUTO);
    ask_1_and_send(0);
    fathom_line_cancel(&bench.line, &bench.request.transaction);
    ask(&bench.other, 2, &bench.other_value, 0);
    assert_true(goes_out());
}

/* after_gap: "before the first of them". The listener's gap is shorter than the one that ends a frame. */
static unsigned gaps;

static void hear_gaps(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                      uint32_t time_us)
{
    (void)listener, (void)bytes, (void)time_us;
    heard += count;
    gaps += after_gap;
}

TEST(a_pause_within_bytes_that_were_held_back_is_no_gap_before_them)
{
    static const uint8_t wrong[] = {0, 0, 0};
    fathom_listener_t listener = {.receive = hear_gaps, .gap_us = 2000};
    heard = gaps = 0;
    (void)fathom_line_replace_listener(&bench.line, &listener);
    ask_1_and_send(0);
    receive(response_1_754, 4);
    run(3000);
    receive(wrong, sizeof wrong);
    run(2 * GAP_US);
    assert_int_equal(heard, 7);
    assert_int_equal(gaps, 0);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_CHECKSUM);
}

/* line_attempt.c: units with equal addresses modulo 16 share a bit. Unit 255 stands for all. */
TEST(a_quarantine_of_unit_1_concerns_the_units_with_the_same_address_modulo_16_and_no_others)
{
    (void)set_up_quarantined(state);
    for (unsigned unit = 0; unit != 255; unit++)
        assert_int_equal(fathom_line_is_quarantined(&bench.line, (uint8_t)unit), unit % 16 == 1);
    assert_true(fathom_line_is_quarantined(&bench.line, 255));
}
