/* SPDX-License-Identifier: MIT */
#include "line_conversation.h"

/* line.h, rule 14: after a pause between two polls the line drops bytes that may be too old. */

static const suite_t suite = {.set_up = set_up};

enum { STALE_US = 20000 };

#define FRAME "FF 07 A1 A7" /* of an A16 that sends by itself */

/* POLL_AFTER: the program does not poll for so long, and the bytes arrive meanwhile. */
static const conversation_t conversations[] = {
    ROW("bytes_are_not_too_old_if_the_pause_exceeds_the_time_out_by_half_a_second",
        COUNTS(.no_responses = 1, .strays = 1, .dropped = 7), ASK_TWICE(A, 1), WAIT(TIMEOUT_US), PENDS(A),
        ARRIVE("01 03 02 02 F2 38 A1"), POLL_AFTER(TIMEOUT_US + FATHOM_LINE_LATE_US), PENDS(A)),
    ROW("a_late_response_is_dropped_if_the_pause_exceeds_the_time_out_by_more_than_half_a_second",
        COUNTS(.no_responses = 1, .old = 7), ASK_TWICE(A, 1), WAIT(TIMEOUT_US), PENDS(A),
        ARRIVE("01 03 02 02 F2 38 A1"), POLL_AFTER(TIMEOUT_US + FATHOM_LINE_LATE_US + 1), PENDS(A)),
    ROW("a_listener_gets_bytes_that_are_as_old_as_its_limit", COUNTS(0), LISTEN_FOR_NEW(GAP_US, STALE_US),
        ARRIVE(FRAME), POLL_AFTER(STALE_US + FATHOM_LINE_LATE_US), HEARD(FRAME, 0)),
    ROW("a_listener_gets_no_bytes_that_may_be_older_than_its_limit", COUNTS(.old = 4),
        LISTEN_FOR_NEW(GAP_US, STALE_US), ARRIVE(FRAME), POLL_AFTER(STALE_US + FATHOM_LINE_LATE_US + 1),
        HEARD("", 0)),
    ROW("a_pause_without_bytes_is_no_loss_for_the_listener", COUNTS(0), LISTEN_FOR_NEW(GAP_US, STALE_US),
        POLL_AFTER(1000000), RECEIVE(FRAME), HEARD(FRAME, 1), LOST_AT(0, 0)),
    ROW("dropped_bytes_are_a_loss_that_the_listener_receives_once_with_the_next_bytes", COUNTS(.old = 4),
        LISTEN_FOR_NEW(GAP_US, STALE_US), RECEIVE("FF 07"), ARRIVE(FRAME), POLL_AFTER(1000000), WAIT(100),
        LOST_AT(0, 0), RECEIVE(FRAME), RECEIVE(FRAME), HEARD("FF 07 " FRAME " " FRAME, 0), LOST_AT(2, 1)),
    /* rule 11: four bytes show that a device sends by itself. Then a request leaves behind its next frame, or after 65 ms.
     * It could leave in the silence before */
    ROW("dropped_bytes_still_show_that_a_device_sends_by_itself", COUNTS(.old = 4),
        LISTEN_FOR_NEW(GAP_US, STALE_US), ARRIVE(FRAME), POLL_AFTER(1000000), WAIT(10000), QUEUE(A, 1),
        SENT(20000, 40000)),
    ROW("three_dropped_bytes_show_no_device_that_sends_by_itself", COUNTS(.old = 3),
        LISTEN_FOR_NEW(GAP_US, STALE_US), ARRIVE("FF 07 A1"), POLL_AFTER(1000000), WAIT(10000), QUEUE(A, 1),
        SENT(0, 20000)),
    /* a line without a listener counts the bytes as old, not as dropped */
    ROW("a_flush_drops_what_the_port_holds", COUNTS(.old = 4), ARRIVE(FRAME), FLUSH, WAIT(100),
        COUNT(OLD_BYTES, 4), LISTEN(GAP_US), RECEIVE(FRAME), HEARD(FRAME, 0)),
    ROW("a_flush_is_a_loss_for_the_listener_at_once", COUNTS(0), LISTEN(GAP_US), RECEIVE("FF 07"), FLUSH,
        LOST_AT(2, 1)),
    /* rule 15: nothing that was learnt before the error remains valid */
    ROW("bytes_before_and_after_an_error_of_the_port_do_not_add_up_to_a_device_that_sends_by_itself",
        COUNTS(.port_errors = 1, .dropped = 4), RECEIVE("00 00 00"), BREAK_PORT, WAIT(100), RECEIVE("00"),
        WAIT(T3_5_US + 1000), QUEUE(A, 1), SENT(0, 1000)),
    /* the silence before the next request begins with the error */
    ROW("after_an_error_of_the_port_during_a_request_the_whole_silence_is_kept", COUNTS(.port_errors = 1),
        ASK(A, 1), WAIT(T3_5_US), BREAK_PORT, QUEUE(B, 2), DUE(T3_5_US)),
};
CONVERSATIONS(set_up, conversations)

TEST(bytes_that_the_port_dates_are_as_old_as_their_time_stamp)
{
    for (unsigned is_older = 0; is_older != 2; is_older++) {
        set_up(state);
        listen_for(GAP_US);
        bench_listener.base.stale_us = STALE_US;
        bench.fake.now_us += 1000000;
        const uint32_t age_us = STALE_US + FATHOM_LINE_LATE_US + is_older;
        fake_receive_rx(&bench.fake, 0, auto_frame, 4,
                        (fathom_rx_t){bench.fake.now_us - age_us, FATHOM_RX_TIMED});
        (void)poll_line();
        expect_count(FATHOM_LINE_OLD_BYTES, is_older != 0 ? 4 : 0);
        assert_int_equal(bench_listener.length, is_older != 0 ? 0 : 4);
    }
}

TEST(a_flush_before_the_port_was_seen_empty_drops_its_bytes_too)
{
    assert_int_equal(fathom_line_init(&bench.line, &bench.config), FATHOM_OK);
    fathom_line_flush(&bench.line);
    deliver(auto_frame, 4);
    expect_count(FATHOM_LINE_OLD_BYTES, 4);
}
