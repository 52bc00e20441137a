/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* A break that is over holds TX low for no longer than the port needs, and who waits for it is told. */

enum { FOR_EVER = -1 };

static int (*works)(void *ctx, bool on);
static int refusals; /* of the end of a break */
static int refusal;  /* what they say: 0 or < 0 */
static unsigned ends;

static int set_break(void *ctx, bool on)
{
    if (on) return works(ctx, on);
    ends++;
    if (refusals == 0) return works(ctx, on);
    if (refusals > 0) refusals--;
    return refusal;
}

static int set_up_refusing(void **state)
{
    (void)set_up(state);
    works = bench.fake.uart.set_break;
    bench.fake.uart.set_break = set_break;
    refusals = refusal = 0;
    ends = 0;
    return 0;
}

static const suite_t suite = {.set_up = set_up_refusing};

/* In a break for a second, with an exchange that waits. */
static void hold(void)
{
    assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_READY);
    ask(&bench.request, 1, &bench.value, 0);
    run_in_steps(1000000, 1000);
    assert_true(bench.fake.in_break);
    assert_int_equal(bench.fake.written, 0);
}

TEST(the_end_of_a_break_is_asked_for_until_the_port_takes_it)
{
    hold();
    refusals = 3;
    for (unsigned i = 0; i != 3; i++) {
        assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_PENDING);
        assert_true(bench.fake.in_break);
        run_in_steps(300000, 1000); /* nor does a poll send anything */
        assert_int_equal(bench.fake.written, 0);
        assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    }
    assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_READY);
    assert_false(bench.fake.in_break);
    assert_int_equal(fathom_line_due_us(&bench.line), T3_5_US);
    run(T3_5_US - 100);
    assert_int_equal(bench.fake.written, 0);
    run(200);
    assert_int_equal(bench.fake.written, 1);
    run(8 * BYTE_US);
    receive_answer(1, 111);
    run(100);
    assert_int_equal(bench.value, 111);
}

/* It need not be polled for that. */
TEST(a_break_that_the_port_does_not_end_in_a_second_is_an_error_and_who_waits_is_told)
{
    hold();
    refusals = FOR_EVER;
    assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_PENDING);
    for (unsigned second = 1; second <= 3; second++) {
        if (second == 2)
            run_in_steps(999999, 9009);
        else
            bench.fake.now_us += 999999;
        assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_PENDING); /* gives it no more time */
        assert_int_equal(counter(FATHOM_LINE_PORT_ERRORS), second - 1);
        assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
        bench.fake.now_us++;
        assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_ERR_PORT);
        assert_int_equal(counter(FATHOM_LINE_PORT_ERRORS), second);
        assert_int_equal(status_of(&bench.request), FATHOM_ERR_PORT);
        ask(&bench.request, 1, &bench.value, 0);
        assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_PENDING); /* for another second */
    }
    assert_true(bench.fake.in_break);
    assert_int_equal(bench.fake.written, 0);
    refusals = 0;
    assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_READY);
    run(T3_5_US + 200);
    assert_int_equal(bench.fake.written, 1);
}

TEST(a_port_that_is_broken_at_the_end_of_a_break_is_said_at_once)
{
    hold();
    refusals = 2;
    refusal = -1;
    for (unsigned i = 1; i <= 2; i++) {
        assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_ERR_PORT);
        assert_int_equal(counter(FATHOM_LINE_PORT_ERRORS), i);
        assert_int_equal(status_of(&bench.request), FATHOM_ERR_PORT);
        ask(&bench.request, 1, &bench.value, 0);
        run(T3_5_US + 200);
        assert_int_equal(bench.fake.written, 0);
    }
    assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_READY);
    run(T3_5_US + 200);
    assert_int_equal(bench.fake.written, 1);
}

TEST(a_break_that_begins_anew_gives_its_end_a_second_anew)
{
    hold();
    refusals = FOR_EVER;
    assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_PENDING);
    assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_READY);
    run_in_steps(2000000, 1000);
    assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_PENDING);
    run_in_steps(999900, 900);
    assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_PENDING);
    run(100);
    assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_ERR_PORT);
}

static int broken(void *ctx, bool on) { return (void)ctx, (void)on, -1; }

TEST(a_break_that_cannot_begin_once_more_goes_on_and_who_waits_goes_on_waiting)
{
    hold();
    bench.fake.uart.set_break = broken;
    assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_ERR_PORT);
    assert_int_equal(counter(FATHOM_LINE_PORT_ERRORS), 0);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    run(T3_5_US + 200);
    assert_int_equal(bench.fake.written, 0);
}

TEST(where_there_is_no_break_a_refused_end_changes_nothing)
{
    ask(&bench.request, 1, &bench.value, 0);
    for (refusal = 0; refusal >= -1; refusal--) {
        refusals = 1;
        assert_int_equal(fathom_line_break(&bench.line, false),
                         refusal == 0 ? FATHOM_PENDING : FATHOM_ERR_PORT);
    }
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    assert_int_equal(counter(FATHOM_LINE_PORT_ERRORS), 0);
    run(T3_5_US + 200);
    assert_int_equal(bench.fake.written, 1);
    assert_int_equal(ends, 2);
}

TEST(while_a_request_is_on_the_wire_no_break_has_to_end)
{
    ask(&bench.request, 1, &bench.value, 0);
    run(T3_5_US + 100);
    assert_int_equal(bench.fake.written, 1);
    assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_READY);
    assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_ERR_BUSY);
    assert_int_equal(ends, 0);
    run(8 * BYTE_US);
    receive_answer(1, 111);
    run(100);
    assert_int_equal(bench.value, 111);
}

/* A USB adapter may have failed for a moment, and holds TX low still. */
TEST(no_request_is_written_into_a_break_in_which_a_read_failed)
{
    hold();
    bench.fake.read_fails = true;
    bench.fake.now_us += 100;
    assert_int_equal(fathom_line_poll(&bench.line), FATHOM_ERR_PORT);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_PORT);
    bench.fake.read_fails = false;
    ask(&bench.request, 1, &bench.value, 0);
    run_in_steps(1000000, 1000);
    assert_true(bench.fake.in_break);
    assert_int_equal(bench.fake.written, 0);
    assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_READY);
    run(T3_5_US + 200);
    assert_int_equal(bench.fake.written, 1);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
}

/* The silence begins where the break ends, not where the poll before that was. */
TEST(after_a_break_the_silence_is_kept_in_a_slow_loop)
{
    hold();
    bench.fake.now_us += 20000;
    assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_READY);
    const uint32_t ended_us = bench.fake.now_us;
    assert_int_equal(fathom_line_due_us(&bench.line), T3_5_US);
    run(T3_5_US + 200);
    assert_int_equal(bench.fake.written, 1);
    assert_in_range(bench.fake.writes[0].at_us - ended_us, T3_5_US, T3_5_US + 100);
}
