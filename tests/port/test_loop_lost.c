/* SPDX-License-Identifier: MIT */
#include <poll.h>

#include "loop_three.h"

/* What fathom_loop.h does with a source that cannot be opened, or is lost, in simulated time. */

static const suite_t suite = {.set_up = set_up, .tear_down = fake_tear_down};

/* What was told, one after the other: so long after the beginning it was open, or not. */
static void assert_news(unsigned n, uint64_t at_us, bool is_open)
{
    assert_true(n < fake.count);
    assert_int_equal(fake.news[n].at_us, at_us);
    assert_int_equal(fake.news[n].is_open, is_open);
}

/* A source that cannot be opened is tried at these times. */
typedef struct {
    uint32_t first_pause_us, longest_pause_us;
    unsigned count;
    uint64_t at_us[8];
} pauses_t;

static void begin_closed(uint32_t first_pause_us, uint32_t longest_pause_us)
{
    (void)fake_tear_down(NULL);
    fake_begin(first_pause_us, longest_pause_us);
    one.cannot_open = true;
    add(&one);
}

static void is_tried(void **state)
{
    const pauses_t *const row = *state;
    begin_closed(row->first_pause_us, row->longest_pause_us);
    fake_pass(row->at_us[row->count - 1] + 1);
    assert_int_equal(one.opens, row->count);
    assert_int_equal(fake.count, row->count); /* once a pause */
    for (unsigned n = 0; n != fake.count; n++) assert_news(n, row->at_us[n], false);
    assert_int_equal(one.polls, 0);
    assert_int_equal(one.closes, 0);
}

static const pauses_t usual = {0, 0, 8, {0, 500000, 1500000, 3500000, 7500000, 15500000, 23500000, 31500000}};
static const pauses_t configs = {10000, 25000, 6, {0, 10000, 30000, 55000, 80000, 105000}};
/* 3e9 us twice is more than 32 bits have. */
static const pauses_t longer = {3000000000u, 4000000000u, 4, {0, 3000000000u, 7000000000u, 11000000000u}};
static const pauses_t cut_to_8_s = {9000000, 0, 2, {0, 8000000}}; /* the default */
TEST_ROW(one_that_cannot_be_opened_is_tried_after_500_ms_and_then_each_pause_is_twice_as_long_up_to_8_s,
         is_tried, &usual)
TEST_ROW(the_pauses_are_the_configs, is_tried, &configs)
TEST_ROW(long_pauses_do_not_wrap, is_tried, &longer)
TEST_ROW(a_first_pause_over_the_longest_is_the_longest, is_tried, &cut_to_8_s)

/* 2^32 - 1 us would be FATHOM_NO_DEADLINE: nothing is due at all. */
TEST(the_longest_pause_of_all_is_a_time_all_the_same)
{
    begin_closed(UINT32_MAX, UINT32_MAX);
    assert_int_equal(fathom_loop_due_us(&fake.loop), UINT32_MAX - 1u);
    step();
    assert_int_equal(one.opens, 1);
    step();
    assert_int_equal(one.opens, 2);
}

TEST(once_it_can_be_opened_that_is_told_and_it_is_polled)
{
    one.cannot_open = true;
    add(&one);
    fake_pass(1000000);
    one.cannot_open = false;
    fake_pass(1000000);
    assert_news(2, 1500000, true);
    assert_int_equal(fake.count, 3);
    assert_int_equal(one.polls, 1);
    assert_int_equal(one.polled_us - fake.begin_us, 1500000);
}

TEST(one_that_is_lost_is_closed_and_opened_again_after_the_first_pause)
{
    add(&one);
    fake_pass(2500000);
    lose_one(); /* 3 s */
    one.is_lost = false;
    assert_int_equal(one.closes, 1);
    assert_news(1, 3000000, false);
    assert_false(one.source.is_open);
    step();
    assert_news(2, 3500000, true);
    assert_int_equal(one.opens, 2);
}

