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
