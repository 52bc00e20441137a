/* SPDX-License-Identifier: MIT */
#include "fathom/engine/dyp_client.h"
#include "line_bench.h"

/* Frames 55 AA that break off, are another master's, or stand one behind the other, on a line that does not know
 * whether it echoes. SUM is the low byte of the sum of all before it, and 55 + AA = FF. */

static uint16_t values[4];

static int set_up_auto(void **state)
{
    set_up(state);
    set_up_echo(FATHOM_LINE_ECHO_AUTO);
    return 0;
}

static const suite_t suite = {.set_up = set_up_auto};

/* Asks unit 1 for all probes: 55 AA 01 01 01. */
static void ask_all(void)
{
    const size_t before = bench.fake.written;
    memset(values, 0xA5, sizeof values);
    fathom_modbus_read_holding_registers(&bench.request.message, 1, 0x0106, 4, values);
    bench.request.transaction.timeout_us = TIMEOUT_US;
    assert_int_equal(fathom_dyp_client_submit(&bench.line, &bench.request), FATHOM_PENDING);
    run(T3_5_US + 200);
    assert_int_equal(bench.fake.written, before + 1);
    run(5 * BYTE_US);
}

/* Another master asks the unit for its first probe: a response of 7 bytes could begin like that, but not this
 * request. */
TEST(another_masters_request_to_the_unit_is_no_echo)
{
    static const uint8_t others[] = {0x55, 0xAA, 0x01, 0x10, 0x10};
    ask_all();
    receive(others, sizeof others);
    run(2 * GAP_US);
    assert_int_equal(fathom_line_get_echo(&bench.line), FATHOM_LINE_ECHO_AUTO);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_CHECKSUM);
}

/* 0101, 0202, 0303, 0404 mm: FF + 01 + 01 + 2 * (1 + 2 + 3 + 4) = 115 hexadecimal. What follows the first five bytes
 * stands in the line's memory when the same response comes again and breaks off; fathom_protocol_t: "on a response it
 * writes the results ..., and only then". */
TEST(a_response_that_breaks_off_writes_nothing_though_the_same_came_before)
{
    static const uint8_t four[] = {0x55, 0xAA, 0x01, 0x01, 0x01, 0x01, 0x02,
                                   0x02, 0x03, 0x03, 0x04, 0x04, 0x15};
    for (size_t length = 4; length != sizeof four; length++) {
        set_up_auto(state);
        ask_all();
        receive(four, sizeof four);
        run(100);
        assert_int_equal(status_of(&bench.request), FATHOM_OK);
        assert_int_equal(values[3], 0x0404);
        ask_all();
        receive(four, length);
        run(2 * GAP_US);
        for (unsigned i = 0; i != 4; i++) assert_int_equal(values[i], 0xA5A5);
        run(TIMEOUT_US);
        /* five bytes of it are the request, which no response follows */
        assert_int_equal(status_of(&bench.request),
                         length < 5 ? FATHOM_ERR_CHECKSUM : FATHOM_ERR_NO_RESPONSE);
    }
}

/* line.h: "the first transaction whose response cannot equal its request, a read, shows the echo". A write does not,
 * though both copies may come in one read. */
TEST(two_copies_of_a_set_address_in_one_read_show_no_echo)
{
    static const uint8_t copies[] = {0x55, 0xAA, 0x05, 0x03, 0x07, 0x55, 0xAA, 0x05, 0x03, 0x07};
    bench.request.transaction.timeout_us = TIMEOUT_US;
    assert_int_equal(fathom_dyp_client_broadcast_address(&bench.line, &bench.request, 5), FATHOM_PENDING);
    run(T3_5_US + 200);
    run(5 * BYTE_US);
    receive(copies, sizeof copies);
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_OK);
    assert_int_equal(fathom_line_get_echo(&bench.line), FATHOM_LINE_ECHO_AUTO);
}

/* Behind five bytes that are the request 55 AA begins another frame; behind others it is the first probe's low and the
 * second one's high byte. 0355, AA00, 0000, 0000 hexadecimal: FF + 01 + 01 + 03 + 55 + AA = 203. */
TEST(a_response_that_does_not_begin_as_its_request_is_taken_whatever_it_says)
{
    static const uint8_t four[] = {0x55, 0xAA, 0x01, 0x01, 0x03, 0x55, 0xAA, 0, 0, 0, 0, 0, 0x03};
    ask_all();
    receive(four, sizeof four);
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_OK);
    assert_int_equal(values[0], 0x0355);
    assert_int_equal(values[1], 0xAA00);
}
