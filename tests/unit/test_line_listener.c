/* SPDX-License-Identifier: MIT */
#include "line_conversation.h"

static const suite_t suite = {.set_up = set_up};
static const suite_t asked = {.set_up = set_up_asked};

#define FRAME    "FF 07 A1 A7"          /* of an A16 that sends by itself */
#define RESPONDS "01 03 02 02 F2 38 A1" /* 754 mm */

#define HOLDS(is_so)       STEP(holds, .which = (is_so))
#define CALLS(n)           STEP(calls, .value = (n))     /* of the listener */
#define TIME_IS_NOW        STEP(time_is_now, .which = 0) /* of its last bytes */
#define LISTEN_NULL        STEP(listen_null, .which = 0)
#define UNLISTEN(is_other) STEP(unlisten, .which = (is_other))

static fathom_listener_t other;

static void play_holds(const step_t *step)
{
    assert_int_equal(fathom_line_holds_bytes(&bench.line), step->which != 0);
}

static void play_calls(const step_t *step) { assert_int_equal(bench_listener.calls, step->value); }
static void play_time_is_now(const step_t *step)
{
    assert_int_equal(bench_listener.time_us, bench.fake.now_us);
}

static void play_listen_null(const step_t *step)
{
    assert_int_equal(fathom_line_listen(&bench.line, NULL), FATHOM_OK);
}

static void play_unlisten(const step_t *step)
{
    fathom_line_unlisten(&bench.line, step->which != 0 ? &other : &bench_listener.base);
}

