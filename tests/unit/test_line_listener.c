/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

static const suite_t suite = {.set_up = set_up};

/* ---- what the port knows about bytes ---- */

TEST(a_silence_that_the_port_saw_ends_a_frame)
{
    ask_1_and_send(0);
    receive(answer_1_754, 4);
    fake_receive_rx(&bench.fake, 0, answer_1_754, sizeof answer_1_754, (fathom_rx_t){0, FATHOM_RX_SILENCE});
    fathom_line_poll(&bench.line);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_int_equal(bench.value, 754);
    assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), 4);
}

TEST(bytes_that_the_port_marks_as_bad_never_become_part_of_an_answer)
{
    static const uint8_t flags[] = {FATHOM_RX_PARITY, FATHOM_RX_FRAMING};
    for (size_t i = 0; i != sizeof flags; i++) {
        set_up(state);
        ask_1_and_send(0);
        receive(answer_1_754, 4);
        fake_receive_rx(&bench.fake, 0, answer_1_754 + 4, 3, (fathom_rx_t){0, flags[i]});
        run(GAP_US + 300);
        assert_int_equal(status_of(&bench.request), FATHOM_ERR_CHECKSUM);
        assert_int_equal(counter(FATHOM_LINE_BAD_BYTES), 3);
    }
}

TEST(an_overrun_ends_the_frame_before_it_and_keeps_the_bytes_after_it)
{
    ask_1_and_send(0);
    receive(answer_1_754, 4);
    fake_receive_rx(&bench.fake, 0, answer_1_754, sizeof answer_1_754, (fathom_rx_t){0, FATHOM_RX_OVERRUN});
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
}

TEST(with_time_stamps_the_next_request_need_not_wait_for_the_loop)
{
    ask_1_and_send(0);
    ask(&bench.other, 2, &bench.other_value, 0);
    const fathom_rx_t rx = {bench.fake.now_us + 1000, FATHOM_RX_TIMED};
    fake_receive_rx(&bench.fake, 1000, answer_1_754, sizeof answer_1_754, rx);
    run_in_steps(20000, 20000); /* one late poll: the answer was in 19 ms ago, and the line silent since */
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_int_equal(bench.fake.written, 2);
    assert_int_equal(fathom_line_heard_us(&bench.line), rx.last_us);
}

/* ---- the listener ---- */

typedef struct {
    fathom_listener_t listener;
    uint8_t bytes[256];
    size_t length;
    unsigned calls;
    unsigned gaps;
    size_t gap_at; /* of the last one */
    unsigned losses;
    size_t lost_at; /* of the last one */
    uint32_t time_us;
} ear_t;

static void hear(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                 uint32_t time_us)
{
    ear_t *const ear = (ear_t *)listener;
    if (count == 0) ear->losses++, ear->lost_at = ear->length;
    if (after_gap) ear->gaps++, ear->gap_at = ear->length;
    memcpy(ear->bytes + ear->length, bytes, count);
    ear->length += count;
    ear->calls++;
    ear->time_us = time_us;
}

static ear_t ear_of(uint16_t gap_us)
{
    ear_t ear;
    memset(&ear, 0, sizeof ear);
    ear.listener.receive = hear;
    ear.listener.gap_us = gap_us;
    return ear;
}

static const uint8_t auto_frame[] = {0xFF, 0x07, 0xA1, 0xA7}; /* A16 2(4): 1953 mm */

TEST(a_listener_gets_what_nobody_asked_for_with_the_gaps_that_were_seen)
{
    ear_t ear = ear_of(5000);
    fathom_line_listen(&bench.line, &ear.listener);
    run(2000);
    receive(auto_frame, 2); /* only 2 ms of silence have been seen */
    run(1000);
    assert_int_equal(ear.gaps, 0);
    receive(auto_frame + 2, 2);
    run(6000);
    receive(auto_frame, 4);
    run(100);
    assert_int_equal(ear.length, 8);
    assert_int_equal(ear.gaps, 1);
    assert_int_equal(ear.gap_at, 4);
    assert_int_equal(ear.time_us, bench.fake.now_us);
    assert_memory_equal(ear.bytes, auto_frame, 4);
    assert_memory_equal(ear.bytes + 4, auto_frame, 4);
    assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), 0);
}

