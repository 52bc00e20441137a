/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake.h"
#include "fake_modbus.h"
#include "fathom/a16_modbus.h"
#include "fathom/modbus_client.h"

enum { GUARD = 0xA5, PACE_US = 120000 };

static fake_modbus_t fake;
static fathom_a16_modbus_config_t config;
static fathom_a16_modbus_t a16;
static fathom_sensor_t sensor;
static fathom_sample_t sample;

static int set_up(void **state)
{
    fake_modbus_init(&fake);
    memset(&config, 0, sizeof config);
    config.modbus = &fake.modbus;
    config.clock = &fake.clock;
    memset(&a16, 0x5A, sizeof a16);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static void start(void)
{
    assert_int_equal(fathom_a16_modbus_init(&a16, &config), FATHOM_READY);
    sensor = fathom_a16_modbus_sensor(&a16);
}

static fathom_status_t poll_after(uint32_t us)
{
    fake.now_us += us;
    memset(&sample, GUARD, sizeof sample);
    return fathom_poll(&sensor, &sample);
}

static void assert_sample_untouched(void)
{
    uint8_t untouched[sizeof sample];
    memset(untouched, GUARD, sizeof untouched);
    assert_memory_equal(&sample, untouched, sizeof untouched);
}

static void assert_nothing_after(uint32_t us)
{
    assert_int_equal(poll_after(us), FATHOM_PENDING);
    assert_sample_untouched();
}

/* Asks, and answers with this value. */
static fathom_status_t ask_and_answer(uint16_t value)
{
    assert_nothing_after(PACE_US);
    fake_modbus_answer(&fake, &value, 1);
    return poll_after(1000);
}

/* ---- what is asked ---- */

/* A16 6(3): 0100 processed, 0101 real-time; one register. */
TEST(by_default_it_asks_unit_1_for_the_processed_value_with_1_s_and_no_retry)
{
    start();
    assert_nothing_after(0);
    fake_modbus_assert_asked(&fake, 1, 1, 0x0100, 1);
    assert_int_equal(fake.request->exchange.timeout_us, 1000000);
    assert_int_equal(fake.request->exchange.retries, 0);
}

TEST(the_real_time_value_is_asked_with_300_ms)
{
    config.value = FATHOM_A16_REAL_TIME;
    start();
    assert_nothing_after(0);
    fake_modbus_assert_asked(&fake, 1, 1, 0x0101, 1);
    assert_int_equal(fake.request->exchange.timeout_us, 300000);
}

TEST(the_config_is_asked_as_it_says)
{
    config.value = FATHOM_A16_REAL_TIME;
    config.address = 254;
    config.timeout_us = 77000;
    config.retries = 3;
    start();
    assert_nothing_after(0);
    fake_modbus_assert_asked(&fake, 1, 254, 0x0101, 1);
    assert_int_equal(fake.request->exchange.timeout_us, 77000);
    assert_int_equal(fake.request->exchange.retries, 3);
    config.value = FATHOM_A16_PROCESSED; /* read by init only */
    fake_modbus_fail(&fake, FATHOM_ERR_NO_ANSWER);
    assert_int_equal(poll_after(PACE_US), FATHOM_ERR_NO_ANSWER);
    assert_nothing_after(PACE_US);
    fake_modbus_assert_asked(&fake, 2, 254, 0x0101, 1);
}

typedef struct {
    uint32_t period_us;
    uint32_t pace_us;
} pace_t;

TEST(the_pace_is_the_period_but_at_least_120_ms)
{
    static const pace_t paces[] = {
        {0, 120000}, {1, 120000}, {119999, 120000}, {120001, 120001}, {5000000, 5000000}};
    for (unsigned i = 0; i != sizeof paces / sizeof *paces; i++) {
        set_up(NULL);
        config.period_us = paces[i].period_us;
        start();
        assert_int_equal(ask_and_answer(754), FATHOM_READY); /* it left 1000 us before its answer at most */
        assert_nothing_after(paces[i].pace_us - 1);
        assert_int_equal(fake.submits, 1);
        assert_int_equal(fathom_due_us(&sensor, 1), 1);
        assert_nothing_after(1);
        assert_int_equal(fake.submits, 2);
    }
}

TEST(wrong_arguments_are_refused)
{
    config.modbus = NULL;
    assert_int_equal(fathom_a16_modbus_init(&a16, &config), FATHOM_ERR_ARGUMENT);
    set_up(NULL);
    config.clock = NULL;
    assert_int_equal(fathom_a16_modbus_init(&a16, &config), FATHOM_ERR_ARGUMENT);
    set_up(NULL);
    config.address = 255;
    assert_int_equal(fathom_a16_modbus_init(&a16, &config), FATHOM_ERR_ARGUMENT);
    set_up(NULL);
    config.value = 2;
    assert_int_equal(fathom_a16_modbus_init(&a16, &config), FATHOM_ERR_ARGUMENT);
    set_up(NULL);
    config.window.min_mm = 16351;
    assert_int_equal(fathom_a16_modbus_init(&a16, &config), FATHOM_ERR_ARGUMENT);
    set_up(NULL);
    config.window.min_mm = 500;
    config.window.max_mm = 499;
    assert_int_equal(fathom_a16_modbus_init(&a16, &config), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fake.submits + fake.polls, 0);
}

/* ---- what comes back ---- */

TEST(a_sample_has_all_its_members)
{
    config.address = 17;
    start();
    assert_nothing_after(0);
    fake.heard_us = 123456;
    fake_modbus_answer(&fake, (const uint16_t[]){754}, 1);
    assert_int_equal(poll_after(1000), FATHOM_READY);
    assert_int_equal(sample.time_us, 123456);
    assert_int_equal(sample.magnitude, 0);
    assert_int_equal(sample.sequence, 1);
    assert_int_equal(sample.raw, 754);
    assert_int_equal(sample.distance_mm, 754);
    assert_int_equal(sample.precision, 0);
    assert_int_equal(sample.kind, FATHOM_TARGET);
    assert_int_equal(sample.model, FATHOM_A16);
    assert_int_equal(sample.unit, 17);
    assert_int_equal(sample.probe, 1);
    assert_int_equal(sample.ambient, 0);
    assert_false(sample.interference);
    assert_nothing_after(0);
}

typedef struct {
    uint16_t value;
    fathom_status_t status;
    uint8_t kind;
    uint16_t distance_mm;
    bool interference;
} reading_t;

TEST(values_mean_target_no_target_or_nothing_that_can_be)
{
    static const reading_t readings[] = {
        {1, FATHOM_READY, FATHOM_TARGET, 1, false},        {16350, FATHOM_READY, FATHOM_TARGET, 16350, false},
        {0, FATHOM_READY, FATHOM_NO_TARGET, 0, false},     {0xFFFD, FATHOM_READY, FATHOM_NO_TARGET, 0, false},
        {0xFFFE, FATHOM_READY, FATHOM_NO_TARGET, 0, true}, {16351, FATHOM_ERR_MALFORMED, 0, 0, false},
        {0xFFFC, FATHOM_ERR_MALFORMED, 0, 0, false},       {0xFFFF, FATHOM_ERR_MALFORMED, 0, 0, false},
    };
    start();
    for (unsigned i = 0; i != sizeof readings / sizeof *readings; i++) {
        assert_int_equal(ask_and_answer(readings[i].value), readings[i].status);
        if (readings[i].status != FATHOM_READY) {
            assert_sample_untouched();
            continue;
        }
        assert_int_equal(sample.kind, readings[i].kind);
        assert_int_equal(sample.raw, readings[i].value);
        assert_int_equal(sample.distance_mm, readings[i].distance_mm);
        assert_true(sample.interference == readings[i].interference);
    }
    assert_int_equal(a16.base.answer.implausible, 3);
}

TEST(a_window_of_the_users_own_is_kept)
{
    config.window.min_mm = 500;
    config.window.max_mm = 15000;
    start();
    assert_int_equal(ask_and_answer(499), FATHOM_ERR_MALFORMED);
    assert_int_equal(ask_and_answer(500), FATHOM_READY);
    assert_int_equal(ask_and_answer(15000), FATHOM_READY);
    assert_int_equal(ask_and_answer(15001), FATHOM_ERR_MALFORMED);
}

TEST(every_error_passes_through_and_leaves_the_sample_alone)
{
    static const fathom_status_t errors[] = {FATHOM_ERR_NO_ANSWER, FATHOM_ERR_CHECKSUM, FATHOM_ERR_EXCEPTION,
                                             FATHOM_ERR_MALFORMED, FATHOM_ERR_PORT,     FATHOM_ERR_CANCELLED};
    start();
    for (unsigned i = 0; i != sizeof errors / sizeof *errors; i++) {
        assert_nothing_after(PACE_US);
        fake.exception = 3;
        fake_modbus_fail(&fake, errors[i]);
        assert_int_equal(poll_after(1000), errors[i]);
        assert_sample_untouched();
        if (errors[i] == FATHOM_ERR_EXCEPTION) assert_int_equal(a16.base.unit.request.message.exception, 3);
        assert_nothing_after(0);
    }
    fake.refuses = FATHOM_ERR_CAPACITY;
    assert_int_equal(poll_after(PACE_US), FATHOM_ERR_CAPACITY);
    assert_sample_untouched();
    fake.refuses = 0;
    assert_int_equal(ask_and_answer(754), FATHOM_READY);
    assert_int_equal(sample.sequence, 1);
}

TEST(the_sequence_counts_answers_and_wraps)
{
    start();
    for (uint32_t i = 1; i <= 65537; i++) {
        assert_int_equal(ask_and_answer(754), FATHOM_READY);
        assert_int_equal(sample.sequence, i & 0xFFFF);
        fake.submits = 0;
    }
}

TEST(deinit_cancels_what_is_under_way)
{
    start();
    fathom_a16_modbus_deinit(&a16);
    assert_int_equal(fake.cancels, 0);
    assert_nothing_after(0);
    fathom_a16_modbus_deinit(&a16);
    assert_int_equal(fake.cancels, 1);
    assert_null(fake.request);
}

/* ---- over a real line ---- */

typedef struct {
    fake_t uart;
    uint8_t frame[13];
    fathom_line_config_t line_config;
    fathom_line_t line;
    fathom_modbus_t modbus;
} wire_t;

static void start_wire(wire_t *wire)
{
    fake_init(&wire->uart);
    wire->uart.byte_us = 1042;
    wire->line_config = (fathom_line_config_t){
        &wire->uart.uart, &wire->uart.clock, wire->frame, 13, FATHOM_LINE_ECHO_AUTO, 3646, 5000};
    assert_int_equal(fathom_line_init(&wire->line, &wire->line_config), FATHOM_READY);
    wire->modbus = fathom_modbus_client(&wire->line);
    config.modbus = &wire->modbus;
    config.clock = &wire->uart.clock;
}

/* A16 6(4) examples 1 and 2, byte for byte. */
TEST(the_examples_of_the_datasheet_go_over_a_line)
{
    static const uint8_t requests[][8] = {{0x01, 0x03, 0x01, 0x00, 0x00, 0x01, 0x85, 0xF6},
                                          {0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36}};
    static const uint8_t answers[][7] = {{0x01, 0x03, 0x02, 0x02, 0xF2, 0x38, 0xA1},
                                         {0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8}};
    static const uint16_t distances[] = {754, 751};
    static wire_t wire;
    for (uint8_t i = 0; i != 2; i++) {
        fathom_status_t status = FATHOM_PENDING;
        start_wire(&wire);
        config.value = i;
        start();
        for (unsigned ms = 0; ms != 200 && status == FATHOM_PENDING; ms++) {
            wire.uart.now_us += 1000;
            status = fathom_poll(&sensor, &sample);
            if (ms == 50) fake_trickle(&wire.uart, 0, 1042, answers[i], 7);
        }
        assert_int_equal(wire.uart.written, 1);
        assert_int_equal(wire.uart.writes[0].length, 8);
        assert_memory_equal(wire.uart.writes[0].bytes, requests[i], 8);
        assert_int_equal(status, FATHOM_READY);
        assert_int_equal(sample.distance_mm, distances[i]);
    }
}

/* Two units on one line, in a loop that comes to one of them every 10 ms. The first one's answer is read, and
 * the second one's request sent, in the second one's poll. sample.h: time_us is the clock when the last byte
 * of the answer came; the port's stamp says when that was. */
TEST(the_time_is_the_answers_own_when_anothers_poll_brought_it)
{
    static const uint8_t answer[] = {0x01, 0x03, 0x02, 0x02, 0xF2, 0x38, 0xA1}; /* A16 6(4) ex 1 */
    static wire_t wire;
    static fathom_a16_modbus_t other;
    fathom_status_t status = FATHOM_PENDING;
    start_wire(&wire);
    start();
    config.address = 2;
    assert_int_equal(fathom_a16_modbus_init(&other, &config), FATHOM_READY);
    const fathom_sensor_t other_sensor = fathom_a16_modbus_sensor(&other);
    for (unsigned i = 0; i != 4; i++) {
        wire.uart.now_us += 10000;
        assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_PENDING);
        wire.uart.now_us += 10000;
        assert_int_equal(fathom_poll(&other_sensor, &sample), FATHOM_PENDING);
    }
    assert_int_equal(wire.uart.written, 1);
    assert_int_equal(wire.uart.writes[0].bytes[0], 1);
    const uint32_t came_us = wire.uart.now_us + 14000;
    fake_receive_rx(&wire.uart, 15000, answer, 7, (fathom_rx_t){came_us, FATHOM_RX_TIMED});
    wire.uart.now_us += 10000;
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_PENDING);
    wire.uart.now_us += 10000;
    assert_int_equal(fathom_poll(&other_sensor, &sample), FATHOM_PENDING);
    assert_int_equal(wire.uart.written, 2); /* the other's turn */
    wire.uart.now_us += 10000;
    status = fathom_poll(&sensor, &sample);
    assert_int_equal(status, FATHOM_READY);
    assert_int_equal(sample.distance_mm, 754);
    assert_int_equal(sample.time_us, came_us);
}
