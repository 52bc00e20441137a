/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/*
 * Bytes that come between the poll's look at the clock and its read of the port, because an interrupt stamps them or a
 * task of higher priority runs there: their time is in the future of that look.
 */

static int (*read_at_once)(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx);
static uint32_t between_us; /* passes before a read that finds something then */
static uint32_t
    ahead_us; /* of the clock when the read returns: a stamp from the future whatever is looked at */
static bool has_stamps;
static uint32_t stamp_us; /* of the last byte */

static int read_later(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    fake_t *const fake = ctx;
    const uint32_t sampled_us = fake->now_us;
    fake->now_us += between_us;
    const int n = read_at_once(ctx, bytes, capacity, rx);
    if (n == 0) {
        fake->now_us = sampled_us;
        return 0;
    }
    stamp_us = fake->now_us + ahead_us;
    if (has_stamps) {
        rx->flags |= FATHOM_RX_TIMED;
        rx->last_us = stamp_us;
    }
    return n;
}

static int set_up_late(void **state)
{
    (void)set_up(state);
    read_at_once = bench.fake.uart.read;
    bench.fake.uart.read = read_later;
    between_us = ahead_us = 0;
    has_stamps = true;
    return 0;
}

static const suite_t suite = {.set_up = set_up_late};

/* One poll right when a byte has come. */
static void poll_with(const uint8_t *byte)
{
    bench.fake.now_us += BYTE_US;
    fake_receive(&bench.fake, between_us, byte, 1);
    (void)poll_line();
}

static void begin_at(uint32_t now_us, void **state)
{
    (void)set_up_late(state);
    bench.fake.now_us = now_us;
    bench.fake.busy_until_us = now_us;
    assert_int_equal(fathom_line_init(&bench.line, &bench.config), FATHOM_OK);
}

/* At 9600 baud a byte takes 1042 us; the interrupt of any of the seven may come so late. */
TEST(a_time_stamp_from_the_future_leaves_a_good_response_whole)
{
    static const uint32_t starts_us[] = {1000, UINT32_MAX - 20000};
    for (unsigned i = 0; i != 2 * 7 * 2; i++) {
        begin_at(starts_us[i / 14], state);
        ask_1_and_send(0);
        bench.fake.now_us += 9000;
        for (unsigned at = 0; at != 7; at++) {
            expect(FATHOM_PENDING);
            between_us = at == i / 2 % 7 && i % 2 == 0 ? 3 : 0;
            ahead_us = at == i / 2 % 7 && i % 2 != 0 ? 3 : 0;
            poll_with(response_1_754 + at);
        }
        expect_mm(754);
        /* the sample's time: the stamp, or the clock where the stamp is later than that */
        assert_int_equal(bench.request.transaction.link.heard_us, stamp_us - ahead_us);
        assert_int_equal(fathom_line_last_byte_us(&bench.line), stamp_us - ahead_us);
    }
}

TEST(a_time_stamp_in_the_past_is_believed)
{
    ask_1_and_send(0);
    ahead_us = (uint32_t)-700;
    bench.fake.now_us += 9000;
    receive(response_1_754, 7);
    (void)poll_line();
    expect(FATHOM_OK);
    assert_int_equal(bench.request.transaction.link.heard_us, bench.fake.now_us - 700);
}

/* 35 minutes and 47 s are the border between the two; what a line tells of the past ends after 65 ms anyway. */
TEST(a_time_stamp_half_way_round_the_clock_is_in_the_future)
{
    for (uint32_t ago_us = INT32_MAX; ago_us <= UINT32_C(0x80000000); ago_us++) {
        ahead_us = (uint32_t)-ago_us;
        bench.fake.now_us += 9000;
        receive(response_1_754, 7);
        (void)poll_line();
        const uint32_t told_us = ago_us == INT32_MAX ? UINT16_MAX : 0;
        assert_int_equal(bench.fake.now_us - fathom_line_last_byte_us(&bench.line), told_us);
    }
}

