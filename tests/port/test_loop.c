/* SPDX-License-Identifier: MIT */
#include "loop_three.h"

/* When fathom_loop.h polls what, in simulated time: pauses and what is told of them are in test_loop_lost.c. */

static const suite_t suite = {.set_up = set_up, .tear_down = fake_tear_down};

static int tear_down_none(void **state) { return 0; }
static const suite_t plain = {.tear_down = tear_down_none};

/* ---- what is due ---- */

TEST(a_source_is_polled_once_it_is_open_and_then_when_it_is_due)
{
    add_due(&one, 250000);
    assert_int_equal(one.polls, 0);
    step_to(0);
    assert_int_equal(one.polls, 1);
    step_to(250000);
    assert_int_equal(one.polls, 2);
    fake_pass(10000000);
    assert_int_equal(one.polls, 2 + 40);
}

TEST(nothing_else_is_polled)
{
    add_due(&one, 1000);
    add_due(&two, 1000000);
    fake_pass(1000000 - 1);
    expect_polls(1000, 1);
    assert_int_equal(fake.loop.polls, 1001);
}

TEST(the_first_of_the_sensors_on_a_source_says_when_it_is_due)
{
    one.due_us = FATHOM_NO_DEADLINE;
    add_with_sensors();
    first.due_us = 7000;
    second.due_us = 5000;
    step();
    first.due_us = 3000;
    step_to(5000);
    assert_int_equal(first.polls, 2);
    assert_int_equal(second.polls, 2);
    one.due_us = 2000;
    step_to(5000 + 3000);
    step_to(8000 + 2000);
}

TEST(what_has_come_is_polled_before_it_is_due_and_then_its_time_begins_anew)
{
    add(&one);
    step();
    fake_wake_in(&one, 1000);
    step_to(1000);
    assert_int_equal(one.polls, 2);
    step_to(1001000);
    assert_int_equal(one.polls, 3);
}

TEST(they_are_polled_in_the_order_in_which_they_are_due)
{
    add_due(&one, 3000);
    add_due(&two, 2000);
    add_due(&three, 1000);
    step();
    fake.now_us += 500000; /* the machine was suspended: all are due */
    step();
    assert_int_equal(fake.turns, 6);
    assert_int_equal(three.turn, 4);
    assert_int_equal(two.turn, 5);
    assert_int_equal(one.turn, 6);
}

/* The step polls each that is due once, whatever that says. */
TEST(one_that_is_due_again_at_once_keeps_no_other_waiting)
{
    add_due(&one, 0);
    add(&two);
    step();
    expect_polls(1, 1);
    two.due_us = 100;
    fake_wake_in(&two, 0);
    for (unsigned i = 0; i != 10; i++) step();
    assert_int_equal(one.polls, 11);
    assert_in_range(two.polls, 2, 3);
}

/* The first poll and 16 at once, and then one each millisecond: not as many as a processor can do. */
static void spins_no_longer(void)
{
    const uint64_t begin_us = fake.now_us;
    for (unsigned i = 0; i != 17; i++) step();
    assert_int_equal(fake.now_us - begin_us, 0);
    for (unsigned i = 1; i != 1000; i++) {
        step();
        assert_int_equal(fake.now_us - begin_us, 1000 * i);
    }
}

TEST(one_that_is_due_at_once_without_end_does_not_spin)
{
    add_due(&one, 0);
    spins_no_longer();
    one.due_us = 100000; /* and once that is over it begins anew */
    fake_pass(200000);
    one.due_us = 0;
    fake_wake_in(&one, 0);
    spins_no_longer();
}

TEST(one_that_was_away_may_be_due_at_once_as_often_again)
{
    add_due(&one, 0);
    spins_no_longer();
    lose_one();
    one.is_lost = false;
    step(); /* open again */
    spins_no_longer();
}

/* hal.h: whatever is polled is polled at least every 71 minutes, 4294 s. */
TEST(a_source_that_waits_for_ever_is_polled_before_the_clock_has_wrapped)
{
    add_due(&one, FATHOM_NO_DEADLINE);
    add_due(&two, 4294000000u);
    step();
    for (unsigned hours = 0; hours != 10; hours++) {
        const unsigned before[] = {one.polls, two.polls};
        fake_pass(4294000000u);
        assert_true(one.polls > before[0] && two.polls > before[1]);
        assert_true(one.polls + two.polls - before[0] - before[1] < 8);
    }
}

/* ---- steps ---- */

