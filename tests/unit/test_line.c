/* SPDX-License-Identifier: MIT */
#include "line_conversation.h"

static fathom_status_t init(void) { return fathom_line_init(&bench.line, &bench.config); }

static void set_clock(uint32_t now_us)
{
    bench.fake.now_us = now_us;
    bench.fake.busy_until_us = now_us;
    assert_int_equal(init(), FATHOM_OK);
}

static const suite_t suite = {.set_up = set_up};
static const suite_t asked = {.set_up = set_up_asked};
static const suite_t quarantined = {.set_up = set_up_quarantined};

/* ---- setting up ---- */

/* Unit 16 is the unit whose bit is the lowest. No unit is quarantined, so each request is due after the silence, before
 * any poll too. */
TEST(a_new_line_knows_of_nothing_whatever_its_memory_held)
{
    static const uint8_t fills[] = {0, 0xA5, 0xFF};
    static const uint8_t units[] = {1, 15, 16};
    for (size_t i = 0; i != sizeof fills * sizeof units; i++) {
        set_up(state);
        bench.config.echo = FATHOM_LINE_ECHO_AUTO;
        memset(&bench.line, fills[i % sizeof fills], sizeof bench.line);
        assert_int_equal(init(), FATHOM_OK);
        for (unsigned c = 0; c != FATHOM_LINE_COUNTERS; c++) assert_int_equal(counter(c), 0);
        assert_true(fathom_line_is_idle(&bench.line));
        assert_false(fathom_line_is_queued(&bench.line, &bench.request.transaction));
        assert_int_equal(fathom_line_get_echo(&bench.line), FATHOM_LINE_ECHO_AUTO);
        assert_int_equal(fathom_line_last_byte_us(&bench.line), bench.fake.now_us);
        expect_due(FATHOM_NO_DEADLINE);
        ask(&bench.request, units[i / sizeof fills], &bench.value, 0);
        expect_due(T3_5_US);
        run_in_steps(T3_5_US - 1, T3_5_US - 1);
        expect_written(0);
        run_in_steps(1, 1);
        expect_written(1);
    }
}

TEST(t3_5_is_three_and_a_half_characters_up_to_19200_baud_and_1750_us_above)
{
    assert_int_equal(FATHOM_T3_5_US(9600, 10), 3646);  /* 35 bits / 9600 = 3645.8 us */
    assert_int_equal(FATHOM_T3_5_US(19200, 11), 2006); /* 38.5 / 19200 = 2005.2 */
    assert_int_equal(FATHOM_T3_5_US(57600, 11), 1750);
    assert_int_equal(FATHOM_T3_5_US(230400, 11), 1750);
}

TEST(zero_in_the_config_means_the_default_gap)
{
    bench.config.gap_us = 0;
    ask_1_and_send(0);
    receive(response_1_754, 4);
    run_in_steps(4990, 10);
    assert_int_equal(bench.line.received_count, 4); /* the gap has not passed yet */
    run_in_steps(30, 10);
    expect(FATHOM_ERR_CHECKSUM);
}

/* ---- asking, cancelling, idle ---- */

#define REFUSED(x, status) STEP(refused, .which = (x), .value = (status)) /* it is not submitted */
#define LEAVES             STEP(leaves, .which = 0)
static void play_refused(const step_t *step)
{
    assert_int_equal(fathom_modbus_client_submit(&bench.line, request_of(step)), step->value);
}

/* Until the port has the request, and no poll more. */
static void play_leaves(const step_t *step)
{
    while (bench.fake.written == 0) run(100);
}

#define HAS_LEFT STEP(has_left, .which = 0)
static void play_has_left(const step_t *step) { bench.fake.busy_until_us = bench.fake.now_us; }

#define REQUEST_1 STEP(request_1, .which = 0)
static void play_request_1(const step_t *step) { expect_bytes(0, ask_1_processed, sizeof ask_1_processed); }

