/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include "defences.h"

enum { TRANSACTIONS = 8000, SEED = 1 };

static defence_result_t result;

static void run(const char *name)
{
    uint8_t i = 0;
    while (i < DEFENCES && strcmp(defences[i].name, name) != 0) i++;
    assert_in_range(i, 0, DEFENCES - 1);
    defences[i].run(TRANSACTIONS, SEED, &result);
    if (!defence_matters(&result))
        print_error("%s: %lu with, %lu without\n", result.what, (unsigned long)result.with,
                    (unsigned long)result.without);
}

TEST(a_wide_window_lets_more_wrong_readings_pass)
{
    run("plausibility window");
    assert_true(defence_matters(&result));
}

TEST(without_pauses_that_are_seen_511_mm_are_never_shown)
{
    run("pauses that are seen");
    assert_true(result.with < TRANSACTIONS / 1000);
    assert_true(result.without >= TRANSACTIONS);
}

TEST(without_its_deadline_a_silent_stream_is_stuck)
{
    run("stale deadline");
    assert_int_equal(result.with, 0);
    assert_true(defence_matters(&result));
}

TEST(an_echo_that_is_denied_acknowledges_writes_to_an_absent_unit)
{
    run("echo found out");
    assert_int_equal(result.with, 0);
    assert_int_equal(result.without, TRANSACTIONS / 100);
}
