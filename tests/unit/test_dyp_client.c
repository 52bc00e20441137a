/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* 55 AA frames on a line. SUM is the low byte of the sum of all before it, and 55 + AA = FF. */

static uint16_t values[6]; /* two guards behind the four */

static void fill(uint8_t unit, uint16_t first, uint8_t count)
{
    memset(values, 0xA5, sizeof values);
    fathom_modbus_read_holding_registers(&bench.request.message, unit, first, count, values);
    bench.request.transaction.timeout_us = TIMEOUT_US;
}

static void expect_submitted(fathom_status_t expected)
{
    assert_int_equal(fathom_dyp_client_submit(&bench.line, &bench.request), expected);
}

static void expect_set_address(uint8_t address, fathom_status_t expected)
{
    bench.request.transaction.timeout_us = TIMEOUT_US;
    assert_int_equal(fathom_dyp_client_broadcast_address(&bench.line, &bench.request, address), expected);
}

static void send_request(void)
{
    const size_t before = bench.fake.written;
    expect_submitted(FATHOM_PENDING);
    expect_written_after(REQUEST_US - 3 * BYTE_US, before + 1);
}

static void ask_four(void)
{
    fill(1, 0x0106, 4);
    send_request();
}

static void expect_untouched(size_t from)
{
    for (; from != COUNT_OF(values); from++) assert_int_equal(values[from], 0xA5A5);
}

/* All that dyp_four says. */
static void expect_four(void)
{
    static const uint16_t four[] = {1000, 2000, 1953, 3562};
    expect(FATHOM_OK);
    assert_memory_equal(values, four, sizeof four);
    expect_untouched(4);
}

static void expect_nothing(fathom_status_t status)
{
    expect(status);
    expect_untouched(0);
}

/* ---- what goes out ---- */

typedef struct {
    uint8_t unit;
    uint16_t first;
    uint8_t count;
    uint8_t bytes[5];
} request_t;

static const suite_t suite = {.set_up = set_up};

TEST(each_probe_is_answered_by_its_own_command)
{
    for (uint8_t probe = 0; probe != 4; probe++)
        for (uint8_t command = 0x10; command != 0x14; command++) {
            /* 1953 mm: FF + 01 + 07 + A1 = 1A8, and the command. */
            const uint8_t response[] = {0x55, 0xAA, 0x01, command, 0x07, 0xA1, (uint8_t)(0xA8 + command)};
            set_up(state);
            fill(1, (uint16_t)(0x0106 + probe), 1);
            send_request();
            deliver_all(response);
            if (command == 0x10 + probe) {
                expect(FATHOM_OK);
                assert_int_equal(values[0], 1953);
                expect_untouched(1);
                continue;
            }
            expect(FATHOM_PENDING); /* the right one may still come */
            run(TIMEOUT_US);
            expect_nothing(FATHOM_ERR_MALFORMED);
        }
}

TEST(the_example_with_four_distances_is_read)
{
    ask_four();
    deliver_all(dyp_four);
    expect_four();
    assert_int_equal(bench.request.message.head[0], 1);
}

/* ---- refusals ---- */

TEST(reads_without_a_command_are_unsupported)
{
    static const struct {
        uint16_t first;
        uint8_t count;
    } none[] = {{0x0105, 1}, {0x010A, 1}, {0x0105, 4}, {0x0107, 4}, {0x0109, 4}, {0x0106, 0},
                {0x0106, 2}, {0x0106, 3}, {0x0106, 5}, {0x0107, 3}, {0x0010, 1}, {0x0010, 4},
                {0x0200, 1}, {0x0006, 1}, {0x0206, 4}, {0x0000, 1}, {0xFFFF, 1}};
    for (size_t i = 0; i != COUNT_OF(none); i++) {
        fill(1, none[i].first, none[i].count);
        bench.request.transaction.status = 77;
        expect_submitted(FATHOM_ERR_UNSUPPORTED);
        assert_int_equal(bench.request.transaction.status, 77);
    }
    fill(1, 0x0106, 4);
    bench.request.message.head[4] = 1; /* 260 registers */
    expect_submitted(FATHOM_ERR_UNSUPPORTED);
    expect_written_after(20000, 0);
}