TEST(a_step_sleeps_no_longer_than_it_may)
{
    add(&one);
    step();
    fathom_loop_step(&fake.loop, 300);
    assert_int_equal(fake.slept_us, 300);
    assert_int_equal(fake_elapsed_us(), 300);
    assert_int_equal(one.polls, 1);
    assert_int_equal(fathom_loop_due_us(&fake.loop), 999700);
    fathom_loop_step(&fake.loop, FATHOM_NO_DEADLINE);
    assert_int_equal(fake.slept_us, 999700);
}

TEST(without_a_source_a_step_sleeps_for_any_time)
{
    assert_int_equal(fathom_loop_due_us(&fake.loop), FATHOM_NO_DEADLINE);
    step();
    assert_int_equal(fake.slept_us, FATHOM_NO_DEADLINE);
    assert_int_equal(fathom_loop_fd(&fake.loop), -1);
}

TEST(what_is_overdue_is_due_in_no_time)
{
    add(&one);
    step();
    fake.now_us += 36000000000u; /* ten hours */
    assert_int_equal(fathom_loop_due_us(&fake.loop), 0);
    step();
    assert_int_equal(fake.slept_us, 0);
    assert_int_equal(one.polls, 2);
}

/* ---- adding and removing ---- */

TEST(a_source_that_is_removed_is_closed_and_not_polled_any_more)
{
    add(&one);
    add(&two);
    step();
    fathom_loop_remove(&one.source);
    assert_int_equal(one.closes, 1);
    fake_pass(5000000);
    expect_polls(1, 6);
}

TEST(what_is_added_twice_is_there_once)
{
    add(&one);
    add(&two);
    add(&one);
    add(&two);
    assert_int_equal(one.opens, 1);
    step();
    assert_int_equal(one.polls, 1);
    fathom_loop_remove(&one.source);
    fathom_loop_remove(&two.source);
    assert_null(fake.loop.sources);
    assert_null(fake.loop.due);
}

TEST(removing_what_is_not_there_does_nothing)
{
    fathom_loop_remove(&one.source);
    add(&one);
    fathom_loop_remove(&one.source);
    fathom_loop_remove(&one.source);
    assert_int_equal(one.closes, 1);
}

TEST(a_wake_of_what_is_not_open_does_nothing)
{
    one.cannot_open = true;
    add(&one);
    fathom_loop_wake(&one.source);
    fake_pass(100000);
    assert_int_equal(one.opens, 1);
}

TEST(deinit_closes_all_and_may_be_called_twice)
{
    add(&one);
    add(&two);
    two.is_lost = true;
    step();
    assert_int_equal(two.closes, 1);
    fathom_loop_deinit(&fake.loop);
    fathom_loop_deinit(&fake.loop);
    assert_int_equal(one.closes, 1);
    assert_int_equal(two.closes, 1);
    assert_null(fake.loop.sources);
}

TEST_IN(plain, an_argument_that_is_missing_is_said)
{
    static fathom_loop_line_t line;
    static const fathom_line_settings_t settings = {9600, FATHOM_PARITY_NONE, 1};
    static const fathom_line_settings_t wrong[] = {{0, FATHOM_PARITY_NONE, 1},
                                                   {9601, FATHOM_PARITY_NONE, 1},
                                                   {9600, 3, 1},
                                                   {9600, FATHOM_PARITY_NONE, 0}};
    fake_begin(0, 0);
    assert_int_equal(fathom_loop_init(NULL, NULL), FATHOM_POSIX_ERR_ARGUMENT);
    assert_int_equal(fathom_loop_add_line(NULL, &line, "x", &settings), FATHOM_POSIX_ERR_ARGUMENT);
    assert_int_equal(fathom_loop_add_line(&fake.loop, NULL, "x", &settings), FATHOM_POSIX_ERR_ARGUMENT);
    assert_int_equal(fathom_loop_add_line(&fake.loop, &line, NULL, &settings), FATHOM_POSIX_ERR_ARGUMENT);
    assert_int_equal(fathom_loop_add_line(&fake.loop, &line, "x", NULL), FATHOM_POSIX_ERR_ARGUMENT);
    for (unsigned i = 0; i != sizeof wrong / sizeof wrong[0]; i++)
        assert_int_equal(fathom_loop_add_line(&fake.loop, &line, "/nowhere", &wrong[i]),
                         FATHOM_POSIX_ERR_ARGUMENT);
    assert_null(fake.loop.sources);
    assert_int_equal(fake.count, 0);
}
