/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* A break of the line: TX as the trigger or the mode select of a module. */

static fathom_status_t hold_low(void) { return fathom_line_break(&bench.line, true); }

static void hold(bool low) { assert_int_equal(fathom_line_break(&bench.line, low), FATHOM_READY); }

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
    run(2000000); /* longer than a port may refuse */
    expect_written(0);
    expect(FATHOM_PENDING);
    expect_due(FATHOM_NO_DEADLINE);
    hold(false);
    expect_due(T3_5_US);
    expect_sent(T3_5_US - 100, 200);
    run(8 * BYTE_US);
    answer_1(111);
}

TEST(with_an_exchange_on_the_wire_it_is_busy_and_nothing_changes)
{
    ask_1(0);
    expect_written_after(T3_5_US + 100, 1);
    assert_int_equal(hold_low(), FATHOM_ERR_BUSY); /* it is leaving */
    run(8 * BYTE_US);
    assert_int_equal(hold_low(), FATHOM_ERR_BUSY); /* the answer may come */
    assert_int_equal(bench.fake.breaks, 0);
    answer_1(111);
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

/* A module that is triggered by the break answers in frames that begin after a silence. */
TEST(the_end_of_a_break_does_not_hide_a_silence_from_the_listener)
{
    for (unsigned silent_us = 4900; silent_us <= 5000; silent_us += 100) {
        set_up(state);
        listen_for(5000);
        hold(true);
        run(silent_us);
        hold(false);
        assert_int_equal(ear.length, 0);
        deliver(answer_1_754, 7);
        assert_int_equal(ear.length, 7);
        assert_int_equal(ear.gaps, silent_us == 5000);
    }
}

/* Unit 1 still owes; of its late answer a part has come, right behind a byte of noise. */
TEST(the_end_of_a_break_is_no_gap_within_what_has_come)
{
    listen_for(500);
    ask_1_and_send(0);
    expect_after(TIMEOUT_US + 1000, FATHOM_ERR_NO_ANSWER);
    assert_int_equal(ear.length, 0);
    receive_hex("55 01 03 02");
    run(1000);
    assert_int_equal(bench.line.have, 3);
    assert_int_equal(ear.length, 1);
    assert_int_equal(ear.gaps, 1);
    hold(true);
    hold(false);
    run(GAP_US + 1000);
    assert_int_equal(ear.length, 4);
    assert_int_equal(ear.gaps, 1);
}

static int broken(void *ctx, bool on) { return (void)ctx, (void)on, -1; }

TEST(a_port_that_cannot_or_is_broken_says_so)
{
    bench.fake.uart.set_break = broken;
    assert_int_equal(hold_low(), FATHOM_ERR_PORT);
    bench.fake.uart.set_break = NULL;
    assert_int_equal(hold_low(), FATHOM_ERR_UNSUPPORTED);
    ask_1(0);
    expect_written_after(T3_5_US + 100, 1);
}
