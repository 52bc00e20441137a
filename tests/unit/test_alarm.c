/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/processing/alarm.h"

enum {
    ON = FATHOM_ALARM_ON,
    OFF = FATHOM_ALARM_OFF,
    UNKNOWN = FATHOM_ALARM_UNKNOWN,
    NONE = FATHOM_ALARM_NO_RESPONSE
};
enum { S = 1000000 };

static fathom_alarm_config_t config;
static fathom_alarm_t alarm;
static uint32_t start_us;

static void start(void)
{
    memset(&alarm, 0x5A, sizeof alarm);
    assert_int_equal(fathom_alarm_init(&alarm, &config), FATHOM_OK);
    assert_int_equal(alarm.state, UNKNOWN);
}

/* A bumper: on under 500 mm, off over 600 mm, no hold times. */
static int set_up(void **state)
{
    static const fathom_alarm_config_t bumper = {
        .when = FATHOM_NEAR, .on_mm = 500, .off_mm = 600, .if_unknown = OFF, .if_no_response = OFF};
    config = bumper;
    start_us = UINT32_MAX - 1500000; /* every test goes through the wrap */
    start();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* So long after the start this comes, and then this is the state. The call returns whether it is another one. */
static void expect_kind(uint32_t at_us, uint8_t kind, uint16_t mm, uint8_t state)
{
    const fathom_sample_t sample = {.time_us = start_us + at_us, .kind = kind, .distance_mm = mm};
    const uint8_t before = alarm.state;
    assert_int_equal(fathom_alarm_add_sample(&alarm, &sample), state != before);
    assert_int_equal(alarm.state, state);
}

static void expect_mm(uint32_t at_us, uint16_t mm, uint8_t state)
{
    expect_kind(at_us, FATHOM_TARGET, mm, state);
}

static void expect_status(uint32_t at_us, fathom_status_t status, uint8_t state)
{
    const uint8_t before = alarm.state;
    assert_int_equal(fathom_alarm_add_status(&alarm, status, start_us + at_us), state != before);
    assert_int_equal(alarm.state, state);
}

static void expect_nothing(uint32_t at_us, uint8_t state) { expect_status(at_us, FATHOM_PENDING, state); }

/* ---- thresholds ---- */

typedef struct {
    uint8_t when, kind;
    uint16_t on_mm, off_mm, mm;
    uint8_t state; /* with this sample after OFF; BETWEEN: it holds, ON and OFF alike */
} side_row_t;

enum { BETWEEN = 0 };

static const side_row_t sides[] = {
    {FATHOM_NEAR, FATHOM_TARGET, 500, 600, 499, ON},
    {FATHOM_NEAR, FATHOM_TARGET, 500, 600, 500, BETWEEN},
    {FATHOM_NEAR, FATHOM_TARGET, 500, 600, 501, BETWEEN},
    {FATHOM_NEAR, FATHOM_TARGET, 500, 600, 599, BETWEEN},
    {FATHOM_NEAR, FATHOM_TARGET, 500, 600, 600, BETWEEN},
    {FATHOM_NEAR, FATHOM_TARGET, 500, 600, 601, OFF},
    {FATHOM_NEAR, FATHOM_TARGET, 500, 500, 499, ON},
    {FATHOM_NEAR, FATHOM_TARGET, 500, 500, 500, BETWEEN},
    {FATHOM_NEAR, FATHOM_TARGET, 500, 500, 501, OFF},
    {FATHOM_FAR, FATHOM_TARGET, 600, 500, 601, ON},
    {FATHOM_FAR, FATHOM_TARGET, 600, 500, 600, BETWEEN},
    {FATHOM_FAR, FATHOM_TARGET, 600, 500, 599, BETWEEN},
    {FATHOM_FAR, FATHOM_TARGET, 600, 500, 501, BETWEEN},
    {FATHOM_FAR, FATHOM_TARGET, 600, 500, 500, BETWEEN},
    {FATHOM_FAR, FATHOM_TARGET, 600, 500, 499, OFF},
    {FATHOM_FAR, FATHOM_TARGET, 500, 500, 501, ON},
    {FATHOM_FAR, FATHOM_TARGET, 500, 500, 500, BETWEEN},
    {FATHOM_FAR, FATHOM_TARGET, 500, 500, 499, OFF},
    /* what is no distance is beyond every threshold, also those that no distance passes */
    {FATHOM_NEAR, FATHOM_NEAR, 0, 0, 0, ON},
    {FATHOM_NEAR, FATHOM_TARGET, 0, 0, 0, BETWEEN},
    {FATHOM_NEAR, FATHOM_TARGET, 65535, 65535, 65535, BETWEEN},
    {FATHOM_NEAR, FATHOM_NO_TARGET, 65535, 65535, 0, OFF},
    {FATHOM_NEAR, FATHOM_FAR, 65535, 65535, 0, OFF},
    {FATHOM_FAR, FATHOM_NEAR, 0, 0, 0, OFF},
    {FATHOM_FAR, FATHOM_NO_TARGET, 65535, 65535, 0, ON},
    {FATHOM_FAR, FATHOM_FAR, 65535, 65535, 0, ON},
};

TEST(nearer_farther_and_between_are_what_the_header_says)
{
    for (unsigned i = 0; i != sizeof sides / sizeof *sides; i++) {
        const side_row_t *const row = &sides[i];
        config.when = row->when;
        config.on_mm = row->on_mm;
        config.off_mm = row->off_mm;
        for (uint8_t before = ON; before <= OFF; before++) {
            start();
            expect_kind(0, (before == ON) == (row->when == FATHOM_NEAR) ? FATHOM_NEAR : FATHOM_FAR, 0,
                        before);
            expect_kind(S, row->kind, row->mm, row->state == BETWEEN ? before : row->state);
        }
    }
}

TEST(a_config_without_sense_is_refused)
{
    for (unsigned value = 0; value <= 255; value++) {
        fathom_alarm_config_t other = config;
        other.off_mm = other.on_mm;
        other.when = (uint8_t)value;
        assert_int_equal(fathom_alarm_init(&alarm, &other),
                         value == FATHOM_NEAR || value == FATHOM_FAR ? FATHOM_OK : FATHOM_ERR_ARGUMENT);
        const fathom_status_t is_side = value == ON || value == OFF ? FATHOM_OK : FATHOM_ERR_ARGUMENT;
        other = config;
        other.if_unknown = (uint8_t)value;
        assert_int_equal(fathom_alarm_init(&alarm, &other), is_side);
        other = config;
        other.if_no_response = (uint8_t)value;
        assert_int_equal(fathom_alarm_init(&alarm, &other), is_side);
    }
}

/* ---- hold times ---- */

TEST(a_threshold_has_to_be_passed_for_its_hold_time)
{
    config.on_hold_us = 2 * S;
    config.off_hold_us = 3 * S;
    start();
    expect_mm(0, 499, UNKNOWN);
    expect_mm(2 * S - 1, 499, UNKNOWN);
    expect_mm(2 * S, 499, ON);
    expect_mm(4 * S, 601, ON);
    expect_mm(7 * S - 1, 601, ON);
    expect_mm(7 * S, 601, OFF);
    expect_mm(8 * S, 499, OFF);
    expect_mm(10 * S - 1, 499, OFF);
    expect_mm(10 * S, 499, ON);
}

/* 71.58 minutes are a turn of the clock: what is 71.6 minutes ago looks like 1 s ago, less than the hold time. */
TEST(a_state_that_has_lasted_for_a_turn_of_the_clock_stays)
{
    config.on_hold_us = 4 * S;
    start();
    expect_mm(0, 499, UNKNOWN);
    expect_mm(4 * S, 499, ON);
    for (uint32_t s = 5; s != 4300; s++) expect_mm(s * S, 499, ON);
    expect_mm((uint32_t)4300 * S, 601, OFF);
    expect_mm((uint32_t)4301 * S, 499, OFF);
    expect_mm((uint32_t)4305 * S - 1, 499, OFF);
    expect_mm((uint32_t)4305 * S, 499, ON);
}

/* ---- not known ---- */

TEST(without_a_distance_for_more_than_unknown_us_it_is_not_known)
{
    for (uint32_t s = 5; s <= 1000; s += 995) {
        config.unknown_us = s != 5 ? s * S : 0;
        start();
        expect_mm(0, 499, ON);
        expect_nothing(s * S, ON);
        expect_nothing(s * S + 1, UNKNOWN);
        expect_nothing(s * S + 2, UNKNOWN);
        expect_mm(s * S + 3, 601, OFF);
        expect_kind(2 * s * S, FATHOM_FAULT, 0, OFF);
        expect_mm(2 * s * S + 3, 500, OFF); /* between the thresholds is a distance as well */
        expect_kind(3 * s * S + 3, FATHOM_FAULT, 0, OFF);
        expect_kind(3 * s * S + 4, FATHOM_FAULT, 0, UNKNOWN);
    }
}

typedef struct {
    fathom_status_t status;
    bool responds;
} response_row_t;

static const response_row_t responses[] = {
    {FATHOM_OK, true}, /* of another probe */
    {FATHOM_ERR_MALFORMED, true},
    {FATHOM_ERR_EXCEPTION, true},
    {FATHOM_ERR_WARMING_UP, true},
    {FATHOM_ERR_ARGUMENT, false},
    {FATHOM_ERR_PORT, false},
    {FATHOM_ERR_NO_RESPONSE, false},
    {FATHOM_ERR_CHECKSUM, false},
    {FATHOM_ERR_STALE, false},
    {FATHOM_ERR_CANCELLED, false},
    {FATHOM_ERR_BUSY, false},
    {FATHOM_ERR_CAPACITY, false},
    {FATHOM_ERR_ECHO, false},
    {FATHOM_ERR_UNSUPPORTED, false},
    {FATHOM_ERR_UNCONFIRMED, false},
    {FATHOM_ERR_IN_USE, false},
};

TEST(each_status_shows_that_the_device_responds_or_that_it_does_not)
{
    for (unsigned i = 0; i != sizeof responses / sizeof *responses; i++) {
        const fathom_status_t status = responses[i].status;
        const uint8_t then = responses[i].responds ? UNKNOWN : NONE;
        start();
        expect_mm(0, 499, ON);
        expect_status(5 * S, status, ON); /* and puts nothing off */
        expect_nothing(5 * S + 1, then);
        expect_kind(6 * S, FATHOM_FAULT, 0, UNKNOWN);
        expect_status(7 * S, status, then); /* at once */
        expect_nothing(9 * S, then);
        expect_status(10 * S, FATHOM_ERR_NO_RESPONSE, NONE);
        expect_status(10 * S, status, then);
    }
}

/* status.h: "FATHOM_ERR_LINE_BUSY and FATHOM_ERR_OTHER_MASTER say nothing about the unit". */
TEST(a_busy_line_and_another_master_leave_it_open_whether_the_device_responds)
{
    static const fathom_status_t statuses[] = {FATHOM_ERR_LINE_BUSY, FATHOM_ERR_OTHER_MASTER};
    for (unsigned i = 0; i != sizeof statuses / sizeof *statuses; i++) {
        start();
        expect_mm(0, 499, ON);
        expect_kind(6 * S, FATHOM_FAULT, 0, UNKNOWN);
        expect_status(7 * S, statuses[i], UNKNOWN);
        expect_status(8 * S, FATHOM_ERR_NO_RESPONSE, NONE);
        expect_status(9 * S, statuses[i], NONE);
    }
}

TEST(samples_without_a_distance_show_that_the_device_responds)
{
    static const uint8_t kinds[] = {FATHOM_FAULT, FATHOM_UNKNOWN, FATHOM_NO_TARGET, 0, 7};
    config.no_target_is_unknown = true;
    for (unsigned i = 0; i != sizeof kinds; i++) {
        start();
        expect_mm(0, 499, ON);
        expect_status(S, FATHOM_ERR_NO_RESPONSE, ON);
        expect_kind(5 * S, kinds[i], 0, ON);
        expect_kind(5 * S + 1, kinds[i], 0, UNKNOWN);
        expect_status(6 * S, FATHOM_ERR_NO_RESPONSE, NONE);
        expect_kind(7 * S, kinds[i], 0, UNKNOWN);
        expect_kind(8 * S, FATHOM_FAR, 0, OFF); /* of a switch, or of a median: a distance */
    }
}

/* In a silence as long as half a turn of the clock and longer, too: 4295 s are a turn. */
TEST(unknown_and_no_response_follow_what_came_last_for_hours)
{
    expect_mm(0, 499, ON);
    expect_nothing(6 * S, UNKNOWN);
    for (uint32_t s = 1000; s != 20000; s += 1000) {
        expect_status(s * S, FATHOM_ERR_NO_RESPONSE, NONE);
        expect_nothing(s * S, NONE);
        expect_kind(s * S, FATHOM_FAULT, 0, UNKNOWN);
        expect_nothing(s * S + 1, UNKNOWN);
    }
    expect_mm((uint32_t)20000 * S, 500, ON);
}

/* ---- from init on ---- */

TEST(from_init_on_it_is_unknown_and_after_unknown_us_what_came_tells)
{
    expect_nothing(0, UNKNOWN);
    expect_nothing(5 * S, UNKNOWN);
    expect_nothing(5 * S + 1, NONE); /* nothing has come */
    start();
    expect_status(0, FATHOM_ERR_WARMING_UP, UNKNOWN);
    expect_nothing(5 * S + 1, UNKNOWN);
    start();
    expect_status(0, FATHOM_ERR_NO_RESPONSE, UNKNOWN);
    expect_kind(4 * S, FATHOM_FAULT, 0, UNKNOWN);
    expect_status(5 * S, FATHOM_ERR_NO_RESPONSE, UNKNOWN);
    expect_status(5 * S + 1, FATHOM_ERR_NO_RESPONSE, NONE);
    start();
    expect_kind(0, FATHOM_FAULT, 0, UNKNOWN);
    expect_status(5 * S, FATHOM_ERR_NO_RESPONSE, UNKNOWN);
    expect_nothing(5 * S + 1, NONE);
}

/* ---- out of it ---- */

TEST(between_the_thresholds_is_the_state_before_at_once)
{
    config.on_hold_us = S;
    config.off_hold_us = S;
    for (uint8_t before = ON; before <= OFF; before++) {
        start();
        expect_mm(0, before == ON ? 499 : 601, UNKNOWN);
        expect_mm(S, before == ON ? 499 : 601, before);
        expect_nothing(7 * S, UNKNOWN);
        expect_mm(7 * S, 550, before);
        expect_status(8 * S, FATHOM_ERR_NO_RESPONSE, before);
        expect_nothing(13 * S, NONE);
        expect_mm(13 * S, before == ON ? 601 : 499, NONE); /* the other one, but not for its hold time */
        expect_mm(14 * S - 1, 550, before);
    }
}

/* ---- is it on ---- */

TEST(it_is_on_by_the_state_or_by_the_side_that_was_chosen_for_it)
{
    for (int i = 0; i != 4; i++) {
        config.if_unknown = (i & 1) != 0 ? ON : OFF;
        config.if_no_response = (i & 2) != 0 ? ON : OFF;
        start();
        assert_int_equal(fathom_alarm_is_on(&alarm), (i & 1) != 0);
        expect_mm(0, 499, ON);
        assert_true(fathom_alarm_is_on(&alarm));
        expect_mm(S, 601, OFF);
        assert_false(fathom_alarm_is_on(&alarm));
        expect_nothing(7 * S, UNKNOWN);
        assert_int_equal(fathom_alarm_is_on(&alarm), (i & 1) != 0);
        expect_status(8 * S, FATHOM_ERR_NO_RESPONSE, NONE);
        assert_int_equal(fathom_alarm_is_on(&alarm), (i & 2) != 0);
    }
}

TEST(between_the_thresholds_with_nothing_before_it_is_as_chosen_for_unknown)
{
    static const uint8_t chosen[] = {ON, OFF};
    for (unsigned i = 0; i != 2; i++) {
        config.if_unknown = chosen[i];
        start();
        expect_mm(0, 550, chosen[i]);
    }
}

TEST(a_time_before_the_distance_is_not_too_long)
{
    expect_mm(10 * S, 700, OFF);
    expect_nothing(9 * S, OFF);
    start();
    expect_mm(0, 700, OFF);
    expect_nothing(UINT32_MAX / 2 + 1, OFF);
    expect_nothing(UINT32_MAX / 2, UNKNOWN);
}