/* The loop has slept for 9 s, and a unit that sends by itself has filled the port's buffer, a read each frame. */
TEST(no_request_leaves_while_the_port_may_hold_bytes_from_before_it)
{
    ahead_us = (uint32_t)-9000000;
    run(T3_5_US);
    ask_1(0);
    for (unsigned read = 0; read != 40; read++) fake_receive(&bench.fake, read + 1, response_1_754, 7);
    bench.fake.now_us += 100;
    for (unsigned poll = 0; poll != 2; poll++) {
        (void)poll_line();
        expect_written(0);
        assert_false(fake_drained(&bench.fake));
        expect_due(T3_5_US); /* no silence is known */
    }
    run(T3_5_US); /* the third finds the end of it, and the last stamp is older than any silence */
    assert_true(fake_drained(&bench.fake));
    expect_written(1);
}

/* Another task has run for 20 ms; without stamps the bytes may be as new as the read. */
TEST(the_silence_before_a_request_is_counted_from_a_byte_that_came_after_the_look_at_the_clock)
{
    for (unsigned i = 0; i != 2; i++) {
        (void)set_up_late(state);
        has_stamps = i == 0;
        ask_1_and_send(0);
        ask_other(2);
        bench.fake.now_us += 9000;
        between_us = 20000;
        fake_receive(&bench.fake, between_us, response_1_754, 7);
        (void)poll_line();
        between_us = 0;
        expect(FATHOM_OK);
        run(T3_5_US - 100);
        expect_written(1);
        run(200);
        expect_written(2);
        assert_true(bench.fake.writes[1].at_us - stamp_us >= T3_5_US);
    }
}

TEST(a_frame_is_not_split_where_its_first_bytes_came_after_the_look_at_the_clock)
{
    for (unsigned i = 0; i != 2; i++) {
        (void)set_up_late(state);
        has_stamps = i == 0;
        ask_1_and_send(0);
        bench.fake.now_us += 9000;
        between_us = 2 * GAP_US;
        fake_receive(&bench.fake, between_us, response_1_754, 4);
        (void)poll_line();
        between_us = 0;
        run(1000);
        expect(FATHOM_PENDING);
        assert_true(fathom_line_due_us(&bench.line) <= GAP_US - 1000);
        receive(response_1_754 + 4, 3);
        run(100);
        expect_mm(754);
    }
}

TEST(a_listener_is_told_the_stamp_and_of_no_silence_that_was_not)
{
    listen_for(5000);
    between_us = 2 * GAP_US;
    poll_with(response_1_754);
    assert_int_equal(bench_listener.length, 1);
    assert_int_equal(bench_listener.time_us, stamp_us);
    between_us = 0;
    run(1000);
    poll_with(response_1_754 + 1);
    assert_int_equal(bench_listener.length, 2);
    assert_int_equal(bench_listener.gaps, 0);
}

/* Every read of noise takes half of the time. */
TEST(the_time_that_a_read_takes_counts_against_the_time_out)
{
    static const uint8_t noise = 0x55;
    ask_1_and_send(0);
    const uint32_t left_us = bench.fake.now_us;
    between_us = BYTE_US;
    while (status_of(&bench.request) == FATHOM_PENDING) {
        assert_true(bench.fake.now_us - left_us < 2 * TIMEOUT_US);
        poll_with(&noise);
    }
    expect(FATHOM_ERR_NO_RESPONSE);
    assert_in_range(bench.fake.now_us - left_us, TIMEOUT_US - 400, TIMEOUT_US + 2 * BYTE_US);
    /* and against the quarantine: another time-out from here */
    assert_in_range(bench.line.quarantine_left_us, TIMEOUT_US - 2 * BYTE_US, TIMEOUT_US);
    for (unsigned i = 0; i != TIMEOUT_US / (2 * BYTE_US) + 1; i++) {
        assert_true(bench.line.quarantined_units != 0);
        poll_with(&noise);
    }
    assert_int_equal(bench.line.quarantined_units, 0);
}