/* The command that sets the address has a name of its own: through the transport no driver can reach it. */
TEST(writes_are_unsupported)
{
    fathom_modbus_write_single_register(&bench.request.message, 1, 0x0200, 5);
    expect_submitted(FATHOM_ERR_UNSUPPORTED);
    fathom_modbus_write_single_register(&bench.request.message, 1, 0x0106, 1);
    expect_submitted(FATHOM_ERR_UNSUPPORTED);
    fathom_modbus_write_multiple_registers(&bench.request.message, 1, 0x0106, 4, values);
    expect_submitted(FATHOM_ERR_UNSUPPORTED);
    expect_written_after(20000, 0);
}

TEST(wrong_units_and_addresses_are_refused)
{
    fill(0, 0x0106, 4);
    expect_submitted(FATHOM_ERR_ARGUMENT);
    expect_set_address(0, FATHOM_ERR_ARGUMENT);
    expect_set_address(255, FATHOM_ERR_ARGUMENT);
    expect_written_after(20000, 0);
}

TEST(a_line_without_room_for_the_longest_response_is_refused)
{
    for (uint8_t size = 12; size != 14; size++) {
        const fathom_status_t expected = size == 12 ? FATHOM_ERR_CAPACITY : FATHOM_PENDING;
        set_up(state);
        bench.config.frame_size = size;
        fill(1, 0x0106, 1);
        expect_submitted(expected);
        assert_int_equal(fathom_dyp_client_broadcast_address(&bench.line, &bench.other, 5), expected);
    }
}

/* ---- what comes back ---- */

TEST(a_response_glued_to_noise_is_found)
{
    static const uint8_t noises[][4] = {{0x55, 0x55, 0x55, 0x55},
                                        {0x00, 0xFF, 0xAA, 0x55},
                                        {0x55, 0xAA, 0x55, 0xAA},
                                        {0x55, 0xAA, 0x01, 0x02},
                                        {0xAA, 0x01, 0x10, 0x07}};
    for (size_t i = 0; i != COUNT_OF(noises); i++)
        for (size_t used = 1; used <= 4; used++) {
            uint8_t glued[4 + sizeof dyp_four];
            set_up(state);
            memcpy(glued, noises[i], used);
            memcpy(glued + used, dyp_four, sizeof dyp_four);
            ask_four();
            receive(glued, used + sizeof dyp_four);
            run(GAP_US + 300);
            expect_four();
        }
}

/* Nor does it serve that one's retry: 55 AA names no register, so that the unit alone tells them apart. */
TEST(a_late_response_of_another_unit_serves_no_retry)
{
    ask_dyp(&bench.other, 1, 1, &bench.other_value);
    run(REQUEST_US);
    cancel(&bench.other); /* unit 1 is quarantined for 200 ms */
    fill(2, 0x0106, 1);
    bench.request.transaction.retries = 1;
    expect_submitted(FATHOM_PENDING);
    run(REQUEST_US + TIMEOUT_US);
    deliver_all(dyp_first_1953);
    expect_count(FATHOM_LINE_LATE_RESPONSES, 1);
    expect_nothing(FATHOM_PENDING);
}

/* ---- the transport ---- */

TEST(the_transport_does_what_the_functions_do)
{
    const fathom_modbus_t transport = fathom_dyp_client(&bench.line);
    assert_ptr_equal(transport.line, &bench.line);
    fill(0, 0x0106, 4);
    assert_int_equal(transport.submit(transport.line, &bench.request), FATHOM_ERR_ARGUMENT);
    fill(1, 0x0106, 4);
    assert_int_equal(transport.submit(transport.line, &bench.request), FATHOM_PENDING);
    assert_int_equal(fathom_line_due_us(transport.line), due());
    bench.fake.now_us += T3_5_US;
    assert_int_equal(fathom_line_poll(transport.line), FATHOM_PENDING);
    bench.fake.now_us += T3_5_US;
    assert_int_equal(fathom_line_poll(transport.line), FATHOM_PENDING);
    expect_written(1);
    fathom_line_cancel(transport.line, &bench.request.transaction);
    fathom_line_cancel(transport.line, &bench.request.transaction);
    expect(FATHOM_ERR_CANCELLED);
    bench.fake.read_fails = true;
    assert_int_equal(fathom_line_poll(transport.line), FATHOM_ERR_PORT);
}

