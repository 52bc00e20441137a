/* SPDX-License-Identifier: MIT */
#include "commission_stage.h"

/* What is due while the line holds part of a frame: a program that sleeps as long as it may does not spin, and a
 * stream is not told of a silence that there was not. Bytes come when the test says so. */

typedef struct {
    uint32_t now_us;
    const uint8_t *bytes; /* to come at once */
    uint8_t count;
    uint8_t frame[32];
    fathom_uart_t uart;
    fathom_clock_t clock;
    fathom_line_config_t config;
    fathom_line_t line;
    uint16_t value;
    fathom_modbus_request_t request;
} desk_t;

static int desk_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    desk_t *const desk = ctx;
    const uint8_t count = desk->count;
    assert_true(count <= capacity);
    if (count == 0) return 0;
    memcpy(bytes, desk->bytes, count);
    rx->flags = FATHOM_RX_TIMED;
    rx->last_us = desk->now_us;
    desk->count = 0;
    return count;
}

static int desk_write(void *ctx, const uint8_t *bytes, size_t length)
{
    (void)ctx;
    (void)bytes;
    return (int)length;
}

static bool desk_sent(void *ctx)
{
    (void)ctx;
    return true;
}

static uint32_t desk_now_us(void *ctx)
{
    const desk_t *const desk = ctx;
    return desk->now_us;
}

static void set_desk(desk_t *desk)
{
    memset(desk, 0, sizeof *desk);
    desk->now_us = bench_start_us;
    desk->uart = (fathom_uart_t){.read = desk_read, .write = desk_write, .sent = desk_sent, .ctx = desk};
    desk->clock = (fathom_clock_t){.now_us = desk_now_us, .ctx = desk};
    desk->config = (fathom_line_config_t){
        .uart = &desk->uart, .clock = &desk->clock, .frame = desk->frame, .frame_size = sizeof desk->frame};
    assert_int_equal(fathom_line_init(&desk->line, &desk->config), FATHOM_READY);
}

/* Time passes, then these bytes come, the last of them just now, and the line looks. */
static void come(desk_t *desk, uint32_t by_us, const uint8_t *bytes, size_t count)
{
    desk->now_us += by_us;
    desk->bytes = bytes;
    desk->count = (uint8_t)count;
    assert_int_equal(fathom_line_poll(&desk->line), FATHOM_PENDING);
}

