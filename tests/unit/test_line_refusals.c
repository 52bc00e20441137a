/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* A port that reports when no response will arrive (hal.h: FATHOM_RX_NO_RESPONSE; line.h: fathom_line_refusals()). */

static const uint8_t word[1] = {0x0B};

static int set_up_refusals(void **state)
{
    (void)set_up(state);
    bench.config.marks = fathom_line_refusals;
    return 0;
}

static const suite_t suite = {.set_up = set_up_refusals};

static void refuse(void)
{
    receive_rx(word, sizeof word, FATHOM_RX_NO_RESPONSE);
    run(100);
}

TEST(a_refusal_ends_the_attempt_at_once)
{
    ask_1_and_send(0);
    refuse();
    expect_failed(FATHOM_ERR_NO_RESPONSE);
    expect_count(FATHOM_LINE_NO_RESPONSES, 1);
    expect_count(FATHOM_LINE_DROPPED_BYTES, 0);
}

TEST(a_retry_leaves_at_once_after_a_refusal)
{
    ask_1_and_send(1);
    refuse();
    expect(FATHOM_PENDING);
    expect_sent(T3_5_US - 400, 800);
    run(8 * BYTE_US);
    response_1(754);
}

TEST(a_refusal_leaves_the_quarantine_of_another_unit_as_it_is)
{
    ask_1_and_send(0);
    run(TIMEOUT_US + 200);
    ask_other(2);
    run(REQUEST_US);
    expect_written(2);
    refuse();
    expect_other(FATHOM_ERR_NO_RESPONSE);
    ask_1(0);
    /* Twice the time-out after the end of the first request; the second one took a silence and its bytes. */
    expect_sent(TIMEOUT_US - REQUEST_US - 1500, 2000);
}

TEST(a_wrong_frame_before_a_refusal_is_the_error)
{
    ask_1_and_send(0);
    deliver_all(response_1_three);
    refuse();
    expect_failed(FATHOM_ERR_MALFORMED);
}

TEST(a_refusal_without_a_request_changes_nothing)
{
    refuse();
    ask_1_and_send(0);
    response_1(754);
    expect_count(FATHOM_LINE_NO_RESPONSES, 0);
}

TEST(a_refusal_does_not_end_a_broadcast)
{
    ask_to_write(&bench.request, 0);
    run(REQUEST_US);
    expect_written(1);
    refuse();
    expect(FATHOM_PENDING);
    expect_after(TIMEOUT_US + 1000, FATHOM_OK);
}

TEST(bytes_without_the_flag_are_received)
{
    ask_1_and_send(0);
    receive_rx(response_1_754, sizeof response_1_754, FATHOM_RX_PARITY);
    run(100);
    expect_mm(754); /* only fathom_line_marks() uses the other flags */
}
