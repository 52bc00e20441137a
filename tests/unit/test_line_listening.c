/* SPDX-License-Identifier: MIT */
#include "line_conversation.h"

/* A line that only listens, and one that is told nothing but what it cannot do without: no marks, no counters, no
 * search for an echo. */

static void keep_only_what_is_needed(void)
{
    bench.config.find_echo = NULL;
    bench.config.marks = NULL;
    bench.config.count = NULL;
    bench.config.counters = NULL;
}

static int set_up_listening(void **state)
{
    set_up(state);
    keep_only_what_is_needed();
    bench.config.echo = FATHOM_LINE_ECHO_AUTO; /* "nothing needs to be said of echo" */
    assert_int_equal(fathom_line_init_listening(&bench.line, &bench.config), FATHOM_OK);
    show_empty_port();
    return 0;
}

static int set_up_bare(void **state)
{
    set_up(state);
    keep_only_what_is_needed();
    assert_int_equal(fathom_line_init(&bench.line, &bench.config), FATHOM_OK);
    show_empty_port();
    return 0;
}

static const suite_t suite = {.set_up = set_up_bare};

#define FRAME "FF 07 A1 A7" /* of an A16 that sends by itself */

#define MARKS STEP(marks, .which = 0)
static void play_marks(const step_t *step) { bench.config.marks = fathom_line_marks; }

static const conversation_t listening[] = {
    ROW("a_line_that_only_listens_hands_over_what_comes_with_the_silence_before_it", COUNTS(0), LISTEN(5000),
        WAIT(6000), RECEIVE(FRAME), RECEIVE("01 83 02 C0 F1"), HEARD(FRAME " 01 83 02 C0 F1", 1), GAP_AT(0),
        IDLE(true)),
    ROW("a_line_that_only_listens_tells_of_lost_bytes_once", COUNTS(0), MARKS, LISTEN(5000),
        RECEIVE_WITH(FRAMING, FRAME), HEARD("", 0), LOST_AT(0, 1)),
    ROW("a_line_that_only_listens_hands_over_each_byte_as_it_comes", COUNTS(0), LISTEN(5000), RECEIVE("FF"),
        HEARD("FF", 0)),
    ROW("what_comes_to_no_listener_is_forgotten", COUNTS(0), RECEIVE(FRAME), LISTEN(500),
        RECEIVE("01 83 02 C0 F1"), HEARD("01 83 02 C0 F1", 0)),
    ROW("a_line_that_only_listens_is_due_when_the_silence_is_one_for_its_listener", COUNTS(0),
        DUE(FATHOM_NO_DEADLINE), LISTEN(5000), RECEIVE(FRAME), DUE(5000), WAIT(5100),
        DUE(FATHOM_NO_DEADLINE)),
    ROW("a_line_that_only_listens_lives_through_a_broken_port", COUNTS(0), LISTEN(5000), BREAK_PORT,
        RECEIVE(FRAME), HEARD(FRAME, 0)),
};
CONVERSATIONS(set_up_listening, listening)

static const conversation_t without_parts[] = {
    /* here an echo where there was to be none */
    ROW("what_is_told_of_an_echo_stays", COUNTS(0), ASK(A, 1), ARRIVE("01 03 01 00 00 01 85 F6"),
        RECEIVE("01 03 02 02 F2 38 A1"), READS(A, 754), ECHO_IS(OFF), BREAK_PORT, ECHO_IS(OFF)),
    ROW("without_its_parts_a_line_ends_a_transaction_by_an_exception", COUNTS(0), ASK(A, 1),
        RECEIVE("01 83 02 C0 F1"), FAILS(A, EXCEPTION)),
    ROW("without_its_parts_a_line_ends_a_transaction_by_a_damaged_response", COUNTS(0), ASK(A, 1),
        RECEIVE("01 03 02 02 E2 38 A1"), WAIT(GAP_US + 200), FAILS(A, CHECKSUM)),
    ROW("without_its_parts_a_line_accepts_a_late_response_to_the_retry", COUNTS(0), ASK_TWICE(A, 1),
        WAIT(TIMEOUT_US + 200), RESPONSE(1, 754), READS(A, 754)),
};
CONVERSATIONS(set_up_bare, without_parts)

/* Marks of the port count where they are named: the bytes are the CRC's to judge. */
TEST(without_marks_the_bytes_that_the_port_marks_are_as_any_other)
{
    static const uint8_t flags[] = {FATHOM_RX_PARITY, FATHOM_RX_FRAMING, FATHOM_RX_OVERRUN,
                                    FATHOM_RX_SILENCE};
    for (size_t i = 0; i != sizeof flags; i++) {
        set_up_bare(state);
        ask_1_and_send(0);
        receive(response_1_754, 4);
        receive_rx(response_1_754 + 4, 3, flags[i]);
        run(100);
        expect_mm(754);
    }
}

/* fathom_modbus_client_submit: "A read of unit 0: FATHOM_ERR_UNSUPPORTED". */
TEST(a_client_without_unit_0_does_not_read_it)
{
    fathom_modbus_read_holding_registers(&bench.request.message, 0, 0x0100, 1, &bench.value);
    assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_ERR_UNSUPPORTED);
    run(100000);
    expect_written(0);
}

/* A 55 AA frame of unit 1, which is quarantined after a request in Modbus: it is late, and not that response, though
 * it is one to a read of the same register. */
TEST(a_late_frame_of_another_protocol_is_not_the_response)
{
    ask_dyp(&bench.other, 1, 1, &bench.other_value);
    run(REQUEST_US + TIMEOUT_US);
    assert_int_equal(status_of(&bench.other), FATHOM_ERR_NO_RESPONSE);
    run(TIMEOUT_US + 200);
    bench.value = 0xDEAD;
    fathom_modbus_read_holding_registers(&bench.request.message, 1, 0x0106, 1, &bench.value);
    bench.request.transaction.retries = 1;
    submit(&bench.request);
    run(REQUEST_US + TIMEOUT_US);
    ask_dyp(&bench.other, 2, 1, &bench.other_value);
    run(REQUEST_US);
    expect_written(3);
    deliver_all(dyp_first_1953);
    expect(FATHOM_PENDING);
    assert_int_equal(bench.value, 0xDEAD);
}