static const conversation_t conversations[] = {
    /* T3_5_US is 3646 */
    ROW("a_request_is_sent_after_the_silence_and_not_before", COUNTS(0), QUEUE(A, 1), POLL_AFTER(T3_5_US - 1),
        WRITTEN(0), POLL_AFTER(1), WRITTEN(1), REQUEST_1),
    ROW("the_response_is_ready_in_the_poll_that_brings_its_last_byte", COUNTS(.responses = 1), ASK(A, 1),
        ARRIVE("01 03 02 02 F2 38 A1"), PENDS(A), POLL, READS(A, 754)),
    ROW("a_transaction_may_be_submitted_again_when_it_has_ended_and_not_before", COUNTS(.responses = 2),
        ASK(A, 1), REFUSED(A, FATHOM_ERR_BUSY), RESPONSE(1, 111), READS(A, 111), QUEUE(A, 1), WAIT(20000),
        WRITTEN(2), RESPONSE(1, 112), READS(A, 112)),
    /* the poll that finds the port broken is the first after the request was handed over */
    ROW("a_silence_comes_before_the_next_request_where_the_port_broke_while_one_left",
        COUNTS(.port_errors = 1), QUEUE(A, 1), LEAVES, BREAK_PORT, FAILS(A, PORT), HAS_LEFT, QUEUE(B, 2),
        SENT(T3_5_US - 400, 1000)),
    /* 1000: the request leaves; GAP_US: the rest of the frame, or its end; then the unit is quarantined */
    ROW("due_says_when_something_can_happen_without_new_bytes", COUNTS(.damaged = 1, .dropped = 4), POLL,
        DUE(FATHOM_NO_DEADLINE), QUEUE(A, 1), DUE(T3_5_US), PASS(646), DUE(3000), POLL_AFTER(3000),
        WRITTEN(1), DUE(1000), POLL_AFTER(9000), DUE(TIMEOUT_US), ARRIVE("01 03 02 02"), POLL, DUE(GAP_US),
        POLL_AFTER(GAP_US), FAILS(A, CHECKSUM), DUE(FATHOM_NO_DEADLINE)),
    ROW("a_request_to_a_quarantined_unit_is_due_when_the_quarantine_ends", COUNTS(.damaged = 1, .dropped = 4),
        QUEUE(A, 1), POLL_AFTER(T3_5_US), POLL_AFTER(9000), ARRIVE("01 03 02 02"), POLL, POLL_AFTER(GAP_US),
        FAILS(A, CHECKSUM), QUEUE(A, 1), DUE(2 * TIMEOUT_US - GAP_US), PASS(2 * TIMEOUT_US), DUE(0)),
    ROW("a_write_is_acknowledged_by_its_own_words", COUNTS(.responses = 1), WRITE(A, 1), WAIT(20000),
        RECEIVE("01 06 02 00 00 05 48 71"), ENDS(A, FATHOM_OK)),
    ROW("transactions_are_served_first_come_first_served", COUNTS(.responses = 2), QUEUE(A, 1), QUEUE(B, 2),
        WAIT(T3_5_US + 9 * BYTE_US), REQUEST_TO(0, 1), RESPONSE(1, 111), WAIT(T3_5_US + 9 * BYTE_US),
        REQUEST_TO(1, 2), RESPONSE(2, 222), READS(B, 222), READS(A, 111)),
    ROW("received_bytes_put_the_silence_off", COUNTS(.dropped = 1), QUEUE(A, 1), WAIT(3000), RECEIVE("01"),
        POLL_AFTER(T3_5_US - 1), WRITTEN(0), POLL_AFTER(1), WRITTEN(1)),
    ROW("a_response_that_began_in_time_may_end_after_the_time_out", COUNTS(.responses = 1), ASK(A, 1),
        WAIT(TIMEOUT_US - 2000), SEND("01 03 02 02 F2 38 A1"), READS(A, 754)),
    ROW("a_late_poll_finds_the_response_before_it_looks_at_the_time", COUNTS(.responses = 1), ASK(A, 1),
        ARRIVE("01 03 02 02 F2 38 A1"), POLL_AFTER(3 * TIMEOUT_US), READS(A, 754)),
    /* up to 400 us have passed since the last bit */
    ROW("no_response_is_said_when_the_time_out_has_passed_since_the_request_left", COUNTS(.no_responses = 1),
        ASK(A, 1), WAIT(TIMEOUT_US - 500), PENDS(A), WAIT(700), FAILS(A, NO_RESPONSE)),
    ROW("a_broadcast_is_ready_after_its_turn_round_and_expects_no_response", COUNTS(0),
        WRITE(A, FATHOM_MODBUS_BROADCAST), QUEUE(B, 2), SENT(0, REQUEST_US - 200), WAIT(TIMEOUT_US - 1000),
        ENDS(A, FATHOM_PENDING), WRITTEN(1), WAIT(2000), ENDS(A, FATHOM_OK), WRITTEN(2)),
    /* modulo 16 the same unit; one that responds to the broadcast all the same is not heard */
    ROW("a_request_to_all_quarantines_none", COUNTS(.dropped = 7, .strays = 1),
        WRITE(A, FATHOM_MODBUS_BROADCAST), WAIT(REQUEST_US), QUEUE(B, 16), RESPONSE(3, 333),
        WAIT(TIMEOUT_US - 1100), ENDS(A, FATHOM_PENDING), WRITTEN(1), WAIT(1500), ENDS(A, FATHOM_OK),
        WRITTEN(2)),
    ROW("a_cancelled_broadcast_quarantines_none", COUNTS(0), WRITE(A, FATHOM_MODBUS_BROADCAST),
        WAIT(REQUEST_US), CANCEL(A), QUEUE(B, 16), SENT(0, T3_5_US + 400)),

    ROW("a_transaction_cancelled_before_it_is_sent_is_never_sent", COUNTS(0), QUEUE(A, 1), QUEUE(B, 2),
        CANCEL(A), SENT(0, 20000), REQUEST_TO(0, 2)),
    ROW("a_transaction_cancelled_before_it_is_sent_quarantines_none", COUNTS(0), QUEUE(A, 1), CANCEL(A),
        QUEUE(B, 1), SENT(0, T3_5_US + 400)),
    /* the one that waits was never asked, and the other one has answered: no unit is in quarantine */
    ROW("one_that_waits_can_be_cancelled_without_harm_to_the_one_on_the_wire", COUNTS(.responses = 2),
        ASK(A, 1), QUEUE(B, 2), CANCEL(B), PENDS(A), RESPONSE(1, 754), READS(A, 754), QUEUE(B, 2),
        SENT(0, T3_5_US + 200), WAIT(8 * BYTE_US + 200), RESPONSE(2, 222), READS(B, 222), QUEUE(A, 1),
        SENT(0, T3_5_US + 300)),
    /* "when twice the time-out has passed since the request left": its eight bytes have to leave first */
    ROW("a_transaction_cancelled_while_it_leaves_quarantines_as_long_as_any_other", COUNTS(0), QUEUE(A, 1),
        SENT(0, T3_5_US + 200), CANCEL(A), QUEUE(B, 1), SENT(8 * BYTE_US + 2 * TIMEOUT_US - 1000, 2000)),
    /* the line keeps the silence from the last bit of the request that was cancelled */
    ROW("the_next_request_waits_until_a_cancelled_one_has_left_and_a_silence_more", COUNTS(0), QUEUE(A, 1),
        SENT(0, T3_5_US + 200), CANCEL(A), IDLE(false), QUEUE(B, 2), SENT(8 * BYTE_US + T3_5_US - 400, 1000)),
    ROW("a_port_has_a_whole_second_to_send_a_request", COUNTS(.port_errors = 1), NEVER_SENT(true),
        QUEUE(A, 1), POLL_AFTER(T3_5_US), WRITTEN(1), POLL_AFTER(FATHOM_LINE_SEND_US - 1), PENDS(A),
        POLL_AFTER(1), FAILS(A, PORT)),
    ROW("a_cancelled_request_that_never_leaves_breaks_the_port_after_a_second", COUNTS(.port_errors = 13),
        /* each poll finds the port broken until it sends */ NEVER_SENT(true), QUEUE(A, 1),
        SENT(0, T3_5_US + 200), CANCEL(A), QUEUE(B, 2), WAIT(FATHOM_LINE_SEND_US - 1000), PENDS(B), DUE(1000),
        WAIT(2000), FAILS(B, PORT), NEVER_SENT(false), WAIT(100), QUEUE(B, 2), SENT(0, T3_5_US + 400)),
    ROW("a_request_that_the_port_has_not_taken_quarantines_none_when_cancelled", COUNTS(0),
        PORT_REFUSES(true), QUEUE(A, 1), WAIT(10000), CANCEL(A), PORT_REFUSES(false), QUEUE(B, 1),
        SENT(0, T3_5_US + 200)),

    /* fathom_line_is_idle(), for what shares a pin with the line; a silence before a request leaves it idle */
    ROW("a_new_line_and_one_with_a_waiting_request_are_idle", COUNTS(0), IDLE(true), QUEUE(A, 1), IDLE(true),
        WAIT(1000), IDLE(true), WAIT(10000), IDLE(false)),
    ROW("a_line_is_busy_from_the_request_to_the_response", COUNTS(.responses = 1), WAIT(10000), QUEUE(A, 1),
        SENT(0, 100), IDLE(false), WAIT(50000), IDLE(false), RECEIVE("01 03 02 02 F2 38"), IDLE(false),
        RECEIVE("A1"), READS(A, 754), IDLE(true)),
    ROW("a_port_that_takes_no_request_leaves_the_line_idle", COUNTS(0), PORT_REFUSES(true), WAIT(10000),
        QUEUE(A, 1), WAIT(5000), IDLE(true), PORT_REFUSES(false), WAIT(100), IDLE(false)),
    ROW("a_quarantined_unit_keeps_the_line_busy_only_while_its_late_response_arrives",
        COUNTS(.no_responses = 1, .late = 1, .dropped = 7), ASK(A, 1), WAIT(TIMEOUT_US + 1000),
        FAILS(A, NO_RESPONSE), IDLE(true), QUEUE(A, 1), WAIT(50000), WRITTEN(1), IDLE(true),
        RECEIVE("01 03 02"), IDLE(false), RECEIVE("02 F2 38 A1"), IDLE(true)),
};
CONVERSATIONS(set_up, conversations)

