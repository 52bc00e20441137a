/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* fathom_line_is_idle(), for what shares a pin with the line. */

static void expect_idle(bool is_idle) { assert_int_equal(fathom_line_is_idle(&bench.line), is_idle); }

static const suite_t suite = {.set_up = set_up};
static const suite_t asked = {.set_up = set_up_asked};

TEST(a_new_line_and_one_with_a_waiting_request_are_idle)
{
    expect_idle(true);
    ask_1(0);
    expect_idle(true);
    run(1000); /* the silence before a request is not over */
    expect_idle(true);
    run(10000);
    expect_idle(false);
}

TEST(it_is_busy_from_the_request_to_the_response)
{
    run(10000);
    ask_1(0);
    expect_written_after(100, 1);
    expect_idle(false);
    run(50000);
    expect_idle(false);
    deliver(response_1_754, 6);
    expect_idle(false);
    deliver(response_1_754 + 6, 1);
    expect_mm(754);
    expect_idle(true);
}

TEST(a_port_that_takes_no_request_leaves_it_idle)
{
    bench.fake.write_busy = true;
    run(10000);
    ask_1(0);
    run(5000);
    expect_idle(true);
    bench.fake.write_busy = false;
    run(100);
    expect_idle(false);
}

TEST_IN(asked, a_quarantined_unit_does_not_keep_it_busy)
{
    expect_after(TIMEOUT_US + 1000, FATHOM_ERR_NO_RESPONSE);
    expect_idle(true);
    ask_1(0);
    expect_written_after(50000, 1); /* it still may come */
    expect_idle(true);
    deliver(response_1_754, 3); /* and does */
    expect_idle(false);
    deliver(response_1_754 + 3, 4);
    expect_idle(true);
}
