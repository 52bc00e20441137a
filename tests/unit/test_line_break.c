/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* A break of the line: TX as the trigger or the mode select of a module. */

static fathom_status_t hold_low(void) { return fathom_line_break(&bench.line, true); }

static void hold(bool low) { assert_int_equal(fathom_line_break(&bench.line, low), FATHOM_OK); }

static const suite_t suite = {.set_up = set_up};

TEST(a_break_holds_tx_low_until_it_is_ended)
{
    hold(true);
    assert_true(bench.fake.in_break);
    hold(true);
    run(100000);
    assert_true(bench.fake.in_break);
    hold(false);
    assert_false(bench.fake.in_break);
}

TEST(nothing_is_sent_in_a_break_and_the_silence_is_kept_after_it)
{
    run(100000);
    hold(true);
    ask_1(0);
    run(FATHOM_LINE_DEFAULT_BUSY_US - 1000);
    expect_written(0);
    expect(FATHOM_PENDING);
    hold(false);
    expect_due(T3_5_US);
    expect_sent(T3_5_US - 100, 200);
    run(8 * BYTE_US);
    response_1(111);
}

/* line.h, rule 3: each of them waits for `busy_us`, and then the next one. */
TEST(a_transaction_ends_unsent_if_the_break_lasts_too_long)
{
    run(100000);
    hold(true);
    ask_1(2);
    expect_due(0); /* The next poll begins the wait. */
    run(FATHOM_LINE_DEFAULT_BUSY_US - 1000);
    expect(FATHOM_PENDING);
    expect_due(1100); /* The wait began with the poll after the request, 100 us later. */
    run(1200);
    expect(FATHOM_ERR_LINE_BUSY);
    expect_written(0);
    assert_true(bench.fake.in_break);
    expect_due(FATHOM_NO_DEADLINE);
}

TEST(with_a_transaction_on_the_wire_it_is_busy_and_nothing_changes)
{
    ask_1(0);
    expect_written_after(T3_5_US + 100, 1);
    assert_int_equal(hold_low(), FATHOM_ERR_BUSY); /* it is leaving */
    run(8 * BYTE_US);
    assert_int_equal(hold_low(), FATHOM_ERR_BUSY); /* the response may come */
    assert_int_equal(bench.fake.breaks, 0);
    response_1(111);
    hold(true);
    assert_int_equal(bench.fake.breaks, 1);
}

TEST(while_bytes_of_the_port_leave_it_is_pending)
{
    bench.fake.never_sent = true;
    assert_int_equal(hold_low(), FATHOM_PENDING);
    assert_false(bench.fake.in_break);
    ask_1(0);
    expect_written_after(T3_5_US + 100, 1); /* so there was no break */
}

/* The port was busy with a request; after the break it gets its time anew. */
TEST(a_request_that_the_port_refused_waits_for_the_end_of_the_break)
{
    bench.fake.write_busy = true;
    ask_1(0);
    run(T3_5_US + 900000);
    hold(true);
    run(500000);
    hold(false);
    expect_after(T3_5_US + 500000, FATHOM_PENDING);
    bench.fake.write_busy = false;
    expect_written_after(1000, 1);
}

/* A module that is triggered by the break responses in frames that begin after a silence. */
TEST(the_end_of_a_break_does_not_hide_a_silence_from_the_listener)
{
    for (unsigned silent_us = 4900; silent_us <= 5000; silent_us += 100) {
        set_up(state);
        listen_for(5000);
        hold(true);
        run(silent_us);
        hold(false);
        assert_int_equal(bench_listener.length, 0);
        deliver(response_1_754, 7);
        assert_int_equal(bench_listener.length, 7);
        assert_int_equal(bench_listener.gaps, silent_us == 5000);
    }
}

/* Unit 1 is still quarantined; of its late response a part has come, right behind a byte of noise. */
TEST(the_end_of_a_break_is_no_gap_within_what_has_come)
{
    listen_for(500);
    ask_1_and_send(0);
    expect_after(TIMEOUT_US + 1000, FATHOM_ERR_NO_RESPONSE);
    assert_int_equal(bench_listener.length, 0);
    receive_hex("55 01 03 02");
    run(1000);
    assert_int_equal(bench.line.received_count, 3);
    assert_int_equal(bench_listener.length, 1);
    assert_int_equal(bench_listener.gaps, 1);
    hold(true);
    hold(false);
    run(GAP_US + 1000);
    assert_int_equal(bench_listener.length, 4);
    assert_int_equal(bench_listener.gaps, 1);
}

/* ---- a port that refuses ---- */

enum { FOR_EVER = -1 };

static void refuse(int times, int how)
{
    bench.fake.refusals = times;
    bench.fake.refusal = how;
}

