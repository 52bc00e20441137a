/* SPDX-License-Identifier: MIT */
#include "line_conversation.h"

/* Line settings of a transaction: an A16 with 9600 8N1 and an HPS-167S with 19200 8E1 on one pair of wires. */

static const fathom_line_settings_t settings[] = {{9600, FATHOM_PARITY_NONE, 1},
                                                  {19200, FATHOM_PARITY_EVEN, 1}};
enum { N9600, E19200, NO_SETTINGS };

static const fathom_line_settings_t *settings_of(int32_t which)
{
    return which == NO_SETTINGS ? NULL : &settings[which];
}

static void assert_set_to(const fathom_line_settings_t *wanted)
{
    assert_int_equal(bench.fake.settings.baud, wanted->baud);
    assert_int_equal(bench.fake.settings.parity, wanted->parity);
    assert_int_equal(bench.fake.settings.stop_bits, wanted->stop_bits);
}

/* ---- steps ---- */

/* A read at these settings. */
#define QUEUE_AT(x, to, at) STEP(queue_at, .which = (x), .unit = (to), .us = TIMEOUT_US, .value = (at))
/* The n-th request, from 0 on, was to this unit at these settings, which the port still has. */
#define WRITTEN_AT(n, to, at) STEP(written_at, .value = (n), .unit = (to), .which = (at))
#define PARTS_HAVE(at)        STEP(parts_have, .value = (at))
#define CANNOT(baud)          STEP(cannot, .us = (baud))
#define FIXED                 STEP(fixed, .which = 0)
#define NOT_SET_YET           STEP(not_set_yet, .which = 0)

static void play_queue_at(const step_t *step)
{
    step_t queue = *step;
    queue.value = 0;
    request_of(step)->transaction.line_settings = settings_of(step->value);
    play_queue(&queue);
}

static void play_written_at(const step_t *step)
{
    expect_written(step->value + 1);
    expect_unit(step->value, step->unit);
    assert_int_equal(bench.fake.writes[step->value].baud, settings[step->which].baud);
    assert_set_to(&settings[step->which]);
}

static void play_parts_have(const step_t *step) { bench.config.line_settings = settings_of(step->value); }
static void play_cannot(const step_t *step) { bench.fake.unsupported_baud = step->us; }
static void play_fixed(const step_t *step) { bench.fake.uart.set_line = NULL; }
static void play_not_set_yet(const step_t *step) { assert_int_equal(bench.fake.set_lines, 0); }

static const suite_t suite = {.set_up = set_up};

