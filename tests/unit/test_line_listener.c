/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

static const suite_t suite = {.set_up = set_up};
static const suite_t asked = {.set_up = set_up_asked};

/* ---- what the port knows about bytes ---- */

TEST_IN(asked, a_silence_that_the_port_saw_ends_a_frame)
{
    receive(response_1_754, 4);
    receive_rx(response_1_754, sizeof response_1_754, FATHOM_RX_SILENCE);
    poll_line();
    expect_mm(754);
    expect_count(FATHOM_LINE_DROPPED_BYTES, 4);
}

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

TEST_IN(asked, an_overrun_ends_the_frame_before_it_and_keeps_the_bytes_after_it)
{
    receive(response_1_754, 4);
    receive_rx(response_1_754, sizeof response_1_754, FATHOM_RX_OVERRUN);
    run(100);
    expect_mm(754);
}

TEST_IN(asked, a_silence_behind_bytes_that_are_held_back_is_none_before_them)
{
    listen_for(5000);
    deliver(response_1_754, 4);
    receive_rx(response_1_754, sizeof response_1_754, FATHOM_RX_SILENCE);
    run(100);
    expect_mm(754);
    expect_heard(response_1_754, 4, NULL, 0);
    assert_int_equal(bench_listener.gaps, 0);
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

TEST(a_listener_gets_unsolicited_bytes_with_the_gaps_that_were_seen)
{
    listen_for(5000);
    run(2000);
    receive(auto_frame, 2); /* only 2 ms of silence have been seen */
    run(1000);
    assert_int_equal(bench_listener.gaps, 0);
    receive(auto_frame + 2, 2);
    run(6000);
    deliver(auto_frame, 4);
    expect_heard(auto_frame, 4, auto_frame, 4);
    assert_int_equal(bench_listener.gaps, 1);
    assert_int_equal(bench_listener.gap_at, 4);
    assert_int_equal(bench_listener.time_us, bench.fake.now_us);
    expect_count(FATHOM_LINE_DROPPED_BYTES, 0);
}

TEST(a_pause_between_polls_is_no_gap)
{
    listen_for(5000);
    poll_line();
    receive(auto_frame, 2);
    run_in_steps(20000, 20000);
    receive(auto_frame + 2, 2); /* may have followed at once; the line was not polled */
    run_in_steps(20000, 20000);
    assert_int_equal(bench_listener.length, 4);
    assert_int_equal(bench_listener.gaps, 0);
}

TEST(after_a_broken_port_no_silence_is_known)
{
    listen_for(5000);
    deliver(auto_frame, 2);
    break_port();
    deliver(auto_frame + 2, 2);
    expect_heard(auto_frame, 2, auto_frame + 2, 2);
    assert_int_equal(bench_listener.gaps, 0);
}

TEST(unasked_bytes_around_a_response_go_to_the_listener_and_the_response_does_not)
{
    listen_for(5000);
    ask_1_and_send(0);
    receive_all(auto_frame);
    run(200);
    receive_all(response_1_754);
    run(GAP_US + 200);
    receive_all(auto_frame);
    expect_after(200, FATHOM_OK);
    expect_heard(auto_frame, 4, auto_frame, 4);
}

/* FF before the response and 00 00 FF behind it are no FF 00 00 FF. */
TEST(what_comes_behind_a_response_does_not_follow_what_came_before_it)
{
    listen_for(5000);
    ask_1_and_send(0);
    receive(auto_frame, 1);
    receive_all(response_1_754);
    receive(auto_frame + 1, 3);
    expect_after(200, FATHOM_OK);
    run(2 * GAP_US);
    expect_heard(auto_frame, 1, auto_frame + 1, 3);
    assert_int_equal(bench_listener.gaps, 1);
    assert_int_equal(bench_listener.gap_at, 1);
}

TEST(whole_foreign_frames_go_to_the_listener)
{
    listen_for(5000);
    ask_1_and_send(0);
    receive_response(2, 222);
    run(200);
    assert_int_equal(bench_listener.length, 7);
    assert_int_equal(bench_listener.calls, 1);
    (void)fathom_line_replace_listener(&bench.line, NULL);
    receive_response(2, 222);
    run(200);
    assert_int_equal(bench_listener.length, 7);
    expect_count(FATHOM_LINE_DROPPED_BYTES, 7);
}

TEST(only_the_listener_of_the_line_can_be_removed)
{
    fathom_listener_t other = bench_listener.base;
    listen_for(5000);
    fathom_line_unlisten(&bench.line, &other);
    deliver(auto_frame, 4);
    assert_int_equal(bench_listener.length, 4);
    fathom_line_unlisten(&bench.line, &bench_listener.base);
    deliver(auto_frame, 4);
    assert_int_equal(bench_listener.length, 4);
    expect_count(FATHOM_LINE_DROPPED_BYTES, 4);
    assert_int_equal(fathom_line_listen(&bench.line, &other), FATHOM_OK);
}

TEST(listening_with_null_removes_the_listener)
{
    listen_for(5000);
    assert_int_equal(fathom_line_listen(&bench.line, NULL), FATHOM_OK);
    deliver(auto_frame, 4);
    assert_int_equal(bench_listener.length, 0);
    expect_count(FATHOM_LINE_DROPPED_BYTES, 4);
}

TEST(the_line_holds_bytes_that_may_begin_a_response_until_it_knows)
{
    listen_for(5000);
    ask_1_and_send(0);
    receive(response_1_754, 3);
    run(200);
    assert_true(fathom_line_holds_bytes(&bench.line));
    assert_int_equal(bench_listener.length, 0);
    receive(response_1_754 + 3, sizeof response_1_754 - 3);
    expect_after(200, FATHOM_OK);
    assert_false(fathom_line_holds_bytes(&bench.line));
    run(2 * GAP_US);
    receive(response_1_754,
            3); /* No response is expected: the frame buffer has the bytes, and the listener too. */
    run(200);
    assert_false(fathom_line_holds_bytes(&bench.line));
    assert_int_equal(bench_listener.length, 3);
}

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

TEST(a_listener_gets_the_bytes_after_an_overrun_and_is_told_of_it_before)
{
    listen_for(5000);
    receive(auto_frame, 1);
    receive_rx(auto_frame + 2, 2, FATHOM_RX_OVERRUN);
    run(100);
    expect_heard(auto_frame, 1, auto_frame + 2, 2);
    assert_int_equal(bench_listener.losses, 1);
    assert_int_equal(bench_listener.lost_at, 1);
    expect_count(FATHOM_LINE_BAD_BYTES, 1);
}

/* What waited as the possible beginning of a response comes before the loss, in the order in which it came. */
TEST(what_a_transaction_held_back_goes_to_the_listener_before_the_loss)
{
    listen_for(5000);
    ask_1_and_send(0);
    deliver(response_1_754, 4);
    assert_int_equal(bench_listener.length, 0);
    receive_rx(auto_frame, 4, FATHOM_RX_OVERRUN);
    run(100);
    run(2 * GAP_US);
    expect_heard(response_1_754, 4, auto_frame, 4);
    assert_int_equal(bench_listener.lost_at, 4);
    expect(FATHOM_ERR_CHECKSUM);
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

TEST(lost_bytes_while_nothing_is_asked_are_only_counted)
{
    receive_rx(auto_frame, 4, FATHOM_RX_FRAMING);
    receive_rx(auto_frame, 4, FATHOM_RX_OVERRUN);
    run(100);
    expect_count(FATHOM_LINE_BAD_BYTES, 5);
    expect_count(FATHOM_LINE_DROPPED_BYTES, 4);
    ask_1_and_send(0);
    response_1(754);
}