TEST(every_cut_of_a_response_into_two_reads_is_put_together)
{
    for (size_t cut = 1; cut != sizeof response_1_754; cut++) {
        set_up_asked(state);
        receive(response_1_754, cut);
        receive(response_1_754 + cut, sizeof response_1_754 - cut);
        poll_line();
        expect_mm(754);
    }
}

TEST(a_loop_of_20_ms_reads_a_response_that_is_spread_over_its_rounds)
{
    for (uint32_t start_us = 0; start_us < 40000; start_us += 700) {
        set_up(state);
        bench.config.gap_us = 5000; /* far less than the loop takes */
        ask_1(0);
        run_in_steps(60000, 20000);
        expect_written(1);
        fake_trickle(&bench.fake, start_us, BYTE_US, response_1_754, sizeof response_1_754);
        run_in_steps(80000, 20000);
        expect_mm(754);
    }
}

TEST(an_exception_ends_the_transaction_and_keeps_its_number)
{
    ask_1_and_send(3);
    deliver_all(exception_1_2);
    expect(FATHOM_ERR_EXCEPTION);
    assert_int_equal(bench.request.message.exception, 2);
    assert_int_equal(bench.value, 0xDEAD);
    expect_count(FATHOM_LINE_EXCEPTIONS, 1);
}

