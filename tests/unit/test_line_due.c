/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* A program that sleeps for as long as fathom_line_due_us says makes progress with every sleep. */

/* Half of the answer came in time, and its time is over. */
static void receive_half_in_time(void)
{
    ask_1_and_send(0);
    run(TIMEOUT_US - 2000);
    receive(answer_1_754, 4);
    run_in_steps(3000, 1000);
    expect(FATHOM_PENDING);
}

static const suite_t suite = {.set_up = set_up};
static const suite_t asked = {.set_up = set_up_asked};

/* Of an answer that began in time half has come when the time-out is over: what is next is a byte, or the gap. */
TEST(an_answer_that_has_begun_when_its_time_is_over_is_waited_for_until_the_gap)
{
    receive_half_in_time();
    assert_in_range(due(), 1, GAP_US);
    deliver(answer_1_754 + 4, 3);
    expect_mm(754);
}

TEST(one_that_breaks_off_ends_with_the_gap)
{
    receive_half_in_time();
    unsigned sleeps = 0;
    while (status_of(&bench.request) == FATHOM_PENDING) {
        const uint32_t due_us = due();
        assert_in_range(due_us, 1, GAP_US);
        run_in_steps(due_us, due_us);
        sleeps++;
    }
    expect(FATHOM_ERR_CHECKSUM);
    assert_int_equal(sleeps, 1);
}

/* The CRC is 38 A1. None of it can begin an answer, so that it is dropped at once. */
TEST_IN(asked, the_end_of_a_damaged_answer_is_due_at_its_gap)
{
    receive_hex("01 03 02 02 F2 00 00");
    poll_line();
    expect(FATHOM_PENDING);
    expect_due(GAP_US);
    run_in_steps(GAP_US, GAP_US);
    expect(FATHOM_ERR_CHECKSUM);
}

TEST_IN(asked, a_damaged_answer_at_the_end_of_the_time_out_does_not_put_that_off)
{
    run(TIMEOUT_US - 2000);
    receive_hex("01 03 02 02 F2 00 00");
    poll_line();
    const uint32_t due_us = due();
    assert_in_range(due_us, 1000, 2000);
    run_in_steps(due_us, due_us);
    expect(FATHOM_ERR_CHECKSUM);
}

/* Not every port can say by an event that it has sent. */
TEST(bytes_that_come_while_the_request_leaves_do_not_put_off_the_next_look)
{
    ask_1(0);
    expect_written_after(T3_5_US + 200, 1);
    deliver(answer_1_754, 4);
    assert_int_equal(bench.line.have, 4);
    expect_due(1000);
}

TEST(where_nothing_is_due_no_time_that_passes_brings_it_nearer)
{
    poll_line();
    for (uint32_t passed_us = 1; passed_us < 2000000000; passed_us *= 10) {
        expect_due(FATHOM_NO_DEADLINE);
        bench.fake.now_us += passed_us;
    }
}

/* A request that does not wait: between the poll that sees it leave and the next one it is due at once. */
TEST(without_a_time_out_it_is_due_at_once)
{
    fathom_modbus_read_holding_registers(&bench.request.message, 1, 0x0100, 1, &bench.value);
    assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_PENDING);
    for (unsigned i = 0; status_of(&bench.request) == FATHOM_PENDING && due() != 0; i++) {
        assert_true(i < 100);
        const uint32_t due_us = due();
        run_in_steps(due_us, due_us);
    }
    expect(FATHOM_PENDING);
    assert_int_equal(bench.request.exchange.attempts, 1);
    run_in_steps(1, 1);
    expect(FATHOM_ERR_NO_ANSWER);
}
