/* SPDX-License-Identifier: MIT */
/* A far end that never falls silent, and knows when the line is polled: what it can hold up, and for how long. */
#include "line_conversation.h"

static const suite_t suite = {.set_up = set_up};
static const suite_t asked = {.set_up = set_up_asked};

enum { FRAME = sizeof bench.frame };

/* busy_us is 1 s. Of 65 ms of silence, T3_5_US suffice. */
static const conversation_t conversations[] = {
    ROW("while_noise_leaves_no_silence_a_read_leaves_after_a_second_and_the_line_is_said_to_be_busy",
        COUNTS(.busy = 1, .dropped = 1068), QUEUE(A, 1), JAM(1000000 - 2 * BYTE_US), PENDS(A), WRITTEN(0),
        JAM(4 * BYTE_US), WRITTEN(1), JAM(8 * BYTE_US + TIMEOUT_US + 2 * BYTE_US), FAILS(A, LINE_BUSY)),
    ROW("a_frame_during_the_wait_keeps_a_read_out_of_the_noise",
        COUNTS(.busy = 1, .strays = 1, .dropped = 969), QUEUE(A, 1), JAM(100000), RESPONSE(9, 754),
        JAM(900000 - 2 * BYTE_US), PENDS(A), JAM(4 * BYTE_US), FAILS(A, LINE_BUSY), WRITTEN(0)),
    /* the wait of the second write begins anew; now the line falls silent */
    ROW("while_noise_leaves_no_silence_a_write_ends_after_a_second_and_was_not_sent",
        COUNTS(.busy = 1, .dropped = 962), WRITE(A, 1), JAM(1000000 - 2 * BYTE_US), ENDS(A, FATHOM_PENDING),
        JAM(4 * BYTE_US), ENDS(A, FATHOM_ERR_LINE_BUSY), WRITTEN(0), COUNT(BUSY_ATTEMPTS, 1), WRITE(A, 1),
        SENT(0, T3_5_US + BYTE_US)),
    /* unit 1, at the head of the queue, is in quarantine from 100 to 200 ms after its request */
    ROW("each_transaction_behind_one_in_quarantine_has_a_wait_of_its_own",
        COUNTS(.no_responses = 1, .busy = 2, .dropped = 67), BUSY_US(30000), ASK_TWICE(A, 1),
        WAIT(TIMEOUT_US + 200), WRITE(B, 2), JAM(34000), ENDS(B, FATHOM_ERR_LINE_BUSY), WRITE(B, 2),
        JAM(20000), ENDS(B, FATHOM_PENDING), JAM(14000), ENDS(B, FATHOM_ERR_LINE_BUSY)),
    /* the port has FATHOM_LINE_SEND_US, a second, for the request; the wait for silence is another second. A request may
     * leave at once here, so no wait for silence begins */
    ROW("noise_does_not_prolong_the_time_of_a_busy_port", COUNTS(.port_errors = 1, .dropped = 482),
        PORT_REFUSES(true), WAIT(10000), QUEUE(A, 1), WAIT(500000), JAM(500000 - 2 * BYTE_US), PENDS(A),
        JAM(4 * BYTE_US), FAILS(A, PORT)),
};
CONVERSATIONS(set_up, conversations)

/* They are no part of the response: after them the unit is waited for until its time-out. */
TEST(a_read_that_leaves_into_noise_discards_the_bytes_before_it)
{
    /* 01 03 02: in place of the discarded bytes the request would look like a response that broke off. */
    fathom_modbus_read_holding_registers(&bench.request.message, 1, 0x0200, 1, &bench.value);
    bench.request.transaction.timeout_us = TIMEOUT_US;
    assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_PENDING);
    play_jam(&(step_t){.us = 1000000 - 2 * BYTE_US});
    receive_hex("02 03 02"); /* a response of another unit begins and breaks off */
    run_in_steps(3 * BYTE_US, BYTE_US);
    expect_written(1);
    run(8 * BYTE_US);
    run(TIMEOUT_US - 2 * BYTE_US);
    expect(FATHOM_PENDING);
    run(4 * BYTE_US);
    expect(FATHOM_ERR_LINE_BUSY);
}

