/* SPDX-License-Identifier: MIT */
#include "line_conversation.h"

static const suite_t suite = {.set_up = set_up};

#define DAMAGED "01 03 02 02 E2 38 A1"             /* response_1_754 with one wrong bit */
#define THREE   "01 03 06 00 FA 02 93 09 7A 8F 47" /* registers instead of one */

static const conversation_t responses[] = {
    ROW("noise_before_a_response_is_dropped_in_the_same_poll", COUNTS(.responses = 1, .dropped = 5),
        ASK(A, 1), RECEIVE("00 FF 81 00 55 01 03 02 02 F2 38 A1"), WAIT(GAP_US + 100), READS(A, 754)),
    /* 25 bytes are promised */
    ROW("noise_that_looks_like_the_start_of_a_long_response_costs_one_gap_at_most",
        COUNTS(.responses = 1, .dropped = 3), ASK(A, 1), RECEIVE("01 03 14 01 03 02 02 F2 38 A1"),
        WAIT(GAP_US + 100), READS(A, 754)),
    ROW("another_units_response_is_a_stray_and_the_wait_goes_on",
        COUNTS(.responses = 1, .strays = 1, .dropped = 7), ASK(A, 1), RESPONSE(2, 222), WAIT(900), PENDS(A),
        COUNT(STRAYS, 1), RESPONSE(1, 111), READS(A, 111)),
    ROW("behind_a_response_of_the_wrong_shape_the_right_one_counts", COUNTS(.responses = 1, .dropped = 11),
        ASK(A, 1), RECEIVE(THREE), WAIT(900), PENDS(A), RESPONSE(1, 111), READS(A, 111)),
    ROW("a_response_of_the_wrong_shape_is_malformed_if_nothing_follows",
        COUNTS(.malformed = 1, .dropped = 11), ASK(A, 1), RECEIVE(THREE), WAIT(TIMEOUT_US),
        FAILS(A, MALFORMED)),
    ROW("a_damaged_response_ends_the_attempt_at_the_first_gap", COUNTS(.damaged = 1, .dropped = 7), ASK(A, 1),
        RECEIVE(DAMAGED), WAIT(GAP_US - 300), PENDS(A), WAIT(400), FAILS(A, CHECKSUM)),
    /* A USB adapter says up to 16 ms late that a request has left, and the response may be here by then. It might also
     * be noise, so the quarantine lasts twice the time-out. */
    ROW("a_damaged_response_counts_although_the_port_says_late_that_the_request_has_left",
        COUNTS(.damaged = 1, .dropped = 7), NEVER_SENT(true), QUEUE_TWICE(A, 1), WAIT(20000),
        RECEIVE(DAMAGED), WAIT(900), NEVER_SENT(false), WAIT(GAP_US + 400), COUNT(CHECKSUM_ERRORS, 1),
        SENT(2 * TIMEOUT_US - GAP_US - 1500, 2000)),
    ROW("a_response_counts_although_the_port_does_not_say_yet_that_the_request_has_left",
        COUNTS(.responses = 1), NEVER_SENT(true), QUEUE(A, 1), WAIT(20000), RESPONSE(1, 754), READS(A, 754)),
    ROW("less_than_three_bytes_are_noise_and_end_nothing", COUNTS(.responses = 1, .dropped = 2), ASK(A, 1),
        RECEIVE("01 03"), WAIT(GAP_US + 300), PENDS(A), RESPONSE(1, 754), READS(A, 754)),
    ROW("a_stray_while_nothing_is_asked_is_dropped", COUNTS(.dropped = 7), RESPONSE(1, 111), IDLE(true)),
};
CONVERSATIONS(set_up, responses)