/* Unit 1 is asked for one register; the request has left. */
static void ask(desk_t *desk)
{
    desk->request.exchange.timeout_us = 100 * MS;
    fathom_modbus_read_holding_registers(&desk->request.message, 1, 0x0101, 1, &desk->value);
    assert_int_equal(fathom_modbus_client_submit(&desk->line, &desk->request), FATHOM_PENDING);
    come(desk, 20 * MS, NULL, 0);
    come(desk, 10 * MS, NULL, 0);
    assert_int_equal(desk->request.exchange.attempts, 1);
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(a_time_out_in_mid_answer_is_due_when_the_answer_has_broken_off)
{
    desk_t desk;
    set_desk(&desk);
    ask(&desk);
    assert_int_equal(fathom_line_due_us(&desk.line), 100 * MS);
    come(&desk, 99 * MS, LITERAL(0x01, 0x03, 0x02));
    assert_int_equal(fathom_line_due_us(&desk.line), 5 * MS); /* the default gap_us */
    come(&desk, 2 * MS, NULL, 0); /* the time-out has passed; the answer may go on */
    assert_int_equal(desk.request.exchange.status, FATHOM_PENDING);
    assert_int_equal(fathom_line_due_us(&desk.line), 3 * MS);
    come(&desk, 3 * MS, NULL, 0);
    assert_int_equal(desk.request.exchange.status, FATHOM_ERR_CHECKSUM);
}

TEST(a_request_behind_part_of_a_late_answer_is_due_when_that_has_broken_off)
{
    desk_t desk;
    fathom_modbus_request_t other = {.exchange = {.timeout_us = 100 * MS}};
    set_desk(&desk);
    ask(&desk);
    come(&desk, 100 * MS, NULL, 0);
    assert_int_equal(desk.request.exchange.status, FATHOM_ERR_NO_ANSWER); /* the unit owes an answer */
    come(&desk, 10 * MS, LITERAL(0x01, 0x03, 0x02));
    fathom_modbus_read_holding_registers(&other.message, 2, 0x0101, 1, &desk.value);
    assert_int_equal(fathom_modbus_client_submit(&desk.line, &other), FATHOM_PENDING);
    come(&desk, 4500, NULL, 0); /* over the silence of 4011 us before a request, under the gap of 5 ms */
    assert_int_equal(other.exchange.attempts, 0);
    assert_int_equal(fathom_line_due_us(&desk.line), 500);
    come(&desk, 500, NULL, 0);
    assert_int_equal(other.exchange.attempts, 1);
}

/* ---- the stream of the same line ---- */

typedef struct {
    desk_t desk;
    fathom_a16_auto_t a16;
    fathom_sensor_t sensor;
    fathom_sample_t sample;
} radio_t;

/* FF 02 EF F0 (751 mm) and perhaps more after a silence, while unit 1 is asked. */
static void hear_frame(radio_t *radio, const uint8_t *bytes, size_t count)
{
    const fathom_a16_auto_config_t config = {.line = &radio->desk.line};
    memset(radio, 0, sizeof *radio);
    set_desk(&radio->desk);
    assert_int_equal(fathom_a16_auto_init(&radio->a16, &config), FATHOM_READY);
    radio->sensor = fathom_a16_auto_sensor(&radio->a16);
    ask(&radio->desk);
    come(&radio->desk, 10 * MS, NULL, 0);
    come(&radio->desk, 20 * MS, bytes, count);
    assert_int_equal(fathom_poll(&radio->sensor, &radio->sample), FATHOM_PENDING);
}

TEST(a_silence_behind_a_frame_gives_it_also_with_an_open_exchange)
{
    radio_t radio;
    hear_frame(&radio, LITERAL(0xFF, 0x02, 0xEF, 0xF0));
    assert_int_equal(fathom_due_us(&radio.sensor, 1), 5 * MS);
    radio.desk.now_us += 5 * MS;
    assert_int_equal(fathom_poll(&radio.sensor, &radio.sample), FATHOM_READY);
    assert_int_equal(radio.sample.distance_mm, 751);
}

TEST(bytes_that_the_line_holds_back_are_no_silence_behind_a_frame)
{
    radio_t radio;
    hear_frame(&radio, LITERAL(0xFF, 0x02, 0xEF, 0xF0, 0x01, 0x03));
    /* What comes next may be the answer, and is held; it is no beginning of another frame of the stream. */
    come(&radio.desk, 3 * MS, LITERAL(0x02));
    assert_int_equal(radio.desk.line.have, 3);
    radio.desk.now_us += 2 * MS; /* 5 ms after the frame, 2 ms after the last byte */
    assert_int_equal(fathom_poll(&radio.sensor, &radio.sample), FATHOM_PENDING);
    assert_int_equal(fathom_due_us(&radio.sensor, 1), 3 * MS);
    radio.desk.now_us += 3 * MS; /* it was no answer */
    assert_int_equal(fathom_poll(&radio.sensor, &radio.sample), FATHOM_PENDING);
    assert_int_equal(radio.a16.base.stream.counters[FATHOM_STREAM_FRAMES], 0);
    assert_int_equal(radio.a16.base.stream.counters[FATHOM_STREAM_UNSURE], 1);
}

TEST(an_answer_right_behind_a_frame_delays_it_and_no_more)
{
    radio_t radio;
    hear_frame(&radio, LITERAL(0xFF, 0x02, 0xEF, 0xF0, 0x01, 0x03));
    come(&radio.desk, 3 * MS, LITERAL(0x02));
    radio.desk.now_us += 2 * MS;
    assert_int_equal(fathom_poll(&radio.sensor, &radio.sample), FATHOM_PENDING);
    /* 751 mm: 01 03 02 02 EF F8 A8 */
    come(&radio.desk, 1 * MS, LITERAL(0x02, 0xEF, 0xF8, 0xA8));
    assert_int_equal(radio.desk.request.exchange.status, FATHOM_READY);
    assert_int_equal(fathom_poll(&radio.sensor, &radio.sample), FATHOM_READY);
    assert_int_equal(radio.sample.distance_mm, 751);
}
