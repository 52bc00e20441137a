/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* line.h, local echo: what begins like its request may be the echo, as long as the line does not know. All else that
 * answers is a response. */

static int set_up_auto(void **state)
{
    void *unused;
    (void)state; /* has a row */
    set_up(&unused);
    set_up_echo(FATHOM_LINE_ECHO_AUTO);
    return 0;
}

static const suite_t suite = {.set_up = set_up_auto};

static void add_crc(uint8_t *frame, size_t length)
{
    uint16_t crc = 0xFFFF;
    for (size_t i = 0; i != length; i++) {
        crc ^= frame[i];
        for (unsigned bit = 0; bit != 8; bit++)
            crc = (uint16_t)((crc & 1) != 0 ? crc >> 1 ^ 0xA001 : crc >> 1);
    }
    frame[length] = (uint8_t)crc;
    frame[length + 1] = (uint8_t)(crc >> 8);
}

static void send(void)
{
    bench.request.transaction.timeout_us = TIMEOUT_US;
    assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_PENDING);
    run(T3_5_US + 200);
    run(8 * BYTE_US);
    assert_int_equal(bench.fake.written, 1);
}

/*
 * Two registers from 0410 are asked for with 01 03 04 10 00 02, and 1000, 02FF are told with 01 03 04 10 00 02 FF. With
 * one other byte it is no echo. (The third byte of the response is its size and stays; so the request has the other
 * one.)
 */
typedef struct {
    uint16_t first;
    uint16_t values[2];
} alike_t;

static const alike_t third = {0x0310, {0x1000, 0x02FF}};
static const alike_t fourth = {0x0410, {0x1100, 0x02FF}};
static const alike_t fifth = {0x0410, {0x1001, 0x02FF}};
static const alike_t sixth = {0x0410, {0x1000, 0x03FF}};

static void is_answered_at_once(void **state)
{
    const alike_t *const row = *state;
    uint16_t values[2] = {0, 0};
    uint8_t response[9] = {1, 3, 4};
    for (unsigned i = 0; i != 2; i++) {
        response[3 + 2 * i] = (uint8_t)(row->values[i] >> 8);
        response[4 + 2 * i] = (uint8_t)row->values[i];
    }
    add_crc(response, 7);
    fathom_modbus_read_holding_registers(&bench.request.message, 1, row->first, 2, values);
    send();
    receive(response, sizeof response);
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_OK);
    assert_memory_equal(values, row->values, sizeof values);
    assert_int_equal(fathom_line_get_echo(&bench.line), FATHOM_LINE_ECHO_OFF);
}

TEST_ROW(a_response_whose_size_alone_differs_from_the_request_is_a_response, is_answered_at_once, &third)
TEST_ROW(a_response_whose_fourth_byte_alone_differs_is_a_response, is_answered_at_once, &fourth)
TEST_ROW(a_response_whose_fifth_byte_alone_differs_is_a_response, is_answered_at_once, &fifth)
TEST_ROW(a_response_whose_sixth_byte_alone_differs_is_a_response, is_answered_at_once, &sixth)

/* The exception 2 to function 06 of unit 1 is 01 86 02 C3 A1. Register 02C3 is written with A105 by 01 06 02 C3 A1 05:
 * bytes 2 to 4 are the same, and a sixth the exception has not. */
TEST(an_exception_is_no_echo_whatever_its_bytes_are)
{
    static const uint8_t exception[] = {0x01, 0x86, 0x02, 0xC3, 0xA1};
    fathom_modbus_write_single_register(&bench.request.message, 1, 0x02C3, 0xA105);
    send();
    receive(exception, sizeof exception);
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_EXCEPTION);
    assert_int_equal(bench.request.message.exception, 2);
}