static fathom_status_t end(void) { return fathom_line_break(&bench.line, false); }

/* In a break, with a transaction that waits. */
static void hold_and_ask(void)
{
    hold(true);
    ask_1(0);
}

TEST(a_port_that_cannot_or_is_broken_says_so)
{
    bench.fake.refuses_begin = true;
    refuse(1, -1);
    assert_int_equal(hold_low(), FATHOM_ERR_PORT);
    bench.fake.uart.set_break = NULL;
    assert_int_equal(hold_low(), FATHOM_ERR_UNSUPPORTED);
    ask_1(0);
    expect_written_after(T3_5_US + 100, 1);
}

TEST(a_break_that_cannot_begin_once_more_goes_on_and_what_waits_goes_on_waiting)
{
    hold_and_ask();
    bench.fake.refuses_begin = true;
    refuse(1, -1);
    assert_int_equal(hold_low(), FATHOM_ERR_PORT);
    expect_count(FATHOM_LINE_PORT_ERRORS, 0);
    expect_written_after(T3_5_US + 200, 0);
    expect(FATHOM_PENDING);
}

TEST(the_end_of_a_break_is_asked_for_until_the_port_takes_it)
{
    hold_and_ask();
    refuse(3, 0);
    for (unsigned i = 0; i != 3; i++) {
        assert_int_equal(end(), FATHOM_PENDING);
        run_in_steps(300000, 1000);
        expect(FATHOM_PENDING);
    }
    assert_true(bench.fake.in_break);
    expect_written(0);
    hold(false);
    assert_false(bench.fake.in_break);
    expect_sent(T3_5_US - 100, 200);
}

/* Whether it is polled meanwhile or not. */
TEST(a_break_that_the_port_does_not_end_in_a_second_is_an_error_of_all_that_waits)
{
    hold(true);
    refuse(FOR_EVER, 0);
    for (unsigned second = 1; second <= 3; second++) {
        ask_1(0);
        assert_int_equal(end(), FATHOM_PENDING);
        if (second == 2)
            run_in_steps(999999, 9009);
        else
            bench.fake.now_us += 999999;
        assert_int_equal(end(), FATHOM_PENDING); /* gives it no more time */
        expect(FATHOM_PENDING);
        bench.fake.now_us++;
        assert_int_equal(end(), FATHOM_ERR_PORT);
        expect_count(FATHOM_LINE_PORT_ERRORS, second);
        expect(FATHOM_ERR_PORT);
    }
    assert_true(bench.fake.in_break);
    expect_written(0);
}

TEST(a_break_that_begins_anew_gives_its_end_a_second_anew)
{
    hold(true);
    refuse(FOR_EVER, 0);
    assert_int_equal(end(), FATHOM_PENDING);
    hold(true);
    run_in_steps(2000000, 1000);
    assert_int_equal(end(), FATHOM_PENDING);
    bench.fake.now_us += 999999;
    assert_int_equal(end(), FATHOM_PENDING);
    bench.fake.now_us++;
    assert_int_equal(end(), FATHOM_ERR_PORT);
}

/* A USB adapter may have failed for a moment, and holds TX low still: in a read, or when the break was to end. */
TEST(no_request_is_written_into_a_break_in_which_the_port_failed)
{
    for (unsigned i = 0; i != 2; i++) {
        set_up(state);
        hold_and_ask();
        if (i == 0) {
            bench.fake.now_us += 100;
            break_port();
        } else {
            refuse(1, -1);
            assert_int_equal(end(), FATHOM_ERR_PORT);
        }
        expect(FATHOM_ERR_PORT);
        expect_count(FATHOM_LINE_PORT_ERRORS, 1);
        ask_1(0);
        run_in_steps(1000000, 1000);
        assert_true(bench.fake.in_break);
        expect_written(0);
        hold(false);
        expect_sent(T3_5_US - 100, 200);
    }
}

TEST(where_there_is_no_break_a_refused_end_changes_nothing)
{
    ask_1(0);
    refuse(1, 0);
    assert_int_equal(end(), FATHOM_PENDING);
    refuse(1, -1);
    assert_int_equal(end(), FATHOM_ERR_PORT);
    expect_count(FATHOM_LINE_PORT_ERRORS, 0);
    expect_written_after(T3_5_US + 200, 1);
    refuse(1, -1); /* with a request on the wire the port is not even asked */
    hold(false);
    assert_int_equal(bench.fake.refusals, 1);
}

/* It begins where the break ends, not where the poll before that was. */
TEST(after_a_break_the_silence_is_kept_in_a_slow_loop)
{
    hold_and_ask();
    bench.fake.now_us += 20000;
    hold(false);
    expect_due(T3_5_US);
    expect_sent(T3_5_US - 100, 200);
}