/* ---- time ---- */

TEST(a_flood_of_noise_does_not_keep_a_transaction_for_ever)
{
    static const uint8_t noise[] = {0x01, 0x03, 0x02, 0x11, 0x22, 0x33, 0x44, 0x99};
    uint32_t waited_us = 0;
    ask_1_and_send(0);
    while (status_of(&bench.request) == FATHOM_PENDING && waited_us < 10 * TIMEOUT_US) {
        receive(noise + waited_us / BYTE_US % sizeof noise, 1);
        run_in_steps(BYTE_US, BYTE_US);
        waited_us += BYTE_US;
    }
    expect(FATHOM_ERR_CHECKSUM);
    assert_true(waited_us < TIMEOUT_US + 20 * BYTE_US);
}

TEST(a_request_goes_out_and_a_response_comes_in_across_the_wrap_of_the_clock)
{
    for (uint32_t before_us = 0; before_us < 140000; before_us += 1700) {
        set_up(state);
        set_clock(0u - before_us);
        ask_1_and_send(0);
        run(20000);
        response_1(754);
        ask_other(2);
        run(T3_5_US + 8 * BYTE_US + TIMEOUT_US - 500);
        expect_other(FATHOM_PENDING);
        run(1000);
        expect_other(FATHOM_ERR_NO_RESPONSE);
    }
}

