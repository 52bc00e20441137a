/* SPDX-License-Identifier: MIT */
#include "line_conversation.h"

/* A device that sends by itself: requests leave behind its frames, and nowhere else. */

enum { QUIET_US = 65535 };

static const suite_t suite = {.set_up = set_up};

#define UNASKED "01 03 08 08 23 DC B2 07 01 00 00 5B D8" /* the example of HPS-167S #5 */

static const conversation_t conversations[] = {
    ROW("a_request_that_waits_when_a_frame_ends_leaves_behind_it", COUNTS(.dropped = 13), SEND(UNASKED),
        WAIT(T3_5_US / 2), QUEUE(A, 1), SENT(T3_5_US / 2 - 200, 400)),
    ROW("a_request_that_waits_when_a_frame_ends_leaves_behind_it_if_a_listener_gets_the_frame", COUNTS(0),
        LISTEN(500), SEND(UNASKED), WAIT(T3_5_US / 2), QUEUE(A, 1), SENT(T3_5_US / 2 - 200, 400)),
    /* a frame may have waited for the response, and comes as soon as a request might */
    ROW("behind_a_response_no_request_leaves_before_the_next_frame",
        COUNTS(.responses = 1, .dropped = 26, .maybe_unsolicited = 1), SEND(UNASKED), QUEUE(A, 1),
        WAIT(REQUEST_US), WRITTEN(1), RESPONSE(1, 111), READS(A, 111), QUEUE(A, 1), WAIT(20000), WRITTEN(1),
        SEND(UNASKED), WRITTEN(1), SENT(T3_5_US - 200, 400)),
    /* the CRC is F8 68. The unit is not quarantined for what comes later in the silence: the next request leaves as on any
     * line */
    ROW("what_is_left_of_a_damaged_response_is_no_other_sender", COUNTS(.damaged = 1, .dropped = 7),
        QUEUE(A, 1), WAIT(REQUEST_US), RECEIVE("01 03 02 00 6F 00 00"), WAIT(GAP_US + 100),
        FAILS(A, CHECKSUM), QUEUE(B, 2), SENT(0, 200)),
    /* the port marks each of its bytes, and their end is the end of a frame all the same */
    ROW("a_device_that_has_gone_to_another_rate_holds_up_nothing", COUNTS(.dropped = 13, .bad = 13),
        SEND(UNASKED), WAIT(T3_5_US + 200), QUEUE(A, 1), WAIT(20000), WRITTEN(0),
        RECEIVE_WITH(FRAMING, UNASKED), SENT(T3_5_US - 200, 400)),
    ROW("a_glitch_before_the_first_request_delays_nothing", COUNTS(.dropped = 3), RECEIVE("00"),
        RECEIVE("00 00"), WAIT(T3_5_US + 1000), QUEUE(A, 1), SENT(0, 200)),
    /* rule 11: the device that sends by itself may have sent the frame */
    ROW("a_response_on_a_line_with_unsolicited_bytes_counts_once_as_perhaps_unsolicited",
        COUNTS(.responses = 1, .dropped = 4, .maybe_unsolicited = 1), RECEIVE("FF 07 A1 A7"), ASK(A, 1),
        RESPONSE(1, 754), READS(A, 754)),
};
CONVERSATIONS(set_up, conversations)

static void send_unasked(void) { play_send(&(step_t){.hex = UNASKED}); }

/* Nothing but the next frame, or a silence of 65 ms, lets the request leave. */
static void expect_behind_the_next_frame(unsigned before)
{
    expect_written_after(20000, before);
    send_unasked();
    expect_written(before);
    expect_sent(T3_5_US - 200, 400);
}

TEST(a_request_in_the_middle_of_a_silence_waits_for_the_next_frame_of_a_device_that_sends_by_itself)
{
    for (uint32_t in_us = T3_5_US + 200; in_us < 40000; in_us += 5000) {
        set_up(state);
        send_unasked();
        run(in_us);
        ask_1(0);
        expect_behind_the_next_frame(0);
    }
}

TEST(what_is_sent_unasked_is_forgotten_after_65_ms_of_silence)
{
    send_unasked();
    run(T3_5_US + 200);
    ask_1(0);
    const uint32_t left_us = due();
    assert_in_range(left_us, QUIET_US - T3_5_US - 500, QUIET_US - T3_5_US);
    bench.fake.now_us += left_us - 100;
    (void)poll_line();
    expect_written(0);
    run(100);
    expect_written(1);
    run(8 * BYTE_US);
    response_1(111);
    ask_1(0);
    expect_due(T3_5_US); /* as on any line */
    expect_sent(T3_5_US - 200, 400);
}

/* A driver that lets go of an RS-485 pair leaves a byte or two there. Only what is sent between two responses adds
 * up. */
TEST(a_glitch_behind_each_response_delays_nothing)
{
    for (unsigned i = 0; i != 4; i++) {
        ask_1(0);
        run(REQUEST_US);
        expect_written(i + 1);
        response_1(111);
        deliver_hex("00 00 00");
        run(T3_5_US + 1000);
    }
    deliver_hex("00");
    run(T3_5_US + 1000);
    ask_1(0);
    expect_written_after(20000, 4);
}

TEST(bytes_that_belong_to_no_transaction_are_counted_without_coming_round)
{
    for (unsigned i = 0; i != 20; i++) send_unasked(); /* 260 of them */
    run(T3_5_US + 200);
    ask_1(0);
    expect_behind_the_next_frame(0);
}