TEST(a_pause_between_polls_is_no_gap)
{
    ear_t ear = ear_of(5000);
    fathom_line_listen(&bench.line, &ear.listener);
    fathom_line_poll(&bench.line);
    receive(auto_frame, 2);
    run_in_steps(20000, 20000);
    receive(auto_frame + 2, 2); /* may have followed at once; nobody looked */
    run_in_steps(20000, 20000);
    assert_int_equal(ear.length, 4);
    assert_int_equal(ear.gaps, 0);
}

TEST(a_silence_that_the_port_saw_is_a_gap)
{
    ear_t ear = ear_of(5000);
    fathom_line_listen(&bench.line, &ear.listener);
    fake_receive_rx(&bench.fake, 0, auto_frame, 4, (fathom_rx_t){0, FATHOM_RX_SILENCE});
    run(100);
    assert_int_equal(ear.gaps, 1);
}

TEST(unasked_bytes_around_an_answer_go_to_the_listener_and_the_answer_does_not)
{
    ear_t ear = ear_of(5000);
    fathom_line_listen(&bench.line, &ear.listener);
    ask_1_and_send(0);
    receive(auto_frame, sizeof auto_frame);
    run(200);
    receive(answer_1_754, sizeof answer_1_754);
    run(GAP_US + 200);
    receive(auto_frame, sizeof auto_frame);
    run(200);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_int_equal(ear.length, 8);
    assert_memory_equal(ear.bytes, auto_frame, 4);
    assert_memory_equal(ear.bytes + 4, auto_frame, 4);
}

TEST(only_the_first_of_unasked_bytes_during_an_exchange_is_after_the_gap)
{
    ear_t ear = ear_of(5000);
    fathom_line_listen(&bench.line, &ear.listener);
    ask_1_and_send(0);
    run(6000);
    receive(auto_frame, 4); /* given one by one: each might have begun an answer */
    run(2 * GAP_US);
    assert_int_equal(ear.length, 4);
    assert_int_equal(ear.calls, 4);
    assert_int_equal(ear.gaps, 1);
    assert_int_equal(ear.gap_at, 0);
}

TEST(our_own_request_is_no_silence)
{
    ear_t ear = ear_of(5000);
    fathom_line_listen(&bench.line, &ear.listener);
    ask_1_and_send(0); /* 8 ms of it */
    receive(auto_frame, 4);
    run(2 * GAP_US);
    assert_int_equal(ear.length, 4);
    assert_int_equal(ear.gaps, 0);
}

TEST(whole_foreign_frames_go_to_the_listener)
{
    ear_t ear = ear_of(5000);
    fathom_line_listen(&bench.line, &ear.listener);
    ask_1_and_send(0);
    receive_answer(2, 222);
    run(200);
    assert_int_equal(ear.length, 7);
    assert_int_equal(ear.calls, 1);
    fathom_line_listen(&bench.line, NULL);
    receive_answer(2, 222);
    run(200);
    assert_int_equal(ear.length, 7);
    assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), 7);
}

/* ---- bytes that the port knows to be wrong or missing ---- */

TEST(a_listener_is_told_where_bytes_were_lost_and_never_gets_a_marked_one)
{
    static const uint8_t flags[] = {FATHOM_RX_PARITY, FATHOM_RX_FRAMING,
                                    FATHOM_RX_PARITY | FATHOM_RX_OVERRUN};
    for (size_t i = 0; i != sizeof flags; i++) {
        set_up(state);
        ear_t ear = ear_of(5000);
        fathom_line_listen(&bench.line, &ear.listener);
        receive(auto_frame, 2);
        fake_receive_rx(&bench.fake, 0, auto_frame, 3, (fathom_rx_t){0, flags[i]});
        receive(auto_frame + 2, 2);
        run(100);
        assert_int_equal(ear.length, 4);
        assert_memory_equal(ear.bytes, auto_frame, 4);
        assert_int_equal(ear.losses, 1);
        assert_int_equal(ear.lost_at, 2);
        assert_int_equal(ear.gaps, 0);
        assert_int_equal(counter(FATHOM_LINE_BAD_BYTES), 3);
        assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), 0);
    }
}

TEST(a_listener_gets_the_bytes_after_an_overrun_and_is_told_of_it_before)
{
    ear_t ear = ear_of(5000);
    fathom_line_listen(&bench.line, &ear.listener);
    receive(auto_frame, 1);
    fake_receive_rx(&bench.fake, 0, auto_frame + 2, 2, (fathom_rx_t){0, FATHOM_RX_OVERRUN});
    run(100);
    assert_int_equal(ear.length, 3);
    assert_memory_equal(ear.bytes + 1, auto_frame + 2, 2);
    assert_int_equal(ear.losses, 1);
    assert_int_equal(ear.lost_at, 1);
    assert_int_equal(counter(FATHOM_LINE_BAD_BYTES), 1);
}

