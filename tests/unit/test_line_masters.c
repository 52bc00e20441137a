/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* line.h, rule 15: what the line concludes from frames of other masters that are no simple requests. */

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