/* Rule 5: FATHOM_LINE_FINISH_US after the time-out. 26 bytes of data, 19 ms from byte to byte. */
TEST(a_response_that_goes_on_300_ms_after_the_time_out_is_damaged)
{
    bench.config.gap_us = 20000;
    set_up_echo(FATHOM_LINE_ECHO_OFF);
    ask_1_and_send(0);
    run(90000);
    receive_hex("01 03 1A");
    for (unsigned i = 0; i != 16; i++) {
        expect_after(19000, FATHOM_PENDING);
        receive_hex("00");
    }
    expect_after(19000, FATHOM_ERR_CHECKSUM);
}

/* line.h: a response that has begun in time may end later: the longest frame, with gaps that are nearly gap_us. */
TEST_IN(asked, bytes_just_within_the_gap_hold_a_transaction_for_a_frame_longer_than_its_time_out)
{
    static const uint8_t beginning[] = {0x01, 0x03, FRAME - 6};
    uint32_t waited_us = 0;
    for (unsigned i = 0; status_of(&bench.request) == FATHOM_PENDING && i != 200; i++) {
        receive(&beginning[i % sizeof beginning], 1);
        run_in_steps(GAP_US - 1, GAP_US - 1);
        waited_us += GAP_US - 1;
    }
    expect_failed(FATHOM_ERR_CHECKSUM);
    assert_in_range(waited_us, TIMEOUT_US, TIMEOUT_US + FRAME * (uint32_t)GAP_US);
}

/* So that each poll finds half of the next copy behind the one that it takes. */
static void expect_copies_to_end(uint8_t echo)
{
    enum { HALF = sizeof ask_1_processed / 2, COPY_US = sizeof ask_1_processed * BYTE_US };
    uint32_t waited_us = 0;
    set_up_echo(echo);
    ask_1_and_send(0);
    receive(ask_1_processed, HALF);
    while (status_of(&bench.request) == FATHOM_PENDING && waited_us < 10 * TIMEOUT_US) {
        receive(ask_1_processed + HALF, HALF);
        receive(ask_1_processed, HALF);
        run_in_steps(COPY_US, COPY_US);
        waited_us += COPY_US;
    }
    expect_failed(FATHOM_ERR_NO_RESPONSE);
    assert_in_range(waited_us, TIMEOUT_US - COPY_US, TIMEOUT_US + 2 * COPY_US);
}

TEST(copies_of_the_request_without_end_do_not_hold_a_transaction)
{
    static const uint8_t echoes[] = {FATHOM_LINE_ECHO_AUTO, FATHOM_LINE_ECHO_OFF, FATHOM_LINE_ECHO_ON};
    for (size_t i = 0; i != COUNT_OF(echoes); i++) {
        set_up(state);
        expect_copies_to_end(echoes[i]);
    }
}

TEST_IN(asked, a_poll_ends_though_the_port_has_ever_more)
{
    for (unsigned i = 0; i != 100; i++) receive_hex("01 03 F8");
    const unsigned before = bench.fake.reads;
    (void)poll_line();
    assert_int_equal(bench.fake.reads - before, 16);
    assert_false(fake_drained(&bench.fake));
}

/* FATHOM_LINE_SEND_US: "how long a port may ... take to send it, before it counts as broken". */
TEST(a_port_that_never_sends_is_broken_on_a_noisy_line_too)
{
    bench.fake.never_sent = true;
    ask_1(0);
    expect_written_after(T3_5_US + 200, 1);
    for (unsigned i = 0; i != 60; i++) {
        receive_hex("00");
        run_in_steps(20000, 20000);
    }
    expect(FATHOM_ERR_PORT);
}
