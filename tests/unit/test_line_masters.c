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

#define READ_OF_1  "01 03 01 00 00 01 85 F6"
#define OTHER_OF_1 "01 03 02 00 00 01 85 B2" /* the address register */
#define READ_OF_2  "02 03 01 00 00 01 85 C5"

/* From the first response on, the line recognises frames. After `await` the line sends nothing for 1 s (`busy_us`). */
#define BEGIN         ASK(A, 1), RESPONSE(1, 754)
#define FOREIGN       RECEIVE(READ_OF_2)
#define SENT_AT_ONCE  QUEUE(A, 1), SENT(T3_5_US - 600, 800)
#define SENT_AFTER_1S QUEUE(A, 1), SENT(900000, 101000)

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
    /* the comment of line_masters.c: which frame is the response to a foreign request */
    ROW("after_a_foreign_request_the_line_waits_for_a_frame_of_its_unit",
        COUNTS(.responses = 1, .foreign = 1, .strays = 2, .dropped = 22), BEGIN, FOREIGN, QUEUE(A, 1),
        WAIT(20000), RESPONSE(3, 5), WAIT(20000), WRITTEN(1), RESPONSE(2, 5), SENT(T3_5_US - 600, 800)),
    /* busy_us, 1 s, after the foreign request; the line sees the end of that time 1 us before it */
    ROW("the_end_of_the_wait_for_another_masters_response_is_due",
        COUNTS(.responses = 1, .foreign = 1, .dropped = 8), BEGIN, FOREIGN, QUEUE(A, 1), POLL_AFTER(100000),
        DUE(899999)),
    ROW("each_request_of_a_master_that_polls_has_its_response",
        COUNTS(.responses = 1, .foreign = 2, .strays = 2, .dropped = 30), BEGIN, FOREIGN, RESPONSE(2, 5),
        FOREIGN, RESPONSE(2, 5), SENT_AT_ONCE),
    ROW("a_frame_after_two_foreign_requests_may_be_the_response_to_either",
        COUNTS(.responses = 1, .foreign = 2, .strays = 1, .dropped = 23), BEGIN, FOREIGN, FOREIGN,
        RESPONSE(2, 5), SENT_AFTER_1S),
    ROW("a_foreign_request_to_the_unit_of_ours_makes_its_frames_unclear",
        COUNTS(.foreign = 1, .other_masters = 1, .strays = 1, .dropped = 15), ASK(A, 1), WAIT(50000),
        RECEIVE(OTHER_OF_1), WAIT(TIMEOUT_US - 50000), FAILS(A, OTHER_MASTER), RESPONSE(1, 5), QUEUE(B, 2),
        SENT(TIMEOUT_US - 60000, 11000)),
    ROW("a_copy_of_a_write_is_no_response_to_another_master",
        COUNTS(.responses = 1, .foreign = 1, .strays = 2, .dropped = 23), BEGIN, FOREIGN,
        RECEIVE("02 06 02 00 00 05 48 42"), QUEUE(A, 1), WAIT(20000), WRITTEN(1), RESPONSE(2, 5),
        SENT(T3_5_US - 600, 800)),
    ROW("a_copy_of_a_write_is_no_late_response", COUNTS(.no_responses = 1, .strays = 1, .dropped = 8),
        ASK(B, 2), WAIT(TIMEOUT_US + 200), FAILS(B, NO_RESPONSE), RECEIVE("02 06 02 00 00 05 48 42")),
    ROW("a_response_to_another_master_makes_no_later_response_foreign",
        COUNTS(.responses = 1, .foreign = 1, .no_responses = 1, .strays = 1, .late = 1, .dropped = 22), BEGIN,
        FOREIGN, RESPONSE(2, 5), ASK(B, 2), WAIT(TIMEOUT_US + 200), FAILS(B, NO_RESPONSE), RESPONSE(2, 5)),
    ROW("after_dropped_bytes_no_frame_is_a_late_response",
        COUNTS(.old = 1, .no_responses = 1, .strays = 1, .dropped = 7), ASK(B, 2), WAIT(TIMEOUT_US + 200),
        FAILS(B, NO_RESPONSE), FLUSH, RECEIVE("00"), WAIT(100), RESPONSE(2, 5)),
    /* the same: two frames in a row that no master requested show a unit that sends by itself */
    ROW("one_frame_without_a_request_shows_no_sender",
        COUNTS(.responses = 1, .foreign = 2, .strays = 3, .dropped = 37), BEGIN, FOREIGN, RESPONSE(2, 5),
        RESPONSE(2, 5), FOREIGN, RESPONSE(2, 5), SENT_AT_ONCE),
    ROW("two_frames_without_a_request_show_a_sender",
        COUNTS(.responses = 1, .foreign = 1, .strays = 3, .dropped = 29), BEGIN, RESPONSE(2, 5),
        RESPONSE(2, 5), FOREIGN, RESPONSE(2, 5), SENT_AFTER_1S),
    ROW("three_frames_without_a_request_show_a_sender",
        COUNTS(.responses = 1, .foreign = 1, .strays = 4, .dropped = 36), BEGIN, RESPONSE(2, 5),
        RESPONSE(2, 5), RESPONSE(2, 5), FOREIGN, RESPONSE(2, 5), SENT_AFTER_1S),
    ROW("two_frames_of_other_units_than_the_requested_one_show_a_sender",
        COUNTS(.responses = 1, .foreign = 2, .strays = 4, .dropped = 44), BEGIN, FOREIGN, RESPONSE(3, 5),
        RESPONSE(3, 5), RESPONSE(2, 5), FOREIGN, RESPONSE(2, 5), SENT_AFTER_1S),
    ROW("one_frame_more_than_the_unclear_response_shows_no_sender",
        COUNTS(.responses = 1, .foreign = 3, .strays = 3, .dropped = 45), BEGIN, FOREIGN, FOREIGN,
        RESPONSE(2, 5), RESPONSE(2, 5), FOREIGN, RESPONSE(2, 5), SENT_AT_ONCE),
    ROW("two_frames_more_than_the_unclear_response_show_a_sender",
        COUNTS(.responses = 1, .foreign = 3, .strays = 4, .dropped = 52), BEGIN, FOREIGN, FOREIGN,
        RESPONSE(2, 5), RESPONSE(2, 5), RESPONSE(2, 5), FOREIGN, RESPONSE(2, 5), SENT_AFTER_1S),
    ROW("two_unclear_frames_of_the_unit_of_our_request_show_a_sender",
        COUNTS(.foreign = 2, .other_masters = 1, .strays = 1, .dropped = 37), ASK(A, 1), RECEIVE(OTHER_OF_1),
        RESPONSE(1, 5), RESPONSE(1, 5), WAIT(TIMEOUT_US + 200), FAILS(A, OTHER_MASTER), FOREIGN,
        RESPONSE(2, 5), SENT_AFTER_1S),
    ROW("the_echo_of_a_cancelled_request_is_no_foreign_request_once", COUNTS(.foreign = 1, .dropped = 16),
        ECHO(ON), ASK(A, 1), CANCEL(A), RECEIVE(READ_OF_1), COUNT(FOREIGN_REQUESTS, 0), WAIT(10000),
        RECEIVE(READ_OF_1)),
    ROW("after_a_gap_no_echo_of_a_cancelled_request_is_due", COUNTS(.foreign = 1, .dropped = 8), ECHO(ON),
        ASK(A, 1), CANCEL(A), WAIT(2 * GAP_US), RECEIVE(READ_OF_1)),
    ROW("a_request_to_another_unit_is_no_echo_of_a_cancelled_request", COUNTS(.foreign = 1, .dropped = 8),
        ECHO(ON), ASK(A, 1), CANCEL(A), FOREIGN),
    /* 55 + AA + 11 + 01 = 111: the unit of our request is the third byte */
    ROW("a_request_of_55_aa_to_the_unit_of_ours_makes_its_frames_unclear",
        COUNTS(.foreign = 1, .other_masters = 1, .dropped = 5), ASK(A, 17), RECEIVE("55 AA 11 01 11"),
        WAIT(TIMEOUT_US), FAILS(A, OTHER_MASTER)),
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

