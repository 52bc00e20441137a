/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line_turns.h"
#include "line_conversation.h"

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
static size_t looked_at;

static void tell(char what, uint8_t unit, uint32_t at_us)
{
    assert_true(call_count != COUNT_OF(calls));
    calls[call_count].what = what;
    calls[call_count].unit = unit;
    calls[call_count++].ms = (at_us - start_us) / 1000;
}

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

/* The next thing that the policy was told; and there was nothing else. */
#define CALLED(what, id, at_ms) STEP(called, .which = (what), .unit = (id), .us = (at_ms))
#define NO_MORE                 STEP(no_more, .which = 0)
#define HOLDS_1(on)             STEP(holds_1, .which = (on))
#define DUE_AFTER_QUARANTINE    STEP(due_after_quarantine, .which = 0)

static void play_called(const step_t *step)
{
    assert_true(looked_at != call_count);
    assert_int_equal(calls[looked_at].what, step->which);
    assert_int_equal(calls[looked_at].unit, step->unit);
    assert_int_equal(calls[looked_at++].ms, step->us);
}

static void play_no_more(const step_t *step) { assert_int_equal(looked_at, call_count); }
static void play_holds_1(const step_t *step) { holds_1 = step->which != 0; }
static void play_due_after_quarantine(const step_t *step) { expect_due(bench.line.quarantine_left_us); }

static const conversation_t conversations[] = {
    /* 3.6 ms of silence and 8.3 of request lie between 18 and 30 ms */
    ROW("the_policy_says_who_goes_next_and_hears_who_asked_and_who_has_ended", COUNTS(.responses = 2),
        QUEUE(A, 1), QUEUE(B, 9), WAIT(REQUEST_US), REQUEST_TO(0, 9), WAIT(17900 - REQUEST_US),
        RESPONSE(9, 222), READS(B, 222), WAIT(REQUEST_US), REQUEST_TO(1, 1), RESPONSE(1, 754), READS(A, 754),
        CALLED(ASKED, 1, 0), CALLED(ASKED, 9, 0), CALLED(ENDED, 9, 18), CALLED(ENDED, 1, 30), NO_MORE),
    ROW("what_it_holds_back_is_due_when_it_says", COUNTS(.responses = 1), HOLDS_1(true), QUEUE(A, 1),
        WAIT(50000), WRITTEN(0), DUE(12345), QUEUE(B, 9), DUE(0), POLL, REQUEST_TO(0, 9), HOLDS_1(false),
        WAIT(8 * BYTE_US), RESPONSE(9, 222), READS(B, 222), WAIT(REQUEST_US), REQUEST_TO(1, 1)),
    /* the port was seen to be broken after 112.5 and 112.4 ms */
    ROW("an_attempt_that_ends_and_is_tried_again_has_ended_too", COUNTS(.no_responses = 1, .port_errors = 1),
        ASK_TWICE(A, 1), WAIT(TIMEOUT_US + 200), PENDS(A), CALLED(ASKED, 1, 0), CALLED(ENDED, 1, 112),
        NO_MORE, DUE_AFTER_QUARANTINE, WAIT(TIMEOUT_US + REQUEST_US), WRITTEN(2), BREAK_PORT, FAILS(A, PORT),
        POLL, CALLED(ENDED, 1, 225), NO_MORE),
    ROW("what_is_cancelled_on_the_wire_has_ended_and_what_only_waits_has_not", COUNTS(0), ASK(A, 1),
        QUEUE(B, 9), CANCEL(B), POLL, CALLED(ASKED, 1, 0), NO_MORE, CANCEL(A), POLL, CALLED(ENDED, 1, 12),
        NO_MORE),
    ROW("a_request_that_is_cancelled_before_the_next_poll_has_been_on_the_wire", COUNTS(0), QUEUE(A, 1),
        PASS(T3_5_US), POLL, WRITTEN(1), CANCEL(A), POLL, CALLED(ASKED, 1, 0), CALLED(ENDED, 1, 3), NO_MORE),
    /* the policy lets it go, and it waits for its silence; then the policy holds it back, for 12345 us */
    ROW("a_transaction_that_waited_for_silence_is_due_when_its_policy_or_busy_us_says_so", COUNTS(0),
        QUEUE(A, 1), WAIT(100), HOLDS_1(true), DUE(12345), BUSY_US(12000), CANCEL(A), HOLDS_1(false),
        QUEUE(A, 1), WAIT(100), HOLDS_1(true), DUE(12000)),
    /* 20 ms of noise, of which the policy holds it back in the middle */
    ROW("after_it_was_held_back_a_transaction_waits_anew_for_silence", COUNTS(.dropped = 49), BUSY_US(20000),
        QUEUE(A, 1), JAM(15000), HOLDS_1(true), JAM(10000), HOLDS_1(false), JAM(18000), WRITTEN(0), JAM(6000),
        WRITTEN(1)),
    /* the port has FATHOM_LINE_SEND_US, a second, to accept a request; the second begins anew with the second try */
    ROW("what_is_held_back_while_the_port_refuses_is_due_when_the_policy_says", COUNTS(.responses = 1),
        PORT_REFUSES(true), QUEUE(A, 1), WAIT(600000), DUE(1000), HOLDS_1(true), POLL, DUE(12345),
        WAIT(600000), HOLDS_1(false), WAIT(600000), PENDS(A), PORT_REFUSES(false), WAIT(REQUEST_US),
        REQUEST_TO(0, 1), RESPONSE(1, 754), READS(A, 754)),
};
CONVERSATIONS(begin, conversations)

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
    for (uint8_t unit = 14; unit <= 16; unit++) play_called(&(step_t){.which = ASKED, .unit = unit});
    assert_int_equal(looked_at, call_count);
}
