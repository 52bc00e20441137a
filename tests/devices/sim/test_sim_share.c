/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include "mix.h"

/* What an A16, an A05 and an HPS-167S get of one pair, by their simulated times: 520 ms at most for a processed value
 * of the A16 and 120 for a real-time one, 400 for the A05's four probes, 18.5 from one request of the HPS-167S to the
 * next. The frames and the silence of 9600 baud are 20 to 30 ms more, and 16 of the 18.5. */

enum { SECONDS = 60, MS = 1000 };

static const suite_t suite = {.set_up = NULL};
static mix_share_t shares[MIX_SENSORS];

static void run(mix_t mix)
{
    mix_run(&mix, SECONDS, shares);
    for (int i = 0; i != MIX_SENSORS; i++)
        if ((mix.dead >> i & 1) == 0) assert_int_equal(shares[i].failures, 0);
}

#define expect_responses(i, low, high)                                                                       \
    assert_in_range(shares[MIX_##i].responses, (low)*SECONDS, (high)*SECONDS)
#define expect_percent(i, low, high)                                                                         \
    assert_in_range(shares[MIX_##i].line_us, (low)*SECONDS * 10 * MS, (high)*SECONDS * 10 * MS)
#define expect_wait(i, ms) assert_true(shares[MIX_##i].longest_wait_us <= (ms)*MS)

TEST(in_turns_the_fast_one_is_asked_once_for_each_request_of_the_others)
{
    run((mix_t){.processed = true});
    expect_responses(HPS, 1, 2);
    assert_in_range(shares[MIX_HPS].responses - shares[MIX_A16].responses + 1, 0, 2);
}

/* A third is 18 readings a second. Their share of the line is 1/3, and 1/3 * 14.5 / 18.5 of the HPS-167S, the rest of
 * which is the time for which the line is held for it. The longest waits by fair_share.h, with 18.5 ms, 435 and 550 as
 * the longest of each, and 65 as the hold time. */
TEST(by_a_fair_share_each_has_a_third_of_the_time)
{
    run((mix_t){.processed = true, .fair = true});
    expect_responses(HPS, 16, 19);
    expect_percent(A16, 31, 36);
    expect_percent(A05, 31, 36);
    expect_percent(HPS, 23, 29);
    expect_wait(HPS, 2 * (19 + 130) + 435 + 550);
    expect_wait(A05, 2 * (435 + 130) + 19 + 550);
    expect_wait(A16, 2 * (550 + 130) + 19 + 435);
}

/* A loop of 5 ms sees the HPS-167S's response up to 5 ms late, and asks it up to 5 later: 28.5 ms at most instead of
 * 18.5. */
TEST(in_a_slower_loop_too)
{
    run((mix_t){.processed = true, .fair = true, .loop_us = 5 * MS});
    expect_responses(HPS, 11, 18);
    expect_percent(A16, 31, 36);
    expect_percent(A05, 31, 36);
}

TEST(a_real_time_a16_is_read_more_often_in_its_third)
{
    run((mix_t){.fair = true});
    expect_responses(HPS, 16, 19);
    expect_responses(A16, 2, 3);
    expect_percent(A16, 30, 36);
    expect_percent(A05, 31, 36);
}

TEST(alone_it_is_as_fast_as_without)
{
    run((mix_t){.absent = 1 << MIX_A16 | 1 << MIX_A05, .fair = true});
    expect_responses(HPS, 53, 55);
}

/* With nothing that asks as soon again, nothing is held back: the line is never idle but for the silence and the time
 * in which its driver asks. */
TEST(for_one_that_is_asked_five_times_a_second_the_line_is_never_idle)
{
    run((mix_t){.hps_period_us = 200 * MS, .processed = true, .fair = true});
    expect_responses(HPS, 2, 5);
    expect_percent(A16, 45, 50);
    expect_percent(A05, 45, 50);
}

/* Of the time that a dead one leaves, since it is asked less and less often, each has its half. */
TEST(a_dead_one_takes_no_more_than_its_back_off_allows)
{
    run((mix_t){.dead = 1 << MIX_A05, .fair = true});
    assert_int_equal(shares[MIX_A05].responses, 0);
    assert_in_range(shares[MIX_A05].failures, 8, 15);
    expect_percent(A05, 5, 15);
    expect_percent(A16, 40, 46);
    expect_responses(HPS, 22, 26);
}
