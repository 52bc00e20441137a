/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

#include "fathom/sensor/a16_auto.h"
#include "fathom/sensor/a16_controlled.h"
#include "fathom/sensor/hps167s_auto.h"

/* line.h: the range of each member of the configuration, and the calls of a line that is not initialised. */

static const suite_t suite = {.set_up = set_up};

/* One member of the configuration has another value; returns the result of fathom_line_init(). */
#define init_with(member, new_value) init_config((bench.config.member = (new_value), bench.config))

static fathom_status_t init_config(fathom_line_parts_t config)
{
    static fathom_line_t line;
    void *state = NULL;
    (void)set_up(&state);
    return fathom_line_init(&line, &config);
}

#define expect_accepted(member, new_value) assert_int_equal(init_with(member, new_value), FATHOM_OK)
#define expect_refused(member, new_value)  assert_int_equal(init_with(member, new_value), FATHOM_ERR_ARGUMENT)

TEST(a_config_with_a_time_out_of_its_range_is_refused)
{
    expect_accepted(gap_us, 0);
    expect_refused(gap_us, 1);
    expect_refused(gap_us, 99);
    expect_accepted(gap_us, 100);
    expect_accepted(gap_us, 65535);
    expect_accepted(silence_us, 1);
    expect_accepted(silence_us, 65534);
    expect_refused(silence_us, 65535);
    expect_accepted(busy_us, 0);
    expect_refused(busy_us, T3_5_US);
    expect_accepted(busy_us, T3_5_US + 1);
    expect_accepted(busy_us, INT32_MAX);
    expect_refused(busy_us, (uint32_t)INT32_MAX + 1u);
    bench.config.silence_us = 0; /* The default, 4011 us. */
    expect_refused(busy_us, 4011);
    bench.config.silence_us = 0;
    expect_accepted(busy_us, 4012);
}

TEST(a_config_that_misses_what_its_line_needs_is_refused)
{
    static const fathom_clock_t no_time = {0};
    fathom_uart_t uart = bench.fake.uart;
    expect_refused(uart, NULL);
    expect_refused(clock, NULL);
    expect_refused(frame, NULL);
    uart.read = NULL;
    expect_refused(uart, &uart);
    uart = bench.fake.uart;
    uart.write = NULL;
    expect_refused(uart, &uart);
    uart = bench.fake.uart;
    uart.sent = NULL;
    expect_refused(uart, &uart);
    expect_refused(clock, &no_time);
    expect_refused(counters, NULL);
    expect_refused(frame_size, 7);
    expect_accepted(frame_size, 8);
    expect_refused(echo, FATHOM_LINE_ECHO_ON + 1);
    expect_accepted(echo, FATHOM_LINE_ECHO_AUTO);
    bench.config.find_echo = NULL;
    expect_refused(echo, FATHOM_LINE_ECHO_AUTO);
    for (uint8_t known = FATHOM_LINE_ECHO_OFF; known <= FATHOM_LINE_ECHO_ON; known++) {
        bench.config.find_echo = NULL;
        expect_accepted(echo, known);
    }
}

TEST(without_its_function_the_counters_are_not_needed)
{
    bench.config.count = NULL;
    expect_accepted(counters, NULL);
}

TEST(a_line_whose_config_was_refused_refuses_all_calls)
{
    ask_1(0);
    cancel(&bench.request);
    bench.config.uart = NULL;
    assert_int_equal(fathom_line_init(&bench.line, &bench.config), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_line_poll(&bench.line), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_line_submit(&bench.line, &bench.request.transaction), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_line_due_us(&bench.line), FATHOM_NO_DEADLINE);
    fathom_line_flush(&bench.line);
}

/* Its UART can receive. */
TEST(a_line_whose_uart_cannot_send_refuses_all_calls)
{
    static fathom_uart_t uart;
    uart = bench.fake.uart;
    uart.write = NULL;
    bench.config.uart = &uart;
    assert_int_equal(fathom_line_init(&bench.line, &bench.config), FATHOM_ERR_ARGUMENT);
    assert_null(bench.line.parts);
    assert_int_equal(fathom_line_poll(&bench.line), FATHOM_ERR_ARGUMENT);
}

TEST(a_transaction_has_at_most_254_retries)
{
    ask_1(254);
    cancel(&bench.request);
    bench.request.transaction.retries = 255;
    assert_int_equal(fathom_line_submit(&bench.line, &bench.request.transaction), FATHOM_ERR_ARGUMENT);
}

/* A read that changes something in the unit, as the A16's reads of a measured value do not. */
TEST(a_read_with_an_effect_is_not_sent_into_noise)
{
    fathom_modbus_read_holding_registers(&bench.request.message, 1, 0x0100, 1, &bench.value);
    bench.request.message.has_effect = true;
    bench.request.transaction.retries = 0;
    submit(&bench.request);
    for (uint32_t ms = 0; ms != FATHOM_LINE_DEFAULT_BUSY_US / 1000 + 10; ms++) {
        receive_hex("07");
        run(1000);
    }
    expect(FATHOM_ERR_LINE_BUSY);
    expect_written(0);
}

static void set_nothing(void *ctx, bool high) { (void)ctx, (void)high; }

TEST(a_driver_that_listens_refuses_a_line_that_is_not_initialised)
{
    static fathom_line_t line;
    static fathom_a16_auto_t automatic;
    static fathom_a16_controlled_t controlled;
    static fathom_hps167s_auto_t hps167s;
    const fathom_pin_t pin = {.set = set_nothing};
    const fathom_output_t trigger = fathom_output_pin(&pin);
    const fathom_hps167s_auto_config_t hps167s_config = {.address = 1};
    assert_int_equal(fathom_a16_auto_init(&automatic, &line, NULL), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_a16_controlled_init(&controlled, &line, &trigger, NULL), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_hps167s_auto_init(&hps167s, &line, &hps167s_config), FATHOM_ERR_ARGUMENT);
}
