/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* line.h: "Makes a line ready": whatever the memory held before. */

enum { FILLS = 2 };

static const uint8_t fills[FILLS] = {0xA5, 0xFF};

static void set_up_on(uint8_t fill)
{
    void *state;
    set_up(&state);
    bench.config.echo = FATHOM_LINE_ECHO_AUTO;
    memset(&bench.line, fill, sizeof bench.line);
    assert_int_equal(fathom_line_init(&bench.line, &bench.config), FATHOM_OK);
}

static void after(uint32_t us)
{
    bench.fake.now_us += us;
    assert_int_equal(fathom_line_poll(&bench.line), FATHOM_PENDING);
}

TEST(a_new_line_knows_of_nothing)
{
    for (unsigned i = 0; i != FILLS; i++) {
        set_up_on(fills[i]);
        for (unsigned c = 0; c != FATHOM_LINE_COUNTERS; c++) assert_int_equal(counter(c), 0);
        assert_true(fathom_line_is_idle(&bench.line));
        assert_false(fathom_line_is_queued(&bench.line, &bench.request.transaction));
        assert_int_equal(fathom_line_get_echo(&bench.line), FATHOM_LINE_ECHO_AUTO);
        expect_due(FATHOM_NO_DEADLINE);
        assert_int_equal(fathom_line_last_byte_us(&bench.line), bench.fake.now_us);
    }
}

/* 16 is the unit whose bit is the lowest; no unit is quarantined, so each is due after the silence, before any poll
 * too. */
TEST(the_first_request_waits_for_one_silence_and_nothing_else)
{
    static const uint8_t units[] = {1, 15, 16};
    for (unsigned i = 0; i != FILLS; i++)
        for (unsigned u = 0; u != sizeof units; u++) {
            set_up_on(fills[i]);
            ask(&bench.request, units[u], &bench.value, 0);
            expect_due(T3_5_US);
            after(T3_5_US - 1);
            expect_written(0);
            after(1);
            expect_written(1);
        }
}

TEST(the_first_response_is_complete_with_its_last_byte_and_shows_that_there_is_no_echo)
{
    for (unsigned i = 0; i != FILLS; i++) {
        set_up_on(fills[i]);
        ask_1_and_send(0);
        receive(response_1_754, sizeof response_1_754);
        after(0);
        expect_mm(754);
        assert_int_equal(fathom_line_get_echo(&bench.line), FATHOM_LINE_ECHO_OFF);
        assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), 0);
    }
}

/* "until twice the time-out has passed since the request": the second half of it after the time-out. */
TEST(the_first_quarantine_ends_in_its_time)
{
    for (unsigned i = 0; i != FILLS; i++) {
        set_up_on(fills[i]);
        ask_1(0);
        after(T3_5_US);
        after(8 * BYTE_US); /* sent */
        after(TIMEOUT_US);
        expect(FATHOM_ERR_NO_RESPONSE);
        ask_1(0);
        after(TIMEOUT_US - 1);
        expect_written(1);
        after(1);
        expect_written(2);
    }
}

/* after_gap: "the line was seen to be silent for at least gap_us before the first of them". */
static bool was_after_gap;
static unsigned heard;

static void hear(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                 uint32_t time_us)
{
    (void)listener, (void)bytes, (void)time_us;
    was_after_gap = after_gap;
    heard += count;
}

TEST(the_first_bytes_are_after_a_gap_only_if_it_was_seen)
{
    static const uint8_t bytes[] = {1, 2};
    fathom_listener_t listener = {.receive = hear, .gap_us = GAP_US};
    for (unsigned i = 0; i != FILLS; i++)
        for (unsigned is_gap = 0; is_gap != 2; is_gap++) {
            set_up_on(fills[i]);
            heard = 0;
            (void)fathom_line_replace_listener(&bench.line, &listener);
            after(is_gap != 0 ? GAP_US : GAP_US - 1);
            receive(bytes, sizeof bytes);
            after(1);
            assert_int_equal(heard, 2);
            assert_int_equal(was_after_gap, is_gap);
        }
}
