/* SPDX-License-Identifier: MIT */
#include "bench.h"
#include "fake.h"
#include "fathom/fathom.h"

/* What is due while the line holds part of a frame: a program that sleeps as long as it may does not spin, and a
 * stream is not told of a silence that there was not. Bytes come when the test says so. */

enum { MS = 1000 };

static fake_t fake;
static uint8_t frame[32];
static fathom_line_parts_t config;
static fathom_line_t line;
static uint16_t value;
static fathom_modbus_request_t request;

static void set_desk(void)
{
    fake_init(&fake);
    fake.now_us = fake.busy_until_us = bench_start_us;
    memset(&request, 0, sizeof request);
    config = (fathom_line_parts_t){.uart = &fake.uart,
                                   .clock = &fake.clock,
                                   .frame = frame,
                                   .frame_size = sizeof frame,
                                   .find_echo = fathom_line_find_echo,
                                   .marks = fathom_line_marks};
    assert_int_equal(fathom_line_init(&line, &config), FATHOM_OK);
}

/* Time passes, then these bytes come, the last of them just now, and the line looks. */
static void come(uint32_t by_us, const uint8_t *bytes, size_t count)
{
    fake.now_us += by_us;
    const fathom_rx_t rx = {.flags = FATHOM_RX_TIMED, .last_us = fake.now_us};
    if (count != 0) fake_receive_rx(&fake, 0, bytes, count, rx);
    assert_int_equal(fathom_line_poll(&line), FATHOM_PENDING);
}
static void pass(uint32_t by_us) { come(by_us, NULL, 0); }

/* Unit 1 is asked for one register; the request has left. */
static void ask(void)
{
    request.transaction.timeout_us = 100 * MS;
    fathom_modbus_read_holding_registers(&request.message, 1, 0x0101, 1, &value);
    assert_int_equal(fathom_modbus_client_submit(&line, &request), FATHOM_PENDING);
    pass(20 * MS);
    pass(10 * MS);
    assert_int_equal(request.transaction.attempts, 1);
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(a_time_out_in_mid_response_is_due_when_the_response_has_broken_off)
{
    set_desk();
    ask();
    assert_int_equal(fathom_line_due_us(&line), 100 * MS);
    come(99 * MS, LITERAL(0x01, 0x03, 0x02));
    assert_int_equal(fathom_line_due_us(&line), 5 * MS); /* the default gap_us */
    pass(2 * MS);                                        /* the time-out has passed; the response may go on */
    assert_int_equal(request.transaction.status, FATHOM_PENDING);
    assert_int_equal(fathom_line_due_us(&line), 3 * MS);
    pass(3 * MS);
    assert_int_equal(request.transaction.status, FATHOM_ERR_CHECKSUM);
}

TEST(a_request_behind_part_of_a_late_response_is_due_when_that_has_broken_off)
{
    fathom_modbus_request_t other = {.transaction = {.timeout_us = 100 * MS}};
    set_desk();
    ask();
    pass(100 * MS);
    assert_int_equal(request.transaction.status, FATHOM_ERR_NO_RESPONSE); /* the unit is quarantined */
    come(10 * MS, LITERAL(0x01, 0x03, 0x02));
    fathom_modbus_read_holding_registers(&other.message, 2, 0x0101, 1, &value);
    assert_int_equal(fathom_modbus_client_submit(&line, &other), FATHOM_PENDING);
    pass(4500); /* over the silence of 4011 us before a request, under the gap of 5 ms */
    assert_int_equal(other.transaction.attempts, 0);
    assert_int_equal(fathom_line_due_us(&line), 500);
    pass(500);
    assert_int_equal(other.transaction.attempts, 1);
}

static fathom_a16_auto_t a16;
static fathom_sensor_t sensor;
static fathom_sample_t sample;

/* FF 02 EF F0 (751 mm) and perhaps more after a silence, while unit 1 is asked. */
static void hear_frame(const uint8_t *bytes, size_t count)
{
    set_desk();
    assert_int_equal(fathom_a16_auto_init(&a16, &line, NULL), FATHOM_OK);
    sensor = fathom_a16_auto_sensor(&a16);
    ask();
    pass(10 * MS);
    come(20 * MS, bytes, count);
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_PENDING);
}

TEST(a_silence_behind_a_frame_gives_it_also_with_an_open_transaction)
{
    hear_frame(LITERAL(0xFF, 0x02, 0xEF, 0xF0));
    assert_int_equal(fathom_due_us(&sensor, 1), 5 * MS);
    fake.now_us += 5 * MS;
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_OK);
    assert_int_equal(sample.distance_mm, 751);
}

TEST(bytes_that_the_line_holds_back_are_no_silence_behind_a_frame)
{
    hear_frame(LITERAL(0xFF, 0x02, 0xEF, 0xF0, 0x01, 0x03));
    /* What comes next may be the response, and is held; it is no beginning of another frame of the stream. */
    come(3 * MS, LITERAL(0x02));
    assert_int_equal(line.received_count, 3);
    fake.now_us += 2 * MS; /* 5 ms after the frame, 2 ms after the last byte */
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_PENDING);
    assert_int_equal(fathom_due_us(&sensor, 1), 3 * MS);
    fake.now_us += 3 * MS; /* it was no response */
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_PENDING);
    assert_int_equal(a16.base.stream.counters[FATHOM_STREAM_FRAMES], 0);
    assert_int_equal(a16.base.stream.counters[FATHOM_STREAM_UNSURE], 1);
}

TEST(a_response_right_behind_a_frame_delays_it_and_no_more)
{
    hear_frame(LITERAL(0xFF, 0x02, 0xEF, 0xF0, 0x01, 0x03));
    come(3 * MS, LITERAL(0x02));
    fake.now_us += 2 * MS;
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_PENDING);
    /* 751 mm: 01 03 02 02 EF F8 A8 */
    come(1 * MS, LITERAL(0x02, 0xEF, 0xF8, 0xA8));
    assert_int_equal(request.transaction.status, FATHOM_OK);
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_OK);
    assert_int_equal(sample.distance_mm, 751);
}
