/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* A program that sleeps for as long as fathom_line_due_us says makes progress with every sleep. */

static const suite_t suite = {.set_up = set_up};

/* Of an answer that began in time half has come when the time-out is over: what is next is a byte, or the gap. */
TEST(an_answer_that_has_begun_when_its_time_is_over_is_waited_for_until_the_gap)
{
    ask_1_and_send(0);
    run(TIMEOUT_US - 2000);
    receive(answer_1_754, 4);
    run_in_steps(3000, 1000);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    assert_in_range(fathom_line_due_us(&bench.line), 1, GAP_US);
    receive(answer_1_754 + 4, 3);
    run_in_steps(100, 100);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
}

TEST(one_that_breaks_off_ends_with_the_gap)
{
    ask_1_and_send(0);
    run(TIMEOUT_US - 2000);
    receive(answer_1_754, 4);
    run_in_steps(3000, 1000);
    unsigned sleeps = 0;
    while (status_of(&bench.request) == FATHOM_PENDING) {
        const uint32_t due_us = fathom_line_due_us(&bench.line);
        assert_in_range(due_us, 1, GAP_US);
        run_in_steps(due_us, due_us);
        sleeps++;
    }
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_CHECKSUM);
    assert_int_equal(sleeps, 1);
}

/* A request that does not wait: between the poll that sees it leave and the next one it is due at once. */
TEST(without_a_time_out_it_is_due_at_once)
{
    uint16_t value = 0;
    fathom_modbus_request_t request = {.exchange = {.timeout_us = 0}};
    fathom_modbus_read_holding_registers(&request.message, 1, 0x0100, 1, &value);
    assert_int_equal(fathom_modbus_client_submit(&bench.line, &request), FATHOM_PENDING);
    for (unsigned i = 0; request.exchange.status == FATHOM_PENDING && fathom_line_due_us(&bench.line) != 0;
         i++) {
        assert_true(i < 100);
        const uint32_t due_us = fathom_line_due_us(&bench.line);
        run_in_steps(due_us, due_us);
    }
    assert_int_equal(request.exchange.status, FATHOM_PENDING);
    assert_int_equal(request.exchange.attempts, 1);
    run_in_steps(1, 1);
    assert_int_equal(request.exchange.status, FATHOM_ERR_NO_ANSWER);
}
