/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* line.h, rule 14: after a pause between two polls the line drops bytes that may be too old. */

static const suite_t suite = {.set_up = set_up};

enum { STALE_US = 20000 };

static void listen_stale(void)
{
    listen_for(GAP_US);
    bench_listener.base.stale_us = STALE_US;
}

/* The program does not poll for `us`, and these bytes arrive meanwhile. */
static void pause_with(const uint8_t *bytes, size_t length, uint32_t us)
{
    receive(bytes, length);
    bench.fake.now_us += us;
    (void)poll_line();
}

TEST(a_late_response_is_dropped_if_the_pause_exceeds_the_time_out_by_more_than_half_a_second)
{
    for (unsigned is_longer = 0; is_longer != 2; is_longer++) {
        set_up(state);
        ask_1_and_send(1);
        run(TIMEOUT_US); /* now the unit is in quarantine, and the transaction waits for its retry */
        expect(FATHOM_PENDING);
        pause_with(response_1_754, 7, TIMEOUT_US + FATHOM_LINE_LATE_US + is_longer);
        expect_count(FATHOM_LINE_OLD_BYTES, is_longer != 0 ? 7 : 0);
    }
}

TEST(a_pause_is_measured_against_the_listener_s_limit)
{
    for (unsigned is_longer = 0; is_longer != 2; is_longer++) {
        set_up(state);
        listen_stale();
        pause_with(auto_frame, 4, STALE_US + FATHOM_LINE_LATE_US + is_longer);
        expect_count(FATHOM_LINE_OLD_BYTES, is_longer != 0 ? 4 : 0);
        assert_int_equal(bench_listener.length, is_longer != 0 ? 0 : 4);
    }
}

TEST(a_pause_without_bytes_is_no_loss_for_the_listener)
{
    listen_stale();
    pause_with(auto_frame, 0, 1000000);
    deliver(auto_frame, 4);
    expect_heard(auto_frame, 4, auto_frame, 0);
    assert_int_equal(bench_listener.losses, 0);
}

TEST(dropped_bytes_are_a_loss_that_the_listener_receives_once_with_the_next_bytes)
{
    listen_stale();
    deliver(auto_frame, 2);
    pause_with(auto_frame, 4, 1000000);
    run(100);
    assert_int_equal(bench_listener.losses, 0);
    deliver(auto_frame, 4);
    deliver(auto_frame, 4);
    assert_int_equal(bench_listener.length, 10);
    assert_int_equal(bench_listener.losses, 1);
    assert_int_equal(bench_listener.lost_at, 2);
    expect_count(FATHOM_LINE_OLD_BYTES, 4);
}

/* Rule 11: four bytes show that a device sends by itself. Then a request leaves behind its next frame, or after 65 ms. */
TEST(dropped_bytes_still_show_that_a_device_sends_by_itself)
{
    for (unsigned length = 3; length != 5; length++) {
        set_up(state);
        listen_stale();
        pause_with(auto_frame, length, 1000000);
        run(10000); /* a request could have left in this silence */
        ask_1(0);
        expect_written_after(20000, length == 4 ? 0 : 1);
        expect_written_after(40000, 1);
    }
}

/* A line without a listener counts the bytes as old, not as dropped. */
TEST(a_flush_drops_what_the_port_holds)
{
    receive(auto_frame, 4);
    fathom_line_flush(&bench.line);
    run(100);
    expect_count(FATHOM_LINE_OLD_BYTES, 4);
    expect_count(FATHOM_LINE_DROPPED_BYTES, 0);
    listen_for(GAP_US);
    deliver(auto_frame, 4);
    assert_int_equal(bench_listener.length, 4);
}

/* The silence before the next request begins with the error. */
TEST(after_an_error_of_the_port_during_a_request_the_whole_silence_is_kept)
{
    ask_1_and_send(0);
    run(T3_5_US);
    bench.fake.read_fails = true;
    assert_int_equal(poll_line(), FATHOM_ERR_PORT);
    bench.fake.read_fails = false;
    ask_other(2);
    expect_due(T3_5_US);
}

TEST(bytes_that_the_port_dates_are_as_old_as_their_time_stamp)
{
    for (unsigned is_older = 0; is_older != 2; is_older++) {
        set_up(state);
        listen_stale();
        bench.fake.now_us += 1000000;
        const uint32_t age_us = STALE_US + FATHOM_LINE_LATE_US + is_older;
        fake_receive_rx(&bench.fake, 0, auto_frame, 4,
                        (fathom_rx_t){bench.fake.now_us - age_us, FATHOM_RX_TIMED});
        (void)poll_line();
        expect_count(FATHOM_LINE_OLD_BYTES, is_older != 0 ? 4 : 0);
        assert_int_equal(bench_listener.length, is_older != 0 ? 0 : 4);
    }
}

TEST(a_flush_is_a_loss_for_the_listener_at_once)
{
    listen_for(GAP_US);
    deliver(auto_frame, 2);
    fathom_line_flush(&bench.line);
    assert_int_equal(bench_listener.losses, 1);
    assert_int_equal(bench_listener.lost_at, 2);
}

TEST(a_flush_before_the_port_was_seen_empty_drops_its_bytes_too)
{
    assert_int_equal(fathom_line_init(&bench.line, &bench.config), FATHOM_OK);
    fathom_line_flush(&bench.line);
    deliver(auto_frame, 4);
    expect_count(FATHOM_LINE_OLD_BYTES, 4);
}

/* Rule 15: nothing that was learnt before the error remains valid. */
TEST(bytes_before_and_after_an_error_of_the_port_do_not_add_up_to_a_device_that_sends_by_itself)
{
    deliver_hex("00 00 00");
    break_port();
    run(100);
    deliver_hex("00");
    run(T3_5_US + 1000);
    ask_1(0);
    expect_written_after(1000, 1);
}
