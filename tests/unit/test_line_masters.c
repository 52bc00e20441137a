/* SPDX-License-Identifier: MIT */
#include "line_conversation.h"

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

#define READ_OF_2 "02 03 01 00 00 01 85 C5"

static const conversation_t conversations[] = {
    /* 55 AA 01 and a command that no sensor has: no byte behind the frame buffer is read, and nothing is counted */
    ROW("a_frame_of_55_aa_with_an_unknown_command_is_no_request", COUNTS(.dropped = 5), WAIT(10000),
        RECEIVE("55 AA 01 07 07"), WAIT(10000), QUEUE(A, 1), SENT(0, 200)),
    /* function 16 with 40 registers has 9 + 80 bytes; the frame buffer has 32 */
    ROW("a_foreign_write_that_is_longer_than_the_frame_buffer_is_a_request",
        COUNTS(.foreign = 1, .dropped = 7), WAIT(10000), QUEUE(B, 2), RECEIVE("01 10 00 20 00 28 50"),
        COUNT(FOREIGN_REQUESTS, 1), SENT(TIMEOUT_US - 1000, 2000)),
    /* a response of unit 17 with the value 0; its first seven bytes could also begin a read of 0x79 registers from 0x0200
     * on */
    ROW("a_response_that_could_also_begin_a_request_is_a_response",
        COUNTS(.no_responses = 1, .strays = 1, .dropped = 7), WAIT(10000), QUEUE(B, 17),
        WAIT(REQUEST_US + 2 * TIMEOUT_US), FAILS(B, NO_RESPONSE), QUEUE(A, 1), WAIT(REQUEST_US),
        RECEIVE("11 03 02 00 00 79 87"), COUNT(STRAYS, 1), PENDS(A)),
    /* rule 3: a read leaves into noise, but not if a frame was heard */
    ROW("a_foreign_request_before_the_wait_keeps_a_read_out_of_the_noise",
        COUNTS(.foreign = 1, .busy = 1, .dropped = 970), RECEIVE(READ_OF_2), QUEUE(A, 1),
        JAM(1000000 - 2 * BYTE_US), PENDS(A), JAM(4 * BYTE_US), FAILS(A, LINE_BUSY), WRITTEN(0)),
    ROW("a_foreign_request_during_the_wait_keeps_a_read_out_of_the_noise",
        COUNTS(.foreign = 1, .busy = 1, .dropped = 970), QUEUE(A, 1), JAM(100000), RECEIVE(READ_OF_2),
        JAM(900000 - 2 * BYTE_US), PENDS(A), JAM(4 * BYTE_US), FAILS(A, LINE_BUSY), WRITTEN(0)),
    /* rule 14: a foreign request may have been among the dropped bytes */
    ROW("after_dropped_bytes_no_frame_is_a_response_to_the_request_on_the_wire",
        COUNTS(.old = 1, .no_responses = 1, .dropped = 7), ASK(A, 1), FLUSH, RECEIVE("00"),
        COUNT(OLD_BYTES, 1), WAIT(100), RESPONSE(1, 754), PENDS(A), WAIT(TIMEOUT_US), FAILS(A, NO_RESPONSE)),
    ROW("after_dropped_bytes_the_line_sends_nothing_for_a_second_and_the_next_response_counts",
        COUNTS(.old = 1, .responses = 1), FLUSH, RECEIVE("00"), WAIT(100), QUEUE(A, 1),
        SENT(1000000 - 500, 1000), WAIT(8 * BYTE_US), RESPONSE(1, 754), READS(A, 754)),
    /* MODBUS over Serial Line V1.02, 2.2: addresses 248 to 255 are reserved */
    ROW("a_foreign_request_is_to_a_unit_up_to_247", COUNTS(.foreign = 1, .dropped = 16),
        RECEIVE("F7 03 01 00 00 01 91 60"), COUNT(FOREIGN_REQUESTS, 1), WAIT(10000),
        RECEIVE("F8 03 01 00 00 01 91 9F")),
};
CONVERSATIONS(set_up_masters, conversations)

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