/* CRCs by the polynomial A001; the sum of 02 AA 01 01 is AE. */
TEST(a_foreign_request_is_a_read_or_a_write_of_a_number_of_registers_that_modbus_allows)
{
    static const struct {
        const char *hex;
        unsigned count;
    } rows[] = {
        {"00 03 01 00 00 01 84 27", 0},          /* a broadcast */
        {"02 05 01 00 00 01 02 00 05 A3 50", 0}, /* function 05 */
        {"02 03 01 00 01 01 84 55", 0},          /* 257 registers */
        {"02 03 01 00 00 00 44 05", 0},          /* none */
        {"02 03 01 00 00 7D 84 24", 1},          /* 125 */
        {"02 04 01 00 00 7E 71 E5", 0},          /* 126 */
        {"02 10 00 20 00 7B F6", 1},             /* 123, longer than the frame buffer */
        {"02 10 00 20 00 7C F8", 0},             /* 124 */
        {"02 10 00 20 00 01 03 00 05 24 03", 0}, /* one register in 3 bytes */
        {"55 03 01 00 00 01 88 22", 1},          /* unit 85: no 55 AA */
        {"02 AA 01 01 AE", 0},                   /* no 55 AA either */
    };
    for (unsigned i = 0; i != COUNT_OF(rows); i++) {
        set_up_masters(state);
        play_receive(&(step_t){.hex = rows[i].hex});
        run(10000);
        expect_count(FATHOM_LINE_FOREIGN_REQUESTS, rows[i].count);
    }
}
