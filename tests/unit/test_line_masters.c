/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* line.h, rule 12: what the line concludes from frames of other masters that are no simple requests. */

static int set_up_masters(void **state)
{
    (void)set_up(state);
    bench.config.senders = NULL;
    bench.config.masters = &fathom_line_masters;
    set_up_echo(FATHOM_LINE_ECHO_OFF);
    show_empty_port();
    return 0;
}

static const suite_t suite = {.set_up = set_up_masters};

/* 55 AA 01 and a command that no sensor has: no byte behind the frame buffer is read, and nothing is counted. */
TEST(a_frame_of_55_aa_with_an_unknown_command_is_no_request)
{
    run(10000);
    deliver_hex("55 AA 01 07 07");
    run(10000);
    expect_count(FATHOM_LINE_FOREIGN_REQUESTS, 0);
    ask_1(0);
    expect_sent(0, 200);
}

/* Function 16 with 40 registers has 9 + 80 bytes; the frame buffer has 32. */
TEST(a_foreign_write_that_is_longer_than_the_frame_buffer_is_a_request)
{
    run(10000);
    ask_other(2);
    deliver_hex("01 10 00 20 00 28 50");
    expect_count(FATHOM_LINE_FOREIGN_REQUESTS, 1);
    expect_written_after(TIMEOUT_US - 1000, 0);
    expect_written_after(2000, 1);
}

/* 11 03 02 00 00 79 87 is a response of unit 17 with the value 0; its first seven bytes could also begin a read of 0x79
 * registers from 0x0200 on. */
TEST(a_response_that_could_also_begin_a_request_is_a_response)
{
    run(10000);
    ask_other(17);
    run(REQUEST_US);
    run(2 * TIMEOUT_US);
    expect_other(FATHOM_ERR_NO_RESPONSE);
    ask_1(0);
    run(REQUEST_US);
    deliver_hex("11 03 02 00 00 79 87");
    expect_count(FATHOM_LINE_FOREIGN_REQUESTS, 0);
    expect_count(FATHOM_LINE_STRAYS, 1);
    expect(FATHOM_PENDING);
}

/* A read of one register of unit 2, and a write of many; 55 AA 01 01 with its sum. */
TEST(a_foreign_request_that_arrives_byte_by_byte_counts_before_the_first_request_of_the_line)
{
    static const uint8_t read[] = {0x02, 0x03, 0x01, 0x00, 0x00, 0x01, 0x85, 0xC5};
    static const uint8_t write[] = {0x02, 0x10, 0x00, 0x20, 0x00, 0x01, 0x02, 0x00, 0x05, 0x75, 0xC3};
    static const uint8_t dyp[] = {0x55, 0xAA, 0x01, 0x01, 0x01};
    static const struct {
        const uint8_t *bytes;
        uint8_t length;
    } rows[] = {{read, sizeof read}, {write, sizeof write}, {dyp, sizeof dyp}};
    for (unsigned i = 0; i != COUNT_OF(rows); i++) {
        set_up_masters(state);
        for (unsigned at = 0; at != rows[i].length; at++) {
            expect_count(FATHOM_LINE_FOREIGN_REQUESTS, 0);
            receive(rows[i].bytes + at, 1);
            run_in_steps(BYTE_US, BYTE_US);
        }
        expect_count(FATHOM_LINE_FOREIGN_REQUESTS, 1);
    }
}

/* Noise without a silence for a second; 00 begins no frame. */
static void jam(uint32_t for_us)
{
    for (uint32_t us = 0; us < for_us; us += BYTE_US) {
        receive_hex("00");
        run_in_steps(BYTE_US, BYTE_US);
    }
}

/* Rule 3: a read leaves into noise, but not if a frame was heard. */
TEST(a_foreign_request_before_the_wait_keeps_a_read_out_of_the_noise)
{
    deliver_hex("02 03 01 00 00 01 85 C5");
    ask_1(0);
    jam(1000000 - 2 * BYTE_US);
    expect(FATHOM_PENDING);
    jam(4 * BYTE_US);
    expect(FATHOM_ERR_LINE_BUSY);
    expect_written(0);
}

TEST(a_foreign_request_during_the_wait_keeps_a_read_out_of_the_noise)
{
    ask_1(0);
    jam(100000);
    receive_hex("02 03 01 00 00 01 85 C5");
    jam(900000 - 2 * BYTE_US);
    expect(FATHOM_PENDING);
    jam(4 * BYTE_US);
    expect(FATHOM_ERR_LINE_BUSY);
    expect_written(0);
}

/* Rule 14: a foreign request may have been among the dropped bytes. */
TEST(after_dropped_bytes_no_frame_is_a_response_to_the_request_on_the_wire)
{
    ask_1_and_send(0);
    fathom_line_flush(&bench.line);
    deliver_hex("00");
    expect_count(FATHOM_LINE_OLD_BYTES, 1);
    run(100);
    deliver(response_1_754, sizeof response_1_754);
    expect(FATHOM_PENDING);
    run(TIMEOUT_US);
    expect_failed(FATHOM_ERR_NO_RESPONSE);
}

TEST(after_dropped_bytes_the_line_sends_nothing_for_a_second_and_the_next_response_counts)
{
    fathom_line_flush(&bench.line);
    deliver_hex("00");
    run(100);
    ask_1(0);
    expect_written_after(1000000 - 500, 0);
    expect_written_after(1000, 1);
    run(8 * BYTE_US);
    deliver(response_1_754, sizeof response_1_754);
    expect_mm(754);
}

/* MODBUS over Serial Line V1.02, 2.2: addresses 248 to 255 are reserved. */
TEST(a_foreign_request_is_to_a_unit_up_to_247)
{
    deliver_hex("F7 03 01 00 00 01 91 60");
    expect_count(FATHOM_LINE_FOREIGN_REQUESTS, 1);
    run(10000);
    deliver_hex("F8 03 01 00 00 01 91 9F");
    expect_count(FATHOM_LINE_FOREIGN_REQUESTS, 1);
}
