/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line_turns.h"
#include "line_conversation.h"

/* line.h: which response is late, which frame is a stray, and until when a unit receives no request. */

static const suite_t suite = {.set_up = set_up};

#define NO_RESPONSE_FROM_1 ASK(A, 1), WAIT(TIMEOUT_US + 200), FAILS(A, NO_RESPONSE)
#define COPY               "01 06 02 00 00 05 48 71" /* set_address_5: its echo and its response are equal */

static const conversation_t late[] = {
    ROW("a_unit_is_asked_again_after_twice_its_time_out", COUNTS(.no_responses = 1), NO_RESPONSE_FROM_1,
        QUEUE(B, 1), SENT(TIMEOUT_US - 1000, 1500)),
    ROW("other_units_are_asked_while_one_is_quarantined", COUNTS(.no_responses = 1, .responses = 1),
        NO_RESPONSE_FROM_1, QUEUE(A, 1), ASK(B, 2), REQUEST_TO(1, 2), RESPONSE(2, 222), READS(B, 222),
        PENDS(A)),
    ROW("a_late_response_during_the_transaction_of_another_unit_is_counted_and_harmless",
        COUNTS(.no_responses = 1, .late = 1, .responses = 1, .dropped = 7), NO_RESPONSE_FROM_1, ASK(B, 2),
        RESPONSE(1, 111), COUNT(LATE_RESPONSES, 1), PENDS(B), RESPONSE(2, 222), READS(B, 222)),
    ROW("a_late_response_serves_the_retry_that_waits_for_it",
        COUNTS(.no_responses = 1, .late = 1, .responses = 1), ASK_TWICE(A, 1), WAIT(TIMEOUT_US + 200),
        PENDS(A), RESPONSE(1, 111), READS(A, 111), WRITTEN(1)),
    ROW("a_late_exception_ends_the_retry", COUNTS(.no_responses = 1, .late = 1, .exceptions = 1),
        ASK_TWICE(A, 1), WAIT(TIMEOUT_US + 200), RECEIVE("01 83 02 C0 F1"), FAILS(A, EXCEPTION)),
    /* from the quarantined unit, but three registers instead of one */
    ROW("a_late_frame_that_does_not_answer_the_retry_ends_the_quarantine_and_no_more",
        COUNTS(.no_responses = 1, .late = 1, .dropped = 11, .responses = 1, .maybe_unsolicited = 1),
        ASK_TWICE(A, 1), WAIT(TIMEOUT_US + 200), RECEIVE("01 03 06 00 FA 02 93 09 7A 8F 47"), PENDS(A),
        WAIT(REQUEST_US), WRITTEN(2), RESPONSE(1, 111), READS(A, 111)),
    ROW("a_damaged_response_quarantines_for_the_rest_of_the_time_out", COUNTS(.damaged = 1, .dropped = 7),
        ASK_TWICE(A, 1), RECEIVE("01 03 02 02 E2 38 A1"), WAIT(GAP_US + 200), COUNT(CHECKSUM_ERRORS, 1),
        SENT(TIMEOUT_US - GAP_US - 1500, 2000)),
    /* it may be noise, and the response late */
    ROW("a_response_that_broke_off_quarantines_for_twice_the_time_out", COUNTS(.damaged = 1, .dropped = 5),
        ASK_TWICE(A, 1), RECEIVE("01 03 02 02 F2"), WAIT(GAP_US + 200), COUNT(CHECKSUM_ERRORS, 1),
        SENT(2 * TIMEOUT_US - GAP_US - 1500, 2000)),
    /* one deadline, the latest, serves all units in quarantine */
    ROW("a_short_quarantine_of_another_unit_does_not_end_a_long_one", COUNTS(.no_responses = 2),
        ASK_FOR(A, 2, 300000), WAIT(300000), FAILS(A, NO_RESPONSE), ASK_FOR(B, 3, 10000), WAIT(10000),
        FAILS(B, NO_RESPONSE), QUEUE(A, 2), SENT(200000, 100000)),
    ROW("a_late_response_ends_the_quarantine_of_its_unit_alone",
        COUNTS(.no_responses = 2, .late = 2, .dropped = 14), ASK(A, 9), WAIT(TIMEOUT_US + 200),
        FAILS(A, NO_RESPONSE), ASK_FOR(B, 1, 20000), WAIT(20200), FAILS(B, NO_RESPONSE), RESPONSE(1, 754),
        RESPONSE(9, 754)),
    ROW("a_quarantine_lasts_no_longer_because_of_one_that_has_ended",
        COUNTS(.late = 1, .dropped = 7, .no_responses = 1), ASK_FOR(B, 2, 10 * TIMEOUT_US), CANCEL(B),
        RESPONSE(2, 222), COUNT(LATE_RESPONSES, 1), ASK_TWICE(A, 1), WAIT(TIMEOUT_US - 400),
        SENT(TIMEOUT_US, 800)),
    /* the first copy of the request is its echo, and the second one the response */
    ROW("after_the_echo_of_a_cancelled_write_its_response_is_late_and_ends_the_quarantine",
        COUNTS(.strays = 1, .late = 1, .dropped = 16), ECHO(AUTO), WRITE(A, 1), WAIT(T3_5_US + 200),
        CANCEL(A), WAIT(8 * BYTE_US), RECEIVE(COPY), COUNT(STRAYS, 1), COUNT(LATE_RESPONSES, 0),
        RECEIVE(COPY), COUNT(LATE_RESPONSES, 1), QUEUE(B, 1), SENT(0, T3_5_US + 200)),
    ROW("the_echo_of_a_cancelled_write_does_not_end_the_quarantine", COUNTS(.strays = 1, .dropped = 8),
        ECHO(ON), WRITE(A, 1), WAIT(T3_5_US + 200), CANCEL(A), WAIT(8 * BYTE_US), RECEIVE(COPY), WRITE(B, 1),
        WAIT(20000), WRITTEN(1)),
    ROW("the_response_after_the_echo_of_a_cancelled_write_ends_the_quarantine",
        COUNTS(.late = 1, .dropped = 8), ECHO(ON), WRITE(A, 1), WAIT(T3_5_US + 200), WAIT(8 * BYTE_US),
        RECEIVE(COPY), CANCEL(A), RECEIVE(COPY), COUNT(LATE_RESPONSES, 1), QUEUE(B, 1),
        SENT(0, T3_5_US + 200)),
    /* the late response might have been what a device sends by itself */
    ROW("after_the_next_request_no_echo_of_a_cancelled_one_is_expected",
        COUNTS(.late = 1, .dropped = 8, .responses = 1), ECHO(AUTO), WRITE(A, 1), WAIT(T3_5_US + 200),
        CANCEL(A), QUEUE(B, 2), WAIT(8 * BYTE_US + T3_5_US + 200), WRITTEN(2), WAIT(8 * BYTE_US),
        RECEIVE(COPY), COUNT(LATE_RESPONSES, 1), RESPONSE(2, 222), READS(B, 222), WAIT(66000), QUEUE(A, 1),
        SENT(0, T3_5_US + 200)),
    ROW("noise_behind_the_echo_of_a_write_makes_its_response_no_echo", COUNTS(.responses = 1, .dropped = 1),
        ECHO(ON), WRITE(A, 1), WAIT(REQUEST_US), RECEIVE(COPY), RECEIVE("00"), RECEIVE(COPY),
        ENDS(A, FATHOM_OK)),
    ROW("an_echo_that_ends_after_the_time_out_is_an_echo", COUNTS(.echoes = 1), ECHO(AUTO), WRITE(A, 1),
        WAIT(REQUEST_US + TIMEOUT_US - 4 * BYTE_US), SEND(COPY), WAIT(2 * TIMEOUT_US),
        ENDS(A, FATHOM_ERR_ECHO)),
    ROW("a_pause_within_bytes_that_the_line_held_back_is_no_gap_before_them", COUNTS(.damaged = 1),
        LISTEN(2000), ASK(A, 1), RECEIVE("01 03 02 02"), WAIT(3000), RECEIVE("00 00 00"), WAIT(2 * GAP_US),
        HEARD("01 03 02 02 00 00 00", 0), FAILS(A, CHECKSUM)),
};
CONVERSATIONS(set_up, late)

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

/* line_attempt.c: units with equal addresses modulo 16 share a bit. Unit 255 stands for all. */
TEST(a_quarantine_of_unit_1_concerns_the_units_with_the_same_address_modulo_16_and_no_others)
{
    (void)set_up_quarantined(state);
    for (unsigned unit = 0; unit != 255; unit++)
        assert_int_equal(fathom_line_is_quarantined(&bench.line, (uint8_t)unit), unit % 16 == 1);
    assert_true(fathom_line_is_quarantined(&bench.line, 255));
}