/* What waited as the possible beginning of an answer comes before the loss, in the order in which it came. */
TEST(what_an_exchange_held_back_goes_to_the_listener_before_the_loss)
{
    ear_t ear = ear_of(5000);
    fathom_line_listen(&bench.line, &ear.listener);
    ask_1_and_send(0);
    receive(answer_1_754, 4);
    run(100);
    assert_int_equal(ear.length, 0);
    fake_receive_rx(&bench.fake, 0, auto_frame, 4, (fathom_rx_t){0, FATHOM_RX_OVERRUN});
    run(100);
    run(2 * GAP_US);
    assert_int_equal(ear.length, 8);
    assert_memory_equal(ear.bytes, answer_1_754, 4);
    assert_memory_equal(ear.bytes + 4, auto_frame, 4);
    assert_int_equal(ear.lost_at, 4);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_CHECKSUM);
}

/* The same read before and after: only together would they be an answer. */
TEST(an_answer_is_never_put_together_across_lost_bytes)
{
    static const uint8_t flags[] = {FATHOM_RX_PARITY, FATHOM_RX_FRAMING, FATHOM_RX_OVERRUN};
    for (size_t i = 0; i != sizeof flags; i++)
        for (size_t cut = 1; cut != sizeof answer_1_754; cut++) {
            const bool is_overrun = flags[i] == FATHOM_RX_OVERRUN;
            set_up(state);
            ask_1_and_send(0);
            receive(answer_1_754, cut);
            if (is_overrun) {
                fake_receive_rx(&bench.fake, 0, answer_1_754 + cut, sizeof answer_1_754 - cut,
                                (fathom_rx_t){0, flags[i]});
            } else {
                fake_receive_rx(&bench.fake, 0, auto_frame, 1, (fathom_rx_t){0, flags[i]});
                receive(answer_1_754 + cut, sizeof answer_1_754 - cut);
            }
            run(TIMEOUT_US + 400);
            assert_int_equal(status_of(&bench.request),
                             cut >= 3 ? FATHOM_ERR_CHECKSUM : FATHOM_ERR_NO_ANSWER);
            assert_int_equal(bench.value, 0xDEAD);
        }
}

TEST(a_whole_answer_after_lost_bytes_is_taken)
{
    static const uint8_t flags[] = {FATHOM_RX_PARITY, FATHOM_RX_FRAMING, FATHOM_RX_OVERRUN};
    for (size_t i = 0; i != sizeof flags; i++) {
        set_up(state);
        ask_1_and_send(0);
        receive(answer_1_754, 5);
        fake_receive_rx(&bench.fake, 0, flags[i] == FATHOM_RX_OVERRUN ? answer_1_751 : auto_frame,
                        flags[i] == FATHOM_RX_OVERRUN ? 7 : 4, (fathom_rx_t){0, flags[i]});
        if (flags[i] != FATHOM_RX_OVERRUN) receive(answer_1_751, sizeof answer_1_751);
        run(100);
        assert_int_equal(status_of(&bench.request), FATHOM_READY);
        assert_int_equal(bench.value, 751);
    }
}

TEST(lost_bytes_while_nothing_is_asked_are_only_counted)
{
    fake_receive_rx(&bench.fake, 0, auto_frame, 4, (fathom_rx_t){0, FATHOM_RX_FRAMING});
    fake_receive_rx(&bench.fake, 0, auto_frame, 4, (fathom_rx_t){0, FATHOM_RX_OVERRUN});
    run(100);
    assert_int_equal(counter(FATHOM_LINE_BAD_BYTES), 5);
    assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), 4);
    ask_1_and_send(0);
    receive(answer_1_754, sizeof answer_1_754);
    run(100);
    assert_int_equal(bench.value, 754);
}

TEST(due_makes_room_for_the_listener_to_see_its_gap)
{
    ear_t ear = ear_of(5000);
    fathom_line_listen(&bench.line, &ear.listener);
    receive(auto_frame, 4);
    fathom_line_poll(&bench.line);
    assert_int_equal(fathom_line_due_us(&bench.line), 5000);
    run_in_steps(5000, 5000);
    assert_int_equal(fathom_line_due_us(&bench.line), FATHOM_NO_DEADLINE);
}
