/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "defences.h"

enum { EXCHANGES = 8000, SEED = 1 };

static void run(const char *name, defence_result_t *result)
{
    for (uint8_t i = 0; i < DEFENCES; i++) {
        if (strcmp(defences[i].name, name) != 0) continue;
        defences[i].run(EXCHANGES, SEED, result);
        if (!defence_matters(result))
            print_error("%s: %lu with, %lu without\n", result->what, (unsigned long)result->with,
                        (unsigned long)result->without);
        return;
    }
    fail();
}

TEST(a_wide_window_lets_more_wrong_readings_pass)
{
    defence_result_t result;
    run("plausibility window", &result);
    assert_true(defence_matters(&result));
}

TEST(without_pauses_that_are_seen_511_mm_are_never_shown)
{
    defence_result_t result;
    run("pauses that are seen", &result);
    assert_true(result.with < EXCHANGES / 1000);
    assert_true(result.without >= EXCHANGES);
}

TEST(without_its_deadline_a_silent_stream_is_stuck)
{
    defence_result_t result;
    run("stale deadline", &result);
    assert_int_equal(result.with, 0);
    assert_true(defence_matters(&result));
}

TEST(an_echo_that_is_denied_acknowledges_writes_to_nobody)
{
    defence_result_t result;
    run("echo found out", &result);
    assert_int_equal(result.with, 0);
    assert_int_equal(result.without, EXCHANGES / 100);
}
