/* SPDX-License-Identifier: MIT */
#include "line_conversation.h"

/* The figures of line.h and hal.h, to the microsecond and to the byte. */

static const suite_t suite = {.set_up = set_up};

/* Time passes in one step, which a poll ends. */
static fathom_status_t after(uint32_t us)
{
    bench.fake.now_us += us;
    return fathom_line_poll(&bench.line);
}

#define GAP(new_us)        STEP(gap, .us = (new_us)) /* of the config */
#define WRITE_WITHOUT_TIME STEP(write_without_time, .which = A)

static void play_gap(const step_t *step) { bench.config.gap_us = (uint16_t)step->us; }

/* A write to all units that waits for nothing. */
static void play_write_without_time(const step_t *step)
{
    fathom_modbus_write_single_register(&request_of(step)->message, 0, 0x0200, 5);
    request_of(step)->transaction.timeout_us = 0;
    assert_int_equal(fathom_modbus_client_submit(&bench.line, request_of(step)), FATHOM_PENDING);
}

static const conversation_t conversations[] = {
    /* fathom_line_parts_t: "silence_us ... 0: 4011" */
    ROW("the_default_silence_is_4011_us", COUNTS(0), SILENCE(0), QUEUE(A, 1), POLL_AFTER(4010), WRITTEN(0),
        POLL_AFTER(1), WRITTEN(1)),
    /* silent_us stops at 65535, which is the longest silence that a config can name */
    ROW("the_longest_silence_of_a_config_is_kept_and_over", COUNTS(0), SILENCE(65535), QUEUE(A, 1),
        POLL_AFTER(65534), WRITTEN(0), POLL_AFTER(1), WRITTEN(1)),
    /* fathom_line_parts_t: "more than a slow sender or a slow port pauses: 25000 behind an operating system" */
    ROW("a_pause_shorter_than_the_gap_of_the_config_does_not_end_a_response", COUNTS(.responses = 1),
        GAP(25000), ASK(A, 1), ARRIVE("01 03 02 02"), POLL_AFTER(100), POLL_AFTER(24999), ARRIVE("F2 38 A1"),
        POLL, READS(A, 754)),
    /* the silence counts from the poll that finds the request sent, also where nothing is to be waited for */
    ROW("the_silence_after_a_broadcast_is_kept_to_its_end", COUNTS(0), WRITE_WITHOUT_TIME, QUEUE(B, 2),
        POLL_AFTER(T3_5_US), WRITTEN(1), POLL_AFTER(8 * BYTE_US), POLL_AFTER(T3_5_US - 1), ENDS(A, FATHOM_OK),
        WRITTEN(1), POLL_AFTER(1), WRITTEN(2)),
};
CONVERSATIONS(set_up, conversations)

/* FATHOM_LINE_SEND_US: "how long a port may refuse a request, or take to send it, before it counts as broken"; and
 * fathom_line_poll: "FATHOM_ERR_PORT: the port is broken", in that very call. */
TEST(a_port_has_a_second_to_take_a_request)
{
    bench.fake.write_busy = true;
    ask_1(0);
    after(T3_5_US);
    assert_int_equal(after(999999), FATHOM_PENDING);
    expect(FATHOM_PENDING);
    assert_int_equal(after(1), FATHOM_ERR_PORT);
    expect(FATHOM_ERR_PORT);
}

/* A poll is cheap while nothing comes: of the 16 reads that it may do the first tells it. */
TEST(a_poll_that_finds_nothing_reads_the_port_once)
{
    after(100);
    assert_int_equal(bench.fake.reads, 1);
    ask_1_and_send(0);
    bench.fake.reads = 0;
    after(100);
    assert_int_equal(bench.fake.reads, 1);
}

/* The longest time-out is 2^31 - 1 us, 35 minutes: twice that, the quarantine, fits the clock. */

#define LONGEST_US UINT32_C(0x7FFFFFFF)

static fathom_status_t ask_for(uint32_t timeout_us)
{
    fathom_modbus_read_holding_registers(&bench.request.message, 1, 0x0100, 1, &bench.value);
    bench.request.transaction.timeout_us = timeout_us;
    bench.request.transaction.retries = 0;
    return fathom_modbus_client_submit(&bench.line, &bench.request);
}