static const conversation_t conversations[] = {
    /* 2 ms of silence have been seen before the first bytes */
    ROW("a_listener_gets_unsolicited_bytes_with_the_gaps_that_were_seen", COUNTS(0), LISTEN(5000), WAIT(2000),
        ARRIVE("FF 07"), WAIT(1000), HEARD("FF 07", 0), ARRIVE("A1 A7"), WAIT(6000), RECEIVE(FRAME),
        HEARD(FRAME " " FRAME, 1), GAP_AT(4), TIME_IS_NOW),
    /* 222 mm of unit 2 */
    ROW("whole_foreign_frames_go_to_the_listener", COUNTS(.strays = 2, .dropped = 7), LISTEN(5000), ASK(A, 1),
        RESPONSE(2, 222), WAIT(100), HEARD("02 03 02 00 DE 7C 1C", 0), CALLS(1), LISTEN_NULL,
        RESPONSE(2, 222), WAIT(100), CALLS(1)),
    ROW("only_the_listener_of_the_line_can_be_removed", COUNTS(.dropped = 4), LISTEN(5000), UNLISTEN(true),
        RECEIVE(FRAME), HEARD(FRAME, 0), UNLISTEN(false), RECEIVE(FRAME), HEARD(FRAME, 0)),
    ROW("listening_with_null_removes_the_listener", COUNTS(.dropped = 4), LISTEN(5000), LISTEN_NULL,
        RECEIVE(FRAME), HEARD("", 0)),
    /* after the response none is expected: the frame buffer has the bytes, and the listener too */
    ROW("the_line_holds_bytes_that_may_begin_a_response_until_it_knows", COUNTS(.responses = 1), LISTEN(5000),
        ASK(A, 1), ARRIVE("01 03 02"), WAIT(200), HOLDS(true), HEARD("", 0), ARRIVE("02 F2 38 A1"), WAIT(200),
        READS(A, 754), HOLDS(false), WAIT(2 * GAP_US), ARRIVE("01 03 02"), WAIT(200), HOLDS(false),
        HEARD("01 03 02", 1)),
    ROW("a_silence_that_the_port_saw_ends_a_frame", COUNTS(.responses = 1, .dropped = 4), ASK(A, 1),
        ARRIVE("01 03 02 02"), RECEIVE_WITH(SILENCE, RESPONDS), READS(A, 754)),
    ROW("an_overrun_ends_the_frame_before_it_and_keeps_the_bytes_after_it",
        COUNTS(.responses = 1, .dropped = 4, .bad = 1), ASK(A, 1), ARRIVE("01 03 02 02"),
        RECEIVE_WITH(OVERRUN, RESPONDS), READS(A, 754)),
    ROW("a_silence_behind_bytes_that_are_held_back_is_none_before_them", COUNTS(.responses = 1), LISTEN(5000),
        ASK(A, 1), RECEIVE("01 03 02 02"), RECEIVE_WITH(SILENCE, RESPONDS), READS(A, 754),
        HEARD("01 03 02 02", 0)),
    ROW("the_first_bytes_are_after_a_gap_if_it_was_seen", COUNTS(0), LISTEN(GAP_US), POLL_AFTER(GAP_US),
        ARRIVE("01 02"), POLL_AFTER(1), HEARD("01 02", 1)),
    ROW("the_first_bytes_are_after_no_gap_if_it_was_not_seen", COUNTS(0), LISTEN(GAP_US),
        POLL_AFTER(GAP_US - 1), ARRIVE("01 02"), POLL_AFTER(1), HEARD("01 02", 0)),
    /* the last two bytes may have followed at once: the line was not polled */
    ROW("a_pause_between_polls_is_no_gap", COUNTS(0), LISTEN(5000), ARRIVE("FF 07"), POLL_AFTER(20000),
        ARRIVE("A1 A7"), POLL_AFTER(20000), HEARD(FRAME, 0)),
    ROW("after_a_broken_port_no_silence_is_known", COUNTS(.port_errors = 1), LISTEN(5000), RECEIVE("FF 07"),
        BREAK_PORT, RECEIVE("A1 A7"), HEARD(FRAME, 0)),
    ROW("unasked_bytes_around_a_response_go_to_the_listener_and_the_response_does_not",
        COUNTS(.responses = 1), LISTEN(5000), ASK(A, 1), ARRIVE(FRAME), WAIT(200), ARRIVE(RESPONDS),
        WAIT(GAP_US + 200), ARRIVE(FRAME), WAIT(200), READS(A, 754), HEARD(FRAME " " FRAME, 1)),
    /* FF before the response and 00 00 FF behind it are no FF 00 00 FF */
    ROW("what_comes_behind_a_response_does_not_follow_what_came_before_it", COUNTS(.responses = 1),
        LISTEN(5000), ASK(A, 1), ARRIVE("FF"), ARRIVE(RESPONDS), ARRIVE("07 A1 A7"), WAIT(200), READS(A, 754),
        WAIT(2 * GAP_US), HEARD(FRAME, 1), GAP_AT(1)),
    ROW("a_listener_gets_the_bytes_after_an_overrun_and_is_told_of_it_before", COUNTS(.bad = 1), LISTEN(5000),
        ARRIVE("FF"), RECEIVE_WITH(OVERRUN, "A1 A7"), HEARD("FF A1 A7", 0), LOST_AT(1, 1)),
    /* bytes were lost between the silence and these */
    ROW("bytes_after_an_overrun_are_not_the_first_after_a_silence", COUNTS(.bad = 1), LISTEN(5000),
        WAIT(10000), RECEIVE_WITH(OVERRUN, "A1 A7"), HEARD("A1 A7", 0), LOST_AT(0, 1)),
    /* what waited as the possible beginning of a response comes before the loss, in the order in which it came */
    ROW("what_a_transaction_held_back_goes_to_the_listener_before_the_loss", COUNTS(.damaged = 1, .bad = 1),
        LISTEN(5000), ASK(A, 1), RECEIVE("01 03 02 02"), HEARD("", 0), RECEIVE_WITH(OVERRUN, FRAME),
        WAIT(2 * GAP_US), HEARD("01 03 02 02 " FRAME, 0), LOST_AT(4, 1), FAILS(A, CHECKSUM)),
    ROW("lost_bytes_while_nothing_is_asked_are_only_counted",
        COUNTS(.bad = 5, .dropped = 4, .responses = 1, .maybe_unsolicited = 1), RECEIVE_WITH(FRAMING, FRAME),
        RECEIVE_WITH(OVERRUN, FRAME), ASK(A, 1), RESPONSE(1, 754), READS(A, 754)),
};
CONVERSATIONS(set_up, conversations)