/* 1 s is steady: less, and the pause goes on growing. */
TEST(one_that_was_open_for_less_than_a_second_gets_a_longer_pause)
{
    one.due_us = 999999;
    one.is_lost = true;
    add(&one);
    step(); /* lost at once: 500 ms */
    one.is_lost = false;
    step();
    step();     /* open at 500 ms, polled, and next a microsecond before 1.5 s */
    lose_one(); /* 1 s */
    assert_news(3, 1499999, false);
    one.is_lost = false;
    one.due_us = 1000000;
    step();
    assert_news(4, 2499999, true);
    step();
    lose_one(); /* after 1 s: 500 ms again */
    assert_news(5, 3499999, false);
    step();
    assert_news(6, 3999999, true);
}

/* ---- its sensors ---- */

static void expect_port_errors(unsigned of_first, unsigned of_second)
{
    assert_int_equal(first.port_errors, of_first);
    assert_int_equal(second.port_errors, of_second);
}

TEST(each_sensor_is_told_once_and_then_not_polled_until_it_is_back)
{
    add_with_sensors();
    fake_pass(1500000);
    one.is_lost = one.cannot_open = true;
    fake_pass(1);
    fake_wake_in(&one, 0);
    step();
    fake_pass(600000); /* it is tried in vain */
    const unsigned polls = first.polls;
    fake_pass(60000000);
    expect_port_errors(1, 1);
    assert_int_equal(first.polls, polls);
    one.is_lost = one.cannot_open = false;
    fake_pass(9000000);
    assert_true(first.polls > polls);
    assert_int_equal(first.port_errors, 1);
}

TEST(a_reading_that_it_still_had_comes_first)
{
    add_with_sensor();
    step();
    memcpy(first.script, (fathom_status_t[]){FATHOM_OK, FATHOM_OK, FATHOM_ERR_PORT},
           3 * sizeof first.script[0]);
    lose_one();
    assert_int_equal(first.readings, 2);
    assert_int_equal(first.errors, 0);
    assert_int_equal(first.port_errors, 1);
}

TEST(readings_without_end_do_not_put_the_loss_off)
{
    add_with_sensor();
    step();
    first.for_ever = FATHOM_OK;
    lose_one();
    assert_int_equal(first.port_errors, 1);
    assert_int_equal(first.readings, 16);
}

/* The sensor found it: a pin has nothing else that could. */
TEST(what_a_sensor_says_is_lost_is_lost_and_all_hear_it_once)
{
    add_with_sensors();
    step();
    second.script[0] = FATHOM_ERR_PORT;
    step();
    expect_port_errors(1, 1);
    assert_int_equal(fake_failures(&one), 1);
}

/* The pauses are those of a port that cannot be opened: 0.5, 1, 2, 4 and 8 s, then 8 s, which makes 9 errors in a
 * minute, one a pause; each sensor has one for all of it. */
TEST(a_sensor_that_says_so_without_end_is_an_error_a_pause_and_no_spin)
{
    add_with_sensors();
    first.for_ever = FATHOM_ERR_PORT;
    first.due_us = 0;
    fake_pass(60000000);
    expect_port_errors(1, 1);
    assert_in_range(fake_failures(&one), 9, 11);
    assert_int_equal(fake.count, fake_failures(&one) + 1); /* open at first */
    assert_in_range(first.polls, 9, 50);
    first.for_ever = FATHOM_PENDING;
    first.due_us = FATHOM_NO_DEADLINE;
    fake_pass(9000000);
    assert_true(one.source.is_open);
    assert_int_equal(first.port_errors, 1);
}

TEST(a_port_that_opens_and_fails_at_once_is_one_error_a_pause)
{
    one.is_lost = true;
    add(&one);
    fake_pass(60000000);
    assert_in_range(fake_failures(&one), 9, 11);
    assert_int_equal(one.opens, fake_failures(&one));
    assert_int_equal(one.closes, one.opens);
}