TEST(a_unit_is_quarantined_for_twice_the_longest_time_out)
{
    assert_int_equal(ask_for(LONGEST_US), FATHOM_PENDING);
    run(T3_5_US + 200);
    expect_written(1);
    fathom_line_cancel(&bench.line, &bench.request.transaction); /* while it leaves */
    after(10000);                                                /* now it has left */
    assert_true(bench.line.quarantine_left_us == 2 * LONGEST_US);

    assert_int_equal(ask_for(1000), FATHOM_PENDING);
    assert_true(fathom_line_due_us(&bench.line) == 2 * LONGEST_US);
    for (unsigned i = 0; i != 2; i++) after(LONGEST_US - 1000);
    expect_written(1);
    after(2000);
    expect_written(2);
}

TEST(a_time_out_over_the_longest_is_refused_and_not_cut)
{
    static const uint32_t too_long_us[] = {LONGEST_US + 1, UINT32_C(0x90000000), UINT32_MAX};
    for (unsigned i = 0; i != 3; i++) {
        bench.request.transaction.status = FATHOM_OK;
        assert_int_equal(ask_for(too_long_us[i]), FATHOM_ERR_ARGUMENT);
        expect(FATHOM_OK);
        assert_false(fathom_line_is_queued(&bench.line, &bench.request.transaction));
    }
    run(T3_5_US + 200);
    expect_written(0);
}

/* ---- long frames ---- */

/* 123 registers: 9 + 246 = 255. hal.h: write returns the length, which is an int. The CRC of the response was worked out
 * apart, bit by bit. */
TEST(a_request_of_255_bytes_goes_out_and_is_acknowledged)
{
    static uint8_t long_frame[255];
    static uint16_t registers[123];
    bench.config.frame = long_frame;
    bench.config.frame_size = sizeof long_frame;
    fathom_modbus_write_multiple_registers(&bench.request.message, 1, 0x0100, 123, registers);
    submit(&bench.request);
    assert_int_equal(after(T3_5_US), FATHOM_PENDING);
    expect_written(1);
    assert_int_equal(bench.fake.writes[0].length, 255);
    after(255uL * BYTE_US);
    receive_hex("01 10 01 00 00 7B 81 D6");
    after(100);
    expect(FATHOM_OK);
}

/* ---- a port of the test's own ---- */

static fathom_uart_t uart;

static void set_up_uart(void)
{
    uart = bench.fake.uart;
    bench.config.uart = &uart;
}

/* hal.h: "< 0", of an int: -256 is 0 in its low byte. */
static int set_line_fails(void *ctx, const fathom_line_settings_t *settings)
{
    (void)ctx, (void)settings;
    return -256;
}

TEST(every_negative_result_of_set_line_means_unsupported)
{
    static const fathom_line_settings_t settings = {9600, FATHOM_PARITY_NONE, 1};
    set_up_uart();
    uart.set_line = set_line_fails;
    bench.request.transaction.line_settings = &settings;
    ask_1(0);
    after(4011); /* fathom_silence_us() of 9600 baud: 38.5 / 9600 is 4010.4 us */
    expect(FATHOM_ERR_UNSUPPORTED);
    expect_written(0);
}

static int set_break_fails(void *ctx, bool on)
{
    (void)ctx, (void)on;
    return -256;
}

TEST(every_negative_result_of_set_break_means_a_broken_port)
{
    set_up_uart();
    uart.set_break = set_break_fails;
    assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_ERR_PORT);
}

/* hal.h, read: "rx comes zeroed". */
static unsigned rx_reads;

static int read_and_look(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    (void)ctx, (void)bytes, (void)capacity;
    assert_int_equal(rx->last_us, 0);
    assert_int_equal(rx->flags, 0);
    rx_reads++;
    return 0;
}

TEST(a_port_gets_rx_zeroed)
{
    rx_reads = 0;
    set_up_uart();
    uart.read = read_and_look;
    after(100);
    assert_int_equal(rx_reads, 1);
}

/* hal.h, read: "at most capacity bytes": of the 32 of the frame 5 are taken. */
static int read_the_rest(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    (void)ctx, (void)bytes, (void)rx;
    assert_ptr_equal(bytes, bench.frame + 5);
    assert_int_equal(capacity, sizeof bench.frame - 5);
    return 0;
}

TEST(a_port_is_asked_for_no_more_than_there_is_room_for)
{
    ask_1_and_send(0);
    deliver(response_1_754, 5);
    set_up_uart();
    uart.read = read_the_rest;
    after(100);
}
