/* SPDX-License-Identifier: MIT */
#include "line_conversation.h"

/* A device that sends by itself: requests leave behind its frames, and nowhere else. */

enum { QUIET_US = 65535 };

static const suite_t suite = {.set_up = set_up};

#define UNASKED "01 03 08 08 23 DC B2 07 01 00 00 5B D8" /* the example of HPS-167S #5 */

#define OF_9  "09 03 08 08 23 DC B2 07 01 00 00 D7 21" /* the same from unit 9 */
#define BEGIN ASK(A, 1), RESPONSE(1, 754)              /* from now on the line recognises frames */

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
    /* A program is slow if it polls at 2 * 3646 us or later behind a frame while a request waits. Then the request leaves
     * with the poll that reads the next frame. */
    ROW("a_program_that_polls_at_twice_the_silence_sends_behind_the_next_frame",
        COUNTS(.responses = 1, .strays = 2, .dropped = 26), BEGIN, QUEUE(A, 1), ARRIVE(OF_9), POLL,
        ARRIVE(OF_9), POLL_AFTER(2 * T3_5_US), WRITTEN(2)),
    ROW("a_program_that_polls_a_little_sooner_waits_for_the_silence",
        COUNTS(.responses = 1, .strays = 2, .dropped = 26), BEGIN, QUEUE(A, 1), ARRIVE(OF_9), POLL,
        ARRIVE(OF_9), POLL_AFTER(2 * T3_5_US - 1), WRITTEN(1), SENT(T3_5_US - 200, 400)),
    ROW("a_long_pause_without_a_request_that_waits_shows_no_slow_program",
        COUNTS(.responses = 1, .strays = 2, .dropped = 26), BEGIN, ARRIVE(OF_9), POLL, QUEUE(A, 1),
        ARRIVE(OF_9), POLL_AFTER(10000), WRITTEN(1), SENT(T3_5_US - 200, 400)),
    /* the frame arrives with the time-out of A, so its bytes show no sender, and the response to B is no unsolicited frame */
    ROW("a_frame_that_ends_an_attempt_shows_no_device_that_sends_by_itself",
        COUNTS(.responses = 1, .no_responses = 1, .strays = 1, .dropped = 13), ASK(A, 1), QUEUE(B, 2),
        PASS(2 * TIMEOUT_US), ARRIVE(OF_9), POLL, FAILS(A, NO_RESPONSE), WAIT(REQUEST_US), RESPONSE(2, 222),
        READS(B, 222)),
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

/* The next frame of unit 9, which a poll reads 10 ms after the previous poll. */
static void poll_slowly(void)
{
    play_arrive(&(step_t){.hex = OF_9});
    run_in_steps(10000, 10000);
}

/* Requests something of unit 1. Returns how many frames pass until the request leaves, at most 100. */
static unsigned frames_before_a_request(void)
{
    const size_t before = bench.fake.written;
    unsigned count = 0;
    ask_1(0);
    while (bench.fake.written == before && count != 100) poll_slowly(), count++;
    return count;
}

static void lose_a_request(void)
{
    for (unsigned i = 0; i != 24; i++)
        poll_slowly();                   /* its time-out is 100 ms, and as long is the quarantine */
    expect_failed(FATHOM_ERR_LINE_BUSY); /* it left without its silence */
}

/* The comment of line_senders.c: from the second loss in a row on, one slot in eight is drawn. */
TEST(a_slow_program_that_lost_two_requests_in_a_row_draws_its_slots)
{
    unsigned sum = 0;
    ask_1(0);
    run(REQUEST_US);
    response_1(111);
    poll_slowly();
    assert_int_equal(frames_before_a_request(), 2); /* the first one shows that the program is slow */
    lose_a_request();
    assert_int_equal(frames_before_a_request(), 1);
    response_1(111);
    expect_mm(111);
    for (unsigned i = 0; i != 2; i++) {
        assert_int_equal(frames_before_a_request(), 1); /* the response has ended the row */
        lose_a_request();
    }
    for (unsigned i = 0; i != 16; i++) {
        sum += frames_before_a_request();
        lose_a_request();
    }
    assert_in_range(sum, 16 * 4, 16 * 16);
}