static const conversation_t broken_ports[] = {
    ROW("a_port_that_cannot_be_read_ends_every_transaction_and_recovers",
        COUNTS(.port_errors = 1, .responses = 1), ASK(A, 1), QUEUE(B, 2), BREAK_PORT, FAILS(A, PORT),
        FAILS(B, PORT), QUEUE(B, 2), WAIT(20000), RESPONSE(2, 222), READS(B, 222)),
    /* the late response is that to the request before */
    ROW("a_unit_that_was_asked_when_the_port_broke_is_still_quarantined",
        COUNTS(.port_errors = 1, .late = 1, .dropped = 7), ASK(A, 1), BREAK_PORT, QUEUE(A, 1), WAIT(20000),
        WRITTEN(1), RESPONSE(1, 111), PENDS(A), COUNT(LATE_RESPONSES, 1), SENT(0, 20000)),
    /* no late response, since some of it may have been lost */
    ROW("what_was_received_before_the_port_broke_is_forgotten", COUNTS(.port_errors = 1, .dropped = 4),
        ASK(A, 1), RECEIVE("01 03 02"), BREAK_PORT, RECEIVE("02 F2 38 A1"), WAIT(2 * GAP_US)),
    ROW("a_busy_port_gets_the_request_when_it_is_free", COUNTS(0), PORT_REFUSES(true), QUEUE(A, 1),
        WAIT(50000), PENDS(A), PORT_REFUSES(false), SENT(0, 100)),
    ROW("a_port_that_sends_nothing_for_a_second_is_broken", COUNTS(.port_errors = 1), NEVER_SENT(true),
        QUEUE(A, 1), WAIT(FATHOM_LINE_SEND_US), PENDS(A), WAIT(T3_5_US + 1000), FAILS(A, PORT)),
    ROW("what_comes_while_the_port_refuses_the_request_is_no_response", COUNTS(.dropped = 7, .strays = 1),
        PORT_REFUSES(true), QUEUE(A, 1), WAIT(50000), RESPONSE(1, 754), PENDS(A)),
    ROW("a_request_that_the_port_never_took_quarantines_none_when_it_breaks", COUNTS(.port_errors = 1),
        PORT_REFUSES(true), QUEUE(A, 1), WAIT(50000), BREAK_PORT, FAILS(A, PORT), PORT_REFUSES(false),
        QUEUE(A, 1), SENT(0, T3_5_US + 200)),
};
CONVERSATIONS(set_up, broken_ports)

TEST(a_response_that_breaks_off_is_a_checksum_error)
{
    for (size_t length = 3; length != sizeof response_1_754; length++) {
        set_up_asked(state);
        receive(response_1_754, length);
        run(GAP_US + 400);
        expect_failed(FATHOM_ERR_CHECKSUM);
    }
}

TEST(a_frame_longer_than_the_memory_is_dropped_without_overrun)
{
    uint8_t flood[201];
    memset(flood, 0x01, sizeof flood);
    for (size_t i = 1; i < sizeof flood; i += 3)
        flood[i] = 0x03, flood[i + 1] = 0xF8; /* promises 253 bytes */
    ask_1_and_send(0);
    receive_all(flood);
    run(1000);
    receive_response(1, 111);
    run(GAP_US + 100);
    expect_mm(111);
}

TEST(retries_are_the_callers_number_and_the_last_error_stays)
{
    ask_1(2);
    expect_after(8 * TIMEOUT_US, FATHOM_ERR_NO_RESPONSE);
    assert_int_equal(bench.request.transaction.attempts, 3);
    expect_written(3);
    expect_count(FATHOM_LINE_NO_RESPONSES, 3);
}

/* Asks unit 1, of a line that is new but for what `fails`, and runs for so long. */
static void ask_while(void **state, bool *fails, uint32_t for_us)
{
    set_up(state);
    *fails = true;
    ask_1(0);
    run(for_us);
}

TEST(a_port_that_cannot_write_or_tears_a_request_ends_the_transaction)
{
    ask_while(state, &bench.fake.write_fails, 5000);
    expect(FATHOM_ERR_PORT);
    ask_while(state, &bench.fake.write_too_short, 5000);
    expect(FATHOM_ERR_PORT);
}

/* ---- fathom_modbus_client_submit() ---- */

TEST(a_count_of_registers_out_of_range_is_refused)
{
    static const uint8_t reads[] = {0, 126};
    uint16_t values[4] = {0};
    for (size_t i = 0; i != 3; i++) {
        if (i != 2)
            fathom_modbus_read_holding_registers(&bench.request.message, 1, 0x0106, reads[i], values);
        else
            fathom_modbus_write_multiple_registers(&bench.request.message, 1, 0, 124, values);
        assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_ERR_ARGUMENT);
        assert_null(bench.line.head);
    }
}

TEST(every_byte_of_an_acknowledgement_counts)
{
    uint16_t values[5] = {0};
    for (size_t i = 1; i != 6; i++) {
        set_up(state);
        fathom_modbus_write_single_register(&bench.request.message, 1, 0x0200, 5);
        bench.request.message.head[i] ^=
            i == 1 ? 0x16 : 1; /* asks for something else: function 10, or one bit */
        bench.request.message.values = values;
        submit(&bench.request);
        run(40000);
        receive_all(set_address_5);
        expect_after(200, FATHOM_PENDING);
        expect_after(TIMEOUT_US, FATHOM_ERR_MALFORMED);
    }
}