/* dyp_client.h: FATHOM_ERR_BUSY; line.h: "it is queued already; nothing changed". */
TEST(a_refused_set_address_changes_neither_the_retry_nor_the_response_of_a_read_in_progress)
{
    bench.request.transaction.retries = 1;
    ask_four();
    expect_set_address(5, FATHOM_ERR_BUSY);
    expect_written_after(2 * TIMEOUT_US + REQUEST_US, 2);
    expect_bytes(1, bench.fake.writes[0].bytes, 5);
    expect_set_address(5, FATHOM_ERR_BUSY);
    deliver_all(dyp_four);
    expect(FATHOM_OK);
}

/* ---- on a line that does not know whether it echoes ---- */

static int set_up_auto(void **state)
{
    set_up(state);
    set_up_echo(FATHOM_LINE_ECHO_AUTO);
    return 0;
}

static const suite_t auto_echo = {.set_up = set_up_auto};

/* Another master asks the unit for its first probe: a response of 7 bytes could begin like that, but not this
 * request. */
TEST_IN(auto_echo, another_masters_request_to_the_unit_is_no_echo)
{
    static const uint8_t others[] = {0x55, 0xAA, 0x01, 0x10, 0x10};
    ask_four();
    receive(others, sizeof others);
    run(2 * GAP_US);
    assert_int_equal(fathom_line_get_echo(&bench.line), FATHOM_LINE_ECHO_AUTO);
    expect(FATHOM_ERR_CHECKSUM);
}

/* 0101, 0202, 0303, 0404 mm: FF + 01 + 01 + 2 * (1 + 2 + 3 + 4) = 115 hexadecimal. What follows the first five bytes
 * stands in the line's memory when the same response comes again and breaks off; fathom_protocol_t: "on a response it
 * writes the results ..., and only then". */
TEST_IN(auto_echo, a_response_that_breaks_off_writes_nothing_though_the_same_came_before)
{
    static const uint8_t four[] = {0x55, 0xAA, 0x01, 0x01, 0x01, 0x01, 0x02,
                                   0x02, 0x03, 0x03, 0x04, 0x04, 0x15};
    for (size_t length = 4; length != sizeof four; length++) {
        set_up_auto(state);
        ask_four();
        receive(four, sizeof four);
        run(100);
        expect(FATHOM_OK);
        assert_int_equal(values[3], 0x0404);
        ask_four();
        receive(four, length);
        run(2 * GAP_US);
        expect_untouched(0);
        run(TIMEOUT_US);
        /* five bytes of it are the request, which no response follows */
        expect(length < 5 ? FATHOM_ERR_CHECKSUM : FATHOM_ERR_NO_RESPONSE);
    }
}

/* line.h: "the first transaction whose response cannot equal its request, a read, shows the echo". A write does not,
 * though both copies may come in one read. */
TEST_IN(auto_echo, two_copies_of_a_set_address_in_one_read_show_no_echo)
{
    static const uint8_t copies[] = {0x55, 0xAA, 0x05, 0x03, 0x07, 0x55, 0xAA, 0x05, 0x03, 0x07};
    expect_set_address(5, FATHOM_PENDING);
    run(T3_5_US + 200);
    run(5 * BYTE_US);
    receive(copies, sizeof copies);
    run(100);
    expect(FATHOM_OK);
    assert_int_equal(fathom_line_get_echo(&bench.line), FATHOM_LINE_ECHO_AUTO);
}

/* Behind five bytes that are the request 55 AA begins another frame; behind others it is the first probe's low and the
 * second one's high byte. 0355, AA00, 0000, 0000 hexadecimal: FF + 01 + 01 + 03 + 55 + AA = 203. */
TEST_IN(auto_echo, a_response_that_does_not_begin_as_its_request_is_taken_whatever_it_says)
{
    static const uint8_t four[] = {0x55, 0xAA, 0x01, 0x01, 0x03, 0x55, 0xAA, 0, 0, 0, 0, 0, 0x03};
    ask_four();
    receive(four, sizeof four);
    run(100);
    expect(FATHOM_OK);
    assert_int_equal(values[0], 0x0355);
    assert_int_equal(values[1], 0xAA00);
}