static const conversation_t conversations[] = {
    /* until then bytes arrive at the settings before */
    ROW("settings_hold_before_the_request_is_written", COUNTS(.responses = 1), QUEUE_AT(A, 1, E19200),
        WAIT(T3_5_US - 200), NOT_SET_YET, WAIT(400), WRITTEN_AT(0, 1, E19200), RESPONSE(1, 111),
        READS(A, 111)),
    ROW("a_port_that_never_changes_is_broken_after_a_second", COUNTS(.port_errors = 1), NEVER_SENT(true),
        QUEUE_AT(A, 1, E19200), WAIT(FATHOM_LINE_SEND_US), PENDS(A), WAIT(T3_5_US + 1000), FAILS(A, PORT),
        WRITTEN(0)),
    ROW("settings_that_the_port_cannot_do_end_that_transaction_alone", COUNTS(.responses = 1), CANNOT(19200),
        QUEUE_AT(A, 1, E19200), QUEUE_AT(B, 2, N9600), WAIT(REQUEST_US + 200), FAILS(A, UNSUPPORTED),
        ATTEMPTS(A, 0), WRITTEN(1), REQUEST_TO(0, 2), RESPONSE(2, 222), READS(B, 222)),
    /* the line is not broken by that: its poll returns FATHOM_PENDING */
    ROW("settings_on_a_port_whose_settings_are_fixed_are_unsupported", COUNTS(.responses = 1), FIXED,
        QUEUE_AT(A, 1, N9600), QUEUE_AT(B, 2, NO_SETTINGS), WAIT(T3_5_US - 400), PASS(1000), POLL,
        FAILS(A, UNSUPPORTED), WAIT(REQUEST_US + 200), WRITTEN(1), RESPONSE(2, 222), READS(B, 222)),
    ROW("settings_that_turn_out_unsupported_after_a_busy_port_end_the_transaction", COUNTS(0),
        NEVER_SENT(true), QUEUE_AT(A, 1, E19200), WAIT(20000), NEVER_SENT(false), CANNOT(19200), WAIT(100),
        FAILS(A, UNSUPPORTED), DUE(FATHOM_NO_DEADLINE)),
    ROW("a_transaction_that_waits_for_its_settings_can_be_cancelled_and_quarantines_none", COUNTS(0),
        NEVER_SENT(true), QUEUE_AT(A, 1, E19200), WAIT(20000), CANCEL(A), NEVER_SENT(false),
        QUEUE_AT(A, 1, N9600), WAIT(100), WRITTEN_AT(0, 1, N9600)),
    /* An A16 beside an HPS-167S on a bus that was opened for the latter, by 19200 baud: 38.5 bits are 2005.2 us there,
     * and 4010.4 us at 9600 baud, which the A16 needs to see where its request begins. Also before the faster one: the
     * A16 hears the end of its own frame by it */
    ROW("the_silence_is_that_of_the_slowest_settings_that_were_named", COUNTS(.responses = 2), SILENCE(2006),
        QUEUE_AT(B, 2, E19200), SENT(1900, 200), WAIT(8 * BYTE_US), RESPONSE(2, 222), READS(B, 222),
        QUEUE_AT(A, 1, N9600), SENT(3900, 300), WRITTEN_AT(1, 1, N9600), WAIT(8 * BYTE_US), RESPONSE(1, 111),
        READS(A, 111), QUEUE_AT(B, 2, E19200), SENT(3900, 300), WRITTEN_AT(2, 2, E19200)),
    ROW("a_transaction_without_settings_gets_those_of_the_parts", COUNTS(.responses = 1), PARTS_HAVE(N9600),
        QUEUE_AT(B, 2, E19200), WAIT(REQUEST_US), WRITTEN_AT(0, 2, E19200), RESPONSE(2, 222), READS(B, 222),
        QUEUE_AT(A, 1, NO_SETTINGS), WAIT(REQUEST_US + 400), WRITTEN_AT(1, 1, N9600)),
    ROW("a_longer_silence_of_the_parts_is_kept", COUNTS(0), SILENCE(6000), QUEUE_AT(A, 1, N9600),
        SENT(5800, 400), WRITTEN_AT(0, 1, N9600)),
};
CONVERSATIONS(set_up, conversations)

static void queue_at(uint8_t which, uint8_t unit, uint8_t at)
{
    play_queue_at(&(step_t){.which = which, .unit = unit, .us = TIMEOUT_US, .value = at});
}

static void expect_written_at(int32_t n, uint8_t unit, uint8_t at)
{
    play_written_at(&(step_t){.value = n, .unit = unit, .which = at});
}

TEST(two_sensors_with_their_own_settings_share_a_line)
{
    for (int32_t round = 0; round != 5; round++) {
        queue_at(A, 1, N9600);
        queue_at(B, 2, E19200);
        run(REQUEST_US);
        expect_written_at(2 * round, 1, N9600);
        receive_response(1, (uint16_t)(100 + round));
        run(T3_5_US - 300); /* the silence is kept before the other settings too */
        expect_mm((uint16_t)(100 + round));
        assert_set_to(&settings[N9600]);
        run(8 * BYTE_US + 800);
        expect_written_at(2 * round + 1, 2, E19200);
        response_other(2, (uint16_t)(200 + round));
    }
}

/* hal.h: 0 means that bytes are still leaving. */
TEST(a_port_that_cannot_change_yet_is_asked_again)
{
    bench.fake.never_sent = true;
    queue_at(A, 1, E19200);
    run(50000);
    assert_true(bench.fake.set_lines > 1);
    expect_written(0);
    expect(FATHOM_PENDING);
    assert_true(due() <= 1000);
    bench.fake.never_sent = false;
    run(8 * BYTE_US + 400);
    expect_written_at(0, 1, E19200);
    response_1(111);
}

/* silence.h: 38.5 / 9600 is 4010.4 us, 38.5 / 19200 is 2005.2; slower rates have none. */
TEST(the_silence_of_settings_is_that_of_9600_or_19200_baud)
{
    static const struct {
        uint32_t baud;
        uint16_t us;
    } rows[] = {{4800, 65535}, {9599, 65535}, {9600, 4011}, {19199, 4011}, {19200, 2006}, {115200, 2006}};
    for (unsigned i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        const fathom_line_settings_t of = {rows[i].baud, FATHOM_PARITY_NONE, 1};
        assert_int_equal(fathom_silence_us(&of), rows[i].us);
    }
}
