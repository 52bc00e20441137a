/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

#include "fathom/engine/line_turns.h"

/* A program's own policy: the highest unit goes first, and unit 1 not before it is let go. */

static fathom_line_turns_t turns;
static bool holds_1;
static uint32_t start_us;

/* What the policy was told. */
enum { ASKED = 'a', ENDED = 'e' };
static struct {
    char what;
    uint8_t unit;
    uint32_t ms; /* from the start */
} calls[8];
static size_t call_count;

static void tell(char what, uint8_t unit, uint32_t at_us)
{
    assert_true(call_count != COUNT_OF(calls));
    calls[call_count].what = what;
    calls[call_count].unit = unit;
    calls[call_count++].ms = (at_us - start_us) / 1000;
}

/* The next thing that it was told. */
static size_t looked_at;
static void expect_call(char what, uint8_t unit, uint32_t ms)
{
    assert_true(looked_at != call_count);
    assert_int_equal(calls[looked_at].what, what);
    assert_int_equal(calls[looked_at].unit, unit);
    assert_int_equal(calls[looked_at++].ms, ms);
}

#define expect_no_more() assert_int_equal(looked_at, call_count)

static void asked(fathom_line_turns_t *policy, uint8_t unit, uint32_t at_us)
{
    assert_ptr_equal(policy, &turns);
    tell(ASKED, unit, at_us);
}

static void ended(fathom_line_turns_t *policy, uint8_t unit, uint32_t at_us)
{
    assert_ptr_equal(policy, &turns);
    tell(ENDED, unit, at_us);
}

static fathom_transaction_t *next(fathom_line_turns_t *policy, const fathom_line_t *line)
{
    fathom_transaction_t *best = NULL;
    policy->wait_us = line->quarantine_left_us;
    for (fathom_transaction_t *x = line->head; x != NULL; x = x->link.next)
        if (!fathom_line_is_quarantined(line, x->address) && (best == NULL || x->address > best->address))
            best = x;
    if (best == NULL || best->address != 1 || !holds_1) return best;
    policy->wait_us = 12345;
    return NULL;
}

static int begin(void **state)
{
    set_up(state);
    memset(&turns, 0x5A, sizeof turns);
    turns.next = next;
    turns.asked = asked;
    turns.ended = ended;
    fathom_line_take_turns(&bench.line, &turns);
    holds_1 = false;
    call_count = looked_at = 0;
    start_us = bench.fake.now_us;
    return 0;
}

static const suite_t suite = {.set_up = begin};

TEST(the_policy_says_who_goes_next_and_hears_who_asked_and_who_has_ended)
{
    ask_1(0);
    ask_other(9);
    run(REQUEST_US);
    expect_unit(0, 9);
    run(17900 - REQUEST_US);
    response_other(9, 222);
    run(REQUEST_US);
    expect_unit(1, 1);
    response_1(754);
    expect_call(ASKED, 1, 0);
    expect_call(ASKED, 9, 0);
    expect_call(ENDED, 9, 18);
    expect_call(ENDED, 1, 30); /* 3.6 ms of silence and 8.3 of request later */
    expect_no_more();
}

TEST(what_it_holds_back_is_due_when_it_says)
{
    holds_1 = true;
    ask_1(0);
    run(50000);
    expect_written(0);
    expect_due(12345);
    ask_other(9);
    expect_due(0);
    poll_line();
    expect_unit(0, 9);
    holds_1 = false;
    run(8 * BYTE_US);
    response_other(9, 222);
    run(REQUEST_US);
    expect_unit(1, 1);
}

TEST(an_attempt_that_ends_and_is_tried_again_has_ended_too)
{
    ask_1_and_send(1);
    run(TIMEOUT_US + 200);
    expect(FATHOM_PENDING);
    expect_call(ASKED, 1, 0);
    expect_call(ENDED, 1, 112);
    expect_no_more();
    expect_due(bench.line.quarantine_left_us);
    run(TIMEOUT_US + REQUEST_US);
    expect_written(2);
    break_port();
    expect(FATHOM_ERR_PORT);
    poll_line();
    expect_call(ENDED, 1, 225); /* where the port was seen to be broken: 112.5 and 112.4 ms */
    expect_no_more();
}

TEST(what_is_cancelled_on_the_wire_has_ended_and_what_only_waits_has_not)
{
    ask_1_and_send(0);
    ask_other(9);
    cancel(&bench.other);
    poll_line();
    expect_call(ASKED, 1, 0);
    expect_no_more();
    cancel(&bench.request);
    poll_line();
    expect_call(ENDED, 1, 12);
    expect_no_more();
}

TEST(a_request_that_is_cancelled_before_the_next_poll_has_been_on_the_wire)
{
    ask_1(0);
    bench.fake.now_us += T3_5_US;
    poll_line();
    expect_written(1);
    cancel(&bench.request);
    poll_line();
    expect_call(ASKED, 1, 0);
    expect_call(ENDED, 1, 3);
    expect_no_more();
}

/* Modulo 16 these are 14, 15 and 0. */
TEST(each_that_asks_is_told_once)
{
    fathom_modbus_request_t third;
    uint16_t value;
    memset(&third, 0, sizeof third);
    ask(&bench.request, 14, &bench.value, 0);
    ask_other(15);
    ask(&third, 16, &value, 0);
    run(T3_5_US + 1000);
    expect_call(ASKED, 14, 0);
    expect_call(ASKED, 15, 0);
    expect_call(ASKED, 16, 0);
    expect_no_more();
}

/* A transaction that the policy lets go waits for its silence; then the policy holds it back, for 12345 us. */
TEST(a_transaction_that_waited_for_silence_is_due_when_its_policy_or_busy_us_says_so)
{
    holds_1 = false;
    ask_1(0);
    run(100);
    holds_1 = true;
    expect_due(12345);
    bench.config.busy_us = 12000;
    cancel(&bench.request);
    holds_1 = false;
    ask_1(0);
    run(100);
    holds_1 = true;
    expect_due(12000);
}
