/* SPDX-License-Identifier: MIT */
/* A far end that never falls silent, and knows when the line is polled: what it can hold up, and for how long. */
#include "line_bench.h"

static const suite_t suite = {.set_up = set_up};
static const suite_t asked = {.set_up = set_up_asked};

enum { FRAME = sizeof bench.frame };

TEST(while_the_line_is_never_silent_no_request_leaves_and_then_it_does)
{
    ask_1(0);
    for (uint32_t us = 0; us < 60000000; us += BYTE_US) {
        receive_hex("00");
        run_in_steps(BYTE_US, BYTE_US);
        expect(FATHOM_PENDING);
    }
    expect_written(0);
    expect_written_after(65536 + T3_5_US, 1);
    response_1(754);
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

/* A loop slower than the time-out finds both at once. */
TEST(an_echo_and_its_response_count_when_they_are_found_late)
{
    set_up_echo(FATHOM_LINE_ECHO_AUTO);
    ask_1_and_send(0);
    receive_all(ask_1_processed);
    receive_all(response_1_754);
    run_in_steps(3 * TIMEOUT_US, 3 * TIMEOUT_US);
    expect_mm(754);
}

TEST_IN(asked, a_poll_ends_though_the_port_has_ever_more)
{
    for (unsigned i = 0; i != 100; i++) receive_hex("01 03 F8");
    const unsigned before = bench.fake.reads;
    (void)poll_line();
    assert_in_range(bench.fake.reads - before, 1, 16);
}
