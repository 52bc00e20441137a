/* SPDX-License-Identifier: MIT */
/* The checks of a build with FATHOM_ASSERT: each finds its mistake, and a right program fails none. */
#include "suite.h"

#include "fathom/engine/line.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/sensor/hps167s.h"

static const suite_t suite = {0};

unsigned failed_asserts;

static uint32_t now_us(void *ctx)
{
    static uint32_t us;
    (void)ctx;
    return us += 1000;
}

static int read_nothing(void *ctx, uint8_t *bytes, size_t size, fathom_rx_t *rx) { return 0; }
static int write_all(void *ctx, const uint8_t *bytes, size_t length) { return (int)length; }
static bool is_sent(void *ctx) { return true; }

static const fathom_uart_t uart = {.read = read_nothing, .write = write_all, .sent = is_sent};
static const fathom_clock_t clock = {now_us, NULL};
static uint8_t frame[13];
static fathom_line_t line;
static fathom_hps167s_t sensor;

static const fathom_line_parts_t right_parts = {
    .uart = &uart, .clock = &clock, .frame = frame, .frame_size = sizeof frame, .echo = FATHOM_LINE_ECHO_OFF};

TEST(a_right_program_fails_no_check)
{
    failed_asserts = 0;
    assert_int_equal(fathom_line_init(&line, &right_parts), FATHOM_OK);
    const fathom_modbus_t modbus = fathom_modbus_client(&line);
    assert_int_equal(fathom_hps167s_init(&sensor, &modbus, NULL), FATHOM_OK);
    const fathom_sensor_t gate = fathom_hps167s_sensor(&sensor);
    fathom_sample_t sample;
    for (unsigned i = 0; i != 3000; i++) assert_true(fathom_poll(&gate, &sample) != FATHOM_OK);
    fathom_hps167s_deinit(&sensor);
    assert_int_equal(failed_asserts, 0);
}

TEST(parts_in_memory_that_is_used_again_are_found_at_the_next_poll)
{
    fathom_line_parts_t parts = right_parts;
    failed_asserts = 0;
    assert_int_equal(fathom_line_init(&line, &parts), FATHOM_OK);
    (void)fathom_line_poll(&line);
    assert_int_equal(failed_asserts, 0);
    const fathom_uart_t other = uart;
    parts.uart = &other; /* A dead variable keeps its bytes until another function uses the stack. */
    (void)fathom_line_poll(&line);
    assert_int_equal(failed_asserts, 1);
}

TEST(the_timing_of_a_line_may_change)
{
    fathom_line_parts_t parts = right_parts;
    failed_asserts = 0;
    assert_int_equal(fathom_line_init(&line, &parts), FATHOM_OK);
    parts.silence_us = 4010;
    parts.gap_us = 1720;
    (void)fathom_line_poll(&line);
    assert_int_equal(failed_asserts, 0);
}

TEST(a_driver_without_init_is_found)
{
    static fathom_hps167s_t zeroed;
    const fathom_sensor_t gate = fathom_hps167s_sensor(&zeroed);
    fathom_sample_t sample;
    failed_asserts = 0;
    assert_int_equal(fathom_poll(&gate, &sample), FATHOM_ERR_ARGUMENT);
    assert_true(failed_asserts != 0);
}

TEST(an_init_over_a_queued_request_is_found)
{
    failed_asserts = 0;
    assert_int_equal(fathom_line_init(&line, &right_parts), FATHOM_OK);
    const fathom_modbus_t modbus = fathom_modbus_client(&line);
    assert_int_equal(fathom_hps167s_init(&sensor, &modbus, NULL), FATHOM_OK);
    const fathom_sensor_t gate = fathom_hps167s_sensor(&sensor);
    fathom_sample_t sample;
    while (!fathom_line_is_idle(&line) || fathom_poll(&gate, &sample) == FATHOM_PENDING) {
        if (!fathom_line_is_idle(&line)) break;
    }
    assert_int_equal(failed_asserts, 0);
    assert_int_equal(fathom_hps167s_init(&sensor, &modbus, NULL), FATHOM_ERR_BUSY);
    assert_int_equal(failed_asserts, 1);
    fathom_hps167s_deinit(&sensor);
}