TEST(a_single_poll_across_the_wrap_sees_all_the_time_that_passed)
{
    set_clock((uint32_t)0 - 20000);
    ask_1_and_send(0);
    assert_true(bench.fake.now_us > 0x80000000u);
    run_in_steps(TIMEOUT_US, TIMEOUT_US);
    assert_true(bench.fake.now_us < 0x80000000u);
    expect(FATHOM_ERR_NO_RESPONSE);
}

/* ---- cancel ---- */

TEST(cancelling_what_is_not_queued_does_nothing)
{
    bench.request.transaction.status = FATHOM_OK;
    cancel(&bench.request);
    expect(FATHOM_OK);
    ask_1(0);
    cancel(&bench.request);
    cancel(&bench.request);
    expect(FATHOM_ERR_CANCELLED);
}

TEST_IN(asked, a_transaction_cancelled_in_flight_leaves_a_response_that_is_not_taken)
{
    cancel(&bench.request);
    expect(FATHOM_ERR_CANCELLED);
    memset(&bench.request, 0xA5, sizeof bench.request); /* the memory is the caller's again */
    ask_other(1);
    expect_written_after(30000, 1);
    receive_all(response_1_754);
    expect_written_after(20000, 2);
    assert_int_equal(bench.other_value, 0xDEAD);
    response_other(1, 751);
}

/* ---- due ---- */

/* Sleeping as long as due says, and no longer, must never miss anything: every outcome comes at the same time
 * as with polling all the time. */
TEST(sleeping_for_due_us_ends_a_transaction_as_early_as_polling_without_pause)
{
    uint32_t ended_us[2];
    for (int sleeps = 0; sleeps != 2; sleeps++) {
        set_up(state);
        ask_1(2);
        const uint32_t began_us = bench.fake.now_us;
        unsigned polls = 0;
        while (status_of(&bench.request) == FATHOM_PENDING) {
            const uint32_t due_us = due();
            bench.fake.now_us += sleeps != 0 && due_us != 0 ? due_us : 1;
            poll_line();
            polls++;
        }
        ended_us[sleeps] = bench.fake.now_us - began_us;
        if (sleeps != 0) assert_in_range(polls, 3, 60);
    }
    assert_in_range(ended_us[1], ended_us[0], ended_us[0] + 3 * 1000);
}

TEST(counters_stop_at_their_end)
{
    bench.counters[FATHOM_LINE_RESPONSES] = 65534;
    bench.counters[FATHOM_LINE_DROPPED_BYTES] = 65530;
    for (int i = 0; i != 3; i++) {
        ask_1(0);
        run(80000); /* what 9 has sent unasked is forgotten */
        deliver_response(1, 111);
        receive_response(9, 999);
        run(10000);
    }
    expect_count(FATHOM_LINE_RESPONSES, 65535);
    expect_count(FATHOM_LINE_DROPPED_BYTES, 65535);
}

TEST_IN(quarantined, what_only_waits_for_a_quarantine_is_due_when_that_ends)
{
    ask_1(0);
    const uint32_t due_us = due();
    assert_true(due_us > TIMEOUT_US - 1000 && due_us <= TIMEOUT_US);
    run_in_steps(due_us, due_us);
    expect_written(2);
}
