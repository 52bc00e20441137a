/* SPDX-License-Identifier: MIT */
#include "line_conversation.h"

/* A break of the line: TX as the trigger or the mode select of a module. */

static fathom_status_t hold_low(void) { return fathom_line_break(&bench.line, true); }

static void hold(bool low) { assert_int_equal(fathom_line_break(&bench.line, low), FATHOM_OK); }

static const suite_t suite = {.set_up = set_up};

#define RESPONDS "01 03 02 02 F2 38 A1" /* 754 mm */

enum { FOR_EVER = -1 };

static void refuse(int times, int how)
{
    bench.fake.refusals = times;
    bench.fake.refusal = how;
}

#define REFUSES(times, how) STEP(refuses, .value = (times), .which = ((how) < 0)) /* 0: busy; -1: broken */
#define REFUSES_BEGIN       STEP(refuses_begin, .which = 0)
static void play_refuses(const step_t *step) { refuse((int)step->value, -(int)step->which); }
#define REFUSALS(left) STEP(refusals, .value = (left))
static void play_refusals(const step_t *step) { assert_int_equal(bench.fake.refusals, step->value); }
static void play_refuses_begin(const step_t *step) { bench.fake.refuses_begin = true; }

static const conversation_t conversations[] = {
    ROW("a_break_holds_tx_low_until_it_is_ended", COUNTS(0), HOLD(true), IN_BREAK(true), HOLD(true),
        WAIT(100000), IN_BREAK(true), HOLD(false), IN_BREAK(false)),
    ROW("nothing_is_sent_in_a_break_and_the_silence_is_kept_after_it", COUNTS(.responses = 1), WAIT(100000),
        HOLD(true), QUEUE(A, 1), WAIT(FATHOM_LINE_DEFAULT_BUSY_US - 1000), WRITTEN(0), PENDS(A), HOLD(false),
        DUE(T3_5_US), SENT(T3_5_US - 100, 200), WAIT(8 * BYTE_US), RESPONSE(1, 111), READS(A, 111)),
    /* it begins where the break ends, not where the poll before that was */
    ROW("after_a_break_the_silence_is_kept_in_a_slow_loop", COUNTS(0), HOLD(true), QUEUE(A, 1), PASS(20000),
        HOLD(false), DUE(T3_5_US), SENT(T3_5_US - 100, 200)),
    /* rule 3: a transaction waits for `busy_us`, from the poll after its request on, which is 100 us later */
    ROW("a_transaction_ends_unsent_if_the_break_lasts_too_long", COUNTS(.busy = 1), WAIT(100000), HOLD(true),
        QUEUE_TWICE(A, 1), DUE(0), WAIT(FATHOM_LINE_DEFAULT_BUSY_US - 1000), PENDS(A), DUE(1100), WAIT(1200),
        FAILS(A, LINE_BUSY), WRITTEN(0), IN_BREAK(true), DUE(FATHOM_NO_DEADLINE)),
    /* the request leaves, and then its response may come */
    ROW("with_a_transaction_on_the_wire_a_break_is_busy_and_nothing_changes", COUNTS(.responses = 1),
        QUEUE(A, 1), SENT(0, T3_5_US + 100), BREAK(true, FATHOM_ERR_BUSY), WAIT(8 * BYTE_US),
        BREAK(true, FATHOM_ERR_BUSY), IN_BREAK(false), RESPONSE(1, 111), READS(A, 111), HOLD(true),
        IN_BREAK(true)),
    ROW("while_bytes_of_the_port_leave_a_break_is_pending", COUNTS(0), NEVER_SENT(true),
        BREAK(true, FATHOM_PENDING), IN_BREAK(false), QUEUE(A, 1), SENT(0, T3_5_US + 100)),
    /* after the break the port has the whole time again to accept the request */
    ROW("a_request_that_the_port_refused_waits_for_the_end_of_the_break", COUNTS(0), PORT_REFUSES(true),
        QUEUE(A, 1), WAIT(T3_5_US + 900000), HOLD(true), WAIT(500000), HOLD(false), WAIT(T3_5_US + 500000),
        PENDS(A), PORT_REFUSES(false), SENT(0, 1000)),
    /* a sensor that is triggered by the break responds in frames that begin after a silence */
    ROW("the_end_of_a_break_does_not_hide_a_silence_from_the_listener", COUNTS(0), LISTEN(5000), HOLD(true),
        WAIT(5000), HOLD(false), HEARD("", 0), RECEIVE(RESPONDS), HEARD(RESPONDS, 1)),
    ROW("the_end_of_a_break_is_no_silence_for_the_listener", COUNTS(0), LISTEN(5000), HOLD(true), WAIT(4900),
        HOLD(false), HEARD("", 0), RECEIVE(RESPONDS), HEARD(RESPONDS, 0)),
    /* unit 1 is still quarantined; of its late response a part has come, right behind a byte of noise */
    ROW("the_end_of_a_break_is_no_gap_within_what_has_come", COUNTS(.no_responses = 1), LISTEN(500),
        ASK(A, 1), WAIT(TIMEOUT_US + 1000), FAILS(A, NO_RESPONSE), HEARD("", 0), ARRIVE("55 01 03 02"),
        WAIT(1000), HEARD("55", 1), HOLD(true), HOLD(false), WAIT(GAP_US + 1000), HEARD("55 01 03 02", 1)),
    /* the port has FATHOM_LINE_SEND_US to release TX */
    ROW("a_line_whose_port_does_not_release_tx_is_due_when_the_port_counts_as_broken", COUNTS(0),
        WAIT(100000), HOLD(true), QUEUE(A, 1), REFUSES(FOR_EVER, 0), BREAK(false, FATHOM_PENDING),
        DUE(FATHOM_LINE_SEND_US)),
    ROW("a_break_that_cannot_begin_once_more_goes_on_and_what_waits_goes_on_waiting", COUNTS(0), HOLD(true),
        QUEUE(A, 1), REFUSES_BEGIN, REFUSES(1, -1), BREAK(true, FATHOM_ERR_PORT), COUNT(PORT_ERRORS, 0),
        WAIT(T3_5_US + 200), WRITTEN(0), PENDS(A)),
    /* with a request on the wire the port is not even asked */
    ROW("where_there_is_no_break_a_refused_end_changes_nothing", COUNTS(0), QUEUE(A, 1), REFUSES(1, 0),
        BREAK(false, FATHOM_PENDING), REFUSES(1, -1), BREAK(false, FATHOM_ERR_PORT), SENT(0, T3_5_US + 200),
        REFUSES(1, -1), HOLD(false), REFUSALS(1)),
    ROW("a_break_that_begins_anew_gives_its_end_a_second_anew", COUNTS(.port_errors = 1), HOLD(true),
        REFUSES(FOR_EVER, 0), BREAK(false, FATHOM_PENDING), HOLD(true), WAIT(2000000),
        BREAK(false, FATHOM_PENDING), PASS(999999), BREAK(false, FATHOM_PENDING), PASS(1),
        BREAK(false, FATHOM_ERR_PORT)),
};
CONVERSATIONS(set_up, conversations)

/* ---- a port that refuses ---- */

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
