/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* line.h, FATHOM_ERR_PORT: "the port is broken; every queued transaction has ended with that. Go on polling and it
 * works again when the port does." */

static const suite_t suite = {.set_up = set_up};

static fathom_status_t after(uint32_t us)
{
    bench.fake.now_us += us;
    return fathom_line_poll(&bench.line);
}

static void break_and_repair(void)
{
    bench.fake.read_fails = true;
    assert_int_equal(after(100), FATHOM_ERR_PORT);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_PORT);
    bench.fake.read_fails = false;
}

TEST(a_unit_whose_request_the_port_had_not_taken_is_not_quarantined)
{
    bench.fake.write_busy = true;
    ask(&bench.request, 1, &bench.value, 0);
    after(T3_5_US);
    after(100);
    break_and_repair();
    bench.fake.write_busy = false;
    ask(&bench.request, 1, &bench.value, 0);
    after(T3_5_US);
    assert_int_equal(bench.fake.written, 1);
}

/* It may have gone out. */
TEST(a_unit_whose_request_was_leaving_is_quarantined)
{
    bench.fake.never_sent = true;
    ask(&bench.request, 1, &bench.value, 0);
    after(T3_5_US);
    assert_int_equal(bench.fake.written, 1);
    break_and_repair();
    bench.fake.never_sent = false;
    ask(&bench.request, 1, &bench.value, 0);
    after(8 * BYTE_US);
    after(T3_5_US);
    assert_int_equal(bench.fake.written, 1);
    receive(response_1_754, sizeof response_1_754);
    after(100);
    assert_int_equal(counter(FATHOM_LINE_LATE_RESPONSES), 1);
    after(T3_5_US);
    assert_int_equal(bench.fake.written, 2);
}

/* hal.h, write: "takes none and returns 0 because it is busy; < 0 when the port is broken". line.h, poll:
 * "FATHOM_ERR_PORT": from the poll that finds it. */
TEST(a_port_that_cannot_write_is_broken_at_the_first_try)
{
    bench.fake.write_fails = true;
    ask(&bench.request, 1, &bench.value, 0);
    assert_int_equal(after(T3_5_US), FATHOM_ERR_PORT);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_PORT);
    assert_int_equal(counter(FATHOM_LINE_PORT_ERRORS), 1);
}

TEST(a_port_that_takes_a_part_of_a_request_is_broken_at_the_first_try)
{
    bench.fake.write_too_short = true;
    ask(&bench.request, 1, &bench.value, 0);
    assert_int_equal(after(T3_5_US), FATHOM_ERR_PORT);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_PORT);
}

TEST(a_port_that_cannot_write_after_it_was_busy_is_broken_at_once)
{
    bench.fake.write_busy = true;
    ask(&bench.request, 1, &bench.value, 0);
    assert_int_equal(after(T3_5_US), FATHOM_PENDING);
    bench.fake.write_fails = true;
    assert_int_equal(after(100), FATHOM_ERR_PORT);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_PORT);
}

/* after_gap: "the line was seen to be silent": not by a port that was broken a moment ago. */
static unsigned heard;
static unsigned gaps;

static void hear(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                 uint32_t time_us)
{
    (void)listener, (void)bytes, (void)time_us;
    heard += count;
    gaps += after_gap;
}

/* line.h, rule 14: their age is not known, as after init. */
TEST(bytes_that_a_port_holds_when_it_works_again_are_dropped)
{
    fathom_listener_t listener = {.receive = hear, .gap_us = GAP_US};
    heard = 0;
    (void)fathom_line_replace_listener(&bench.line, &listener);
    bench.fake.read_fails = true;
    assert_int_equal(after(1000), FATHOM_ERR_PORT);
    receive(response_1_754, sizeof response_1_754);
    bench.fake.read_fails = false;
    after(100);
    assert_int_equal(heard, 0);
    expect_count(FATHOM_LINE_OLD_BYTES, sizeof response_1_754);
    receive(response_1_754, sizeof response_1_754);
    after(100);
    assert_int_equal(heard, 7);
}

TEST(the_first_bytes_of_a_port_that_works_again_are_after_no_gap)
{
    fathom_listener_t listener = {.receive = hear, .gap_us = GAP_US};
    heard = gaps = 0;
    (void)fathom_line_replace_listener(&bench.line, &listener);
    bench.fake.read_fails = true;
    assert_int_equal(after(1000), FATHOM_ERR_PORT);
    bench.fake.read_fails = false;
    after(100);
    receive(response_1_754, sizeof response_1_754);
    after(100);
    assert_int_equal(heard, 7);
    assert_int_equal(gaps, 0);
}
