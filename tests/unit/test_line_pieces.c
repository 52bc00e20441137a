/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* line.h, FATHOM_LINE_NO_GAP: a response may arrive in pieces, as through a network. */

enum { LONG_US = 1000000 };

static int set_up_pieces(void **state)
{
    (void)set_up(state);
    bench.config.gap_us = FATHOM_LINE_NO_GAP;
    ask_1(0);
    bench.request.transaction.timeout_us = LONG_US;
    run(REQUEST_US);
    return 0;
}

static const suite_t suite = {.set_up = set_up_pieces};

TEST(pieces_of_a_response_are_a_response_whatever_the_pauses)
{
    static const uint32_t pauses_us[] = {0, 62000, 66000, 150000, 900000};
    for (size_t cut = 1; cut != sizeof response_1_754; cut++)
        for (size_t i = 0; i != COUNT_OF(pauses_us); i++) {
            set_up_pieces(state);
            deliver(response_1_754, cut);
            run(pauses_us[i]);
            expect_failed(FATHOM_PENDING);
            receive(response_1_754 + cut, sizeof response_1_754 - cut);
            run(100);
            expect_mm(754);
        }
}

TEST(half_a_response_and_a_damaged_one_fail_with_the_time_out)
{
    for (unsigned is_whole = 0; is_whole != 2; is_whole++) {
        set_up_pieces(state);
        if (is_whole != 0)
            receive_damaged();
        else
            receive(response_1_754, 5);
        run(100);
        expect_after(LONG_US - 1000, FATHOM_PENDING);
        run(FATHOM_LINE_FINISH_US + 2000); /* a response that has begun may go on */
        expect_failed(FATHOM_ERR_CHECKSUM);
    }
}

TEST(a_piece_that_arrives_between_two_requests_delays_the_next_by_65_ms_at_most)
{
    run(LONG_US + 200);
    deliver(response_1_754, 3); /* of a late response, which the line holds back */
    ask_other(2);
    expect_written_after(65535uL + T3_5_US + 400, 2);
}

TEST(a_program_that_sleeps_for_due_us_reads_a_response_in_pieces)
{
    deliver(response_1_754, 3);
    assert_in_range(due(), LONG_US / 2, LONG_US + FATHOM_LINE_FINISH_US);
    bench.fake.now_us += 500000;
    receive(response_1_754 + 3, 4);
    (void)poll_line();
    expect_mm(754);
}
