/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* fathom_line_is_idle(), for what shares a pin with the line. */

static bool is_idle(void) { return fathom_line_is_idle(&bench.line); }

static const suite_t suite = {.set_up = set_up};

TEST(a_new_line_and_one_with_a_waiting_request_are_idle)
{
    assert_true(is_idle());
    ask(&bench.request, 1, &bench.value, 0);
    assert_true(is_idle());
    run(1000); /* the silence before a request is not over */
    assert_true(is_idle());
    run(10000);
    assert_false(is_idle());
}

TEST(it_is_busy_from_the_request_to_the_answer)
{
    bench.fake.byte_us = BYTE_US;
    run(10000);
    ask(&bench.request, 1, &bench.value, 0);
    run(100);
    assert_int_equal(bench.fake.written, 1);
    assert_false(is_idle());
    run(50000);
    assert_false(is_idle());
    receive(answer_1_754, 6);
    run(100);
    assert_false(is_idle());
    receive(answer_1_754 + 6, 1);
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_true(is_idle());
}

TEST(a_unit_that_owes_an_answer_does_not_keep_it_busy)
{
    ask_1_and_send(0);
    run(TIMEOUT_US + 1000);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_NO_ANSWER);
    assert_true(is_idle());
    ask(&bench.request, 1, &bench.value, 0);
    run(50000);
    assert_int_equal(bench.fake.written, 1); /* it still may come */
    assert_true(is_idle());
    receive(answer_1_754, 3); /* and does */
    run(100);
    assert_false(is_idle());
    receive(answer_1_754 + 3, 4);
    run(100);
    assert_true(is_idle());
}

TEST(a_port_that_takes_no_request_leaves_it_idle)
{
    bench.fake.write_busy = true;
    run(10000);
    ask(&bench.request, 1, &bench.value, 0);
    run(5000);
    assert_true(is_idle());
    bench.fake.write_busy = false;
    run(100);
    assert_false(is_idle());
}
