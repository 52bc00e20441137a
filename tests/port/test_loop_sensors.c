/* SPDX-License-Identifier: MIT */
#include "loop_three.h"

/* What the sensors of fathom_loop.h say, and what their callbacks may do, in simulated time. */

static const suite_t suite = {.set_up = set_up, .tear_down = fake_tear_down};

/* ---- sensors ---- */

TEST(a_sensor_is_polled_until_it_has_nothing_more_and_all_is_taken)
{
    add_with_sensor();
    memcpy(first.script, (fathom_status_t[]){FATHOM_OK, FATHOM_OK, FATHOM_ERR_CHECKSUM, FATHOM_OK},
           4 * sizeof first.script[0]);
    step();
    assert_int_equal(first.readings, 3);
    assert_int_equal(first.errors, 1);
    assert_int_equal(first.polls, 5);
}

TEST(one_that_never_ends_keeps_no_other_waiting)
{
    add(&one);
    add(&two);
    fake_sensor(&first, &one);
    fake_sensor(&second, &one);
    first.for_ever = FATHOM_OK;
    second.script[0] = FATHOM_OK;
    fake_pass(1000000);
    assert_int_equal(second.readings, 1);
    assert_int_equal(two.polls, 2);
    /* 16 at a time; 16 times at once, and then each millisecond */
    assert_in_range(first.readings, 1000 * 16, 1020 * 16);
}

TEST(errors_without_end_do_not_spin_either)
{
    add_with_sensor();
    first.for_ever = FATHOM_ERR_STALE;
    first.due_us = 0;
    fake_pass(1000000);
    assert_in_range(first.errors, 1000 * 16, 1020 * 16);
}

/* More than a poll takes, and no due_us tells of it. */
TEST(many_readings_at_once_are_all_taken_without_waiting)
{
    add_with_sensor();
    for (unsigned i = 0; i != 40; i++) first.script[i] = FATHOM_OK;
    fake_pass(1);
    assert_int_equal(first.readings, 40);
}

TEST(a_sensor_that_is_added_later_is_polled_in_the_next_step)
{
    add(&one);
    step();
    fake_sensor(&first, &one);
    first.script[0] = FATHOM_OK;
    step_to(0);
    assert_int_equal(first.readings, 1);
}

/* Both are polled, and in the order in which they were added first. */
TEST(a_sensor_that_is_added_twice_is_there_once)
{
    add_with_sensors();
    fathom_loop_add_sensor(&one.source, &first.node);
    assert_ptr_equal(first.node.next, &second.node);
    fathom_loop_add_sensor(&one.source, &second.node);
    step();
    assert_int_equal(first.polls, 1);
    assert_int_equal(second.polls, 1);
    assert_ptr_equal(one.source.sensors, &first.node);
    assert_ptr_equal(first.node.next, &second.node);
    assert_null(second.node.next);
}

/* Whatever else is in its memory. */
TEST(fathom_loop_read_adds_a_sensor_in_one_line)
{
    fathom_loop_sensor_t node;
    fake_sensor(&first, &one);
    memset(&node, 0xA5, sizeof node);
    add(&two);
    fathom_loop_read(&two.source, &node, first.node.sensor, first.node.take, &first);
    first.script[0] = FATHOM_OK;
    first.script[1] = FATHOM_ERR_CHECKSUM;
    step();
    assert_int_equal(first.readings, 1);
    assert_int_equal(first.errors, 1);
    assert_ptr_equal(two.source.sensors, &node);
    fathom_loop_remove(&two.source);
}

TEST(sensors_may_be_there_before_their_source)
{
    fake_sensor(&first, &one);
    add(&one);
    first.script[0] = FATHOM_OK;
    step();
    assert_int_equal(first.readings, 1);
}

/* ---- callbacks ---- */

static void stop(fathom_status_t status) { fathom_loop_stop(&fake.loop); }

static void add_more(fathom_status_t status)
{
    if (status != FATHOM_OK || second.on != NULL) return;
    fake_sensor(&second, &one);
    second.script[0] = FATHOM_OK;
    second.when_taken = stop;
    add(&two);
    add(&three);
}

TEST(a_callback_may_add_to_the_loop_and_stop_it)
{
    memset(&second, 0, sizeof second);
    add_with_sensor();
    first.script[0] = FATHOM_OK;
    first.when_taken = add_more;
    fathom_loop_run(&fake.loop);
    assert_int_equal(second.readings, 1);
    step();
    assert_int_equal(two.polls, 1);
    assert_int_equal(three.polls, 1);
    assert_int_equal(fake_elapsed_us(), 0);
}

static void wake_one(fathom_status_t status) { fathom_loop_wake(&one.source); }

TEST(a_callback_may_wake_its_own_source)
{
    add_with_sensor();
    first.script[0] = FATHOM_OK;
    first.when_taken = wake_one;
    step();
    const unsigned before = one.polls;
    step_to(0);
    assert_int_equal(one.polls, before + 1);
}

static void wake_two(fathom_status_t status) { fathom_loop_wake(&two.source); }

TEST(a_callback_that_wakes_what_this_step_polls_anyway_adds_no_poll)
{
    add_due(&one, 1000);
    add_due(&two, 2000);
    fake_sensor(&first, &one);
    step();
    first.script[first.at] = FATHOM_OK;
    first.when_taken = wake_two;
    fake.now_us += 5000; /* both are due, `two` after `one` */
    step();
    assert_int_equal(first.readings, 1);
    assert_int_equal(two.polls, 2);
    step_to(6000);
    assert_int_equal(two.polls, 2);
}

static void add_sensor_to_two(fathom_status_t status)
{
    if (second.on != NULL) return;
    fake_sensor(&second, &two);
    second.script[0] = FATHOM_OK;
}

TEST(a_callback_may_add_a_sensor_to_another_source)
{
    memset(&second, 0, sizeof second);
    add(&one);
    add(&two);
    step();
    fake_sensor(&first, &one);
    first.script[0] = FATHOM_OK;
    first.when_taken = add_sensor_to_two;
    step();
    step_to(0);
    assert_int_equal(second.readings, 1);
}

static void step_inside(fathom_status_t status)
{
    step();
    fathom_loop_run(&fake.loop);
}

TEST(a_step_within_a_step_does_nothing)
{
    add_with_sensor();
    first.script[0] = FATHOM_OK;
    first.when_taken = step_inside;
    step();
    assert_int_equal(fake.loop.sleeps, 1);
    assert_int_equal(one.polls, 1);
}

/* ---- stop ---- */

TEST(a_stop_ends_the_run_and_the_loop_can_be_run_again)
{
    add_with_sensor();
    first.when_taken = stop;
    for (unsigned n = 1; n != 4; n++) {
        first.at = 0;
        first.script[0] = FATHOM_OK;
        fathom_loop_run(&fake.loop);
        assert_int_equal(first.readings, n);
    }
}