/* ---- what the port knows about bytes ---- */

TEST(bytes_that_the_port_marks_as_bad_never_become_part_of_a_response)
{
    static const uint8_t flags[] = {FATHOM_RX_PARITY, FATHOM_RX_FRAMING};
    for (size_t i = 0; i != sizeof flags; i++) {
        set_up_asked(state);
        receive(response_1_754, 4);
        receive_rx(response_1_754 + 4, 3, flags[i]);
        expect_after(GAP_US + 300, FATHOM_ERR_CHECKSUM);
        expect_count(FATHOM_LINE_BAD_BYTES, 3);
    }
}

TEST_IN(asked, with_time_stamps_the_next_request_need_not_wait_for_the_loop)
{
    ask_other(2);
    const fathom_rx_t rx = {bench.fake.now_us + 1000, FATHOM_RX_TIMED};
    fake_receive_rx(&bench.fake, 1000, response_1_754, sizeof response_1_754, rx);
    run_in_steps(20000, 20000); /* one late poll: the response was in 19 ms ago, and the line silent since */
    expect(FATHOM_OK);
    expect_written(2);
    assert_int_equal(fathom_line_last_byte_us(&bench.line), rx.last_us);
}

/* ---- the listener ---- */

/* ---- bytes that the port knows to be wrong or missing ---- */

TEST(a_listener_is_told_where_bytes_were_lost_and_never_gets_a_marked_one)
{
    static const uint8_t flags[] = {FATHOM_RX_PARITY, FATHOM_RX_FRAMING,
                                    FATHOM_RX_PARITY | FATHOM_RX_OVERRUN};
    for (size_t i = 0; i != sizeof flags; i++) {
        set_up(state);
        listen_for(5000);
        receive(auto_frame, 2);
        receive_rx(auto_frame, 3, flags[i]);
        deliver(auto_frame + 2, 2);
        expect_heard(auto_frame, 2, auto_frame + 2, 2);
        assert_int_equal(bench_listener.losses, 1);
        assert_int_equal(bench_listener.lost_at, 2);
        assert_int_equal(bench_listener.gaps, 0);
        expect_count(FATHOM_LINE_BAD_BYTES, 3);
        expect_count(FATHOM_LINE_DROPPED_BYTES, 0);
    }
}

/* Bytes were lost, and then these came: of an overrun the port tells with them, of a marked byte with that byte. */
static void lose_and_receive(uint8_t flag, const uint8_t *bytes, size_t length)
{
    if (flag == FATHOM_RX_OVERRUN) {
        receive_rx(bytes, length, flag);
    } else {
        receive_rx(auto_frame, 1, flag);
        receive(bytes, length);
    }
}

static const uint8_t losses[] = {FATHOM_RX_PARITY, FATHOM_RX_FRAMING, FATHOM_RX_OVERRUN};

/* The same read before and after: only together would they be a response. */
TEST(a_response_is_never_put_together_across_lost_bytes)
{
    for (size_t i = 0; i != COUNT_OF(losses); i++)
        for (size_t cut = 1; cut != sizeof response_1_754; cut++) {
            set_up_asked(state);
            receive(response_1_754, cut);
            lose_and_receive(losses[i], response_1_754 + cut, sizeof response_1_754 - cut);
            run(TIMEOUT_US + 400);
            expect_failed(cut >= 3 ? FATHOM_ERR_CHECKSUM : FATHOM_ERR_NO_RESPONSE);
        }
}

TEST(a_whole_response_after_lost_bytes_is_taken)
{
    for (size_t i = 0; i != COUNT_OF(losses); i++) {
        set_up_asked(state);
        receive(response_1_754, 5);
        lose_and_receive(losses[i], response_1_751, sizeof response_1_751);
        run(100);
        expect_mm(751);
    }
}