/* "Nothing for half a second" is no news of a sensor whose port was away. */
TEST(what_they_have_to_say_of_the_time_away_is_dropped)
{
    add_with_sensor();
    fake_pass(1500000);
    one.is_lost = true;
    fake_wake_in(&one, 0);
    step();
    one.is_lost = false;
    first.at = 0;
    memcpy(first.script, (fathom_status_t[]){FATHOM_ERR_STALE, FATHOM_OK, FATHOM_PENDING},
           3 * sizeof first.script[0]);
    fake_pass(600000);
    assert_true(one.source.is_open);
    assert_int_equal(first.readings, 0);
    assert_int_equal(first.errors, 0);
    assert_int_equal(first.at, 2);
}

TEST(a_sensor_that_never_ends_does_not_hold_up_the_opening)
{
    fake_sensor(&first, &one);
    fake_sensor(&second, &one);
    first.for_ever = FATHOM_ERR_STALE;
    add(&one);
    assert_true(one.source.is_open);
    assert_int_equal(first.polls, 16);
    assert_int_equal(second.polls, 1); /* it has nothing to say */
}

TEST(the_others_go_on)
{
    one.cannot_open = true;
    two.due_us = 10000;
    add(&one);
    add(&two);
    fake_pass(10000000);
    assert_in_range(two.polls, 1000, 1001);
    assert_int_equal(fake_failures(&two), 0);
}

static void add_two(fathom_status_t status)
{
    if (status == FATHOM_ERR_PORT) add(&two);
}

TEST(a_callback_of_a_loss_may_add_to_the_loop)
{
    add_with_sensor();
    first.when_taken = add_two;
    step();
    lose_one();
    step();
    assert_int_equal(two.polls, 1);
}

static void wake_one(fathom_status_t status) { fathom_loop_wake(&one.source); }

TEST(a_wake_of_what_is_being_lost_does_not_shorten_the_pause)
{
    add_with_sensor();
    first.when_taken = wake_one;
    step();
    lose_one();
    one.is_lost = false;
    const uint64_t lost_us = fake_elapsed_us();
    step();
    assert_int_equal(fake_elapsed_us() - lost_us, 500000);
}

TEST(what_is_lost_can_be_removed)
{
    one.is_lost = true;
    add(&one);
    step();
    fathom_loop_remove(&one.source);
    fake_pass(10000000);
    assert_int_equal(one.opens, 1);
    assert_int_equal(one.closes, 1);
}

/* ---- words ---- */

static fathom_status_t seen_status;
static char seen_text[32];

static void remember(fathom_status_t status)
{
    seen_status = status;
    (void)strncpy(seen_text, fathom_loop_error_text(&one.source), sizeof seen_text - 1);
}

TEST(the_reason_is_there_for_the_sensors_too)
{
    add_with_sensor();
    first.when_taken = remember;
    step();
    assert_string_equal(fathom_loop_error_text(&one.source), "");
    one.is_lost = true;
    one.text = "it was unplugged";
    step();
    assert_int_equal(seen_status, FATHOM_ERR_PORT);
    assert_string_equal(seen_text, "it was unplugged");
    one.is_lost = false;
    one.text = "";
    step();
    lose_one();
    assert_string_equal(seen_text, "it is lost");
}

static int fd_of_none(const fathom_loop_source_t *source) { return -1; }

TEST(a_kind_may_have_nothing_but_a_descriptor)
{
    static const fathom_loop_kind_t kind = {.fd = fd_of_none};
    one.source.kind = &kind;
    add(&one);
    assert_int_equal(one.source.events, POLLIN);
    fake_sensor(&first, &one);
    step();
    assert_int_equal(first.polls, 1);
    assert_string_equal(fathom_loop_error_text(&one.source), "");
    first.script[0] = FATHOM_ERR_PORT;
    fathom_loop_wake(&one.source);
    step();
    assert_string_equal(fathom_loop_error_text(&one.source), "it is lost");
    step();
    assert_true(one.source.is_open);
}
