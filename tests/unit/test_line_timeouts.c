/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* The longest time-out is 2^31 - 1 us, 35 minutes: twice that, the quarantine, fits the clock. */

static const suite_t suite = {.set_up = set_up};

#define LONGEST_US UINT32_C(0x7FFFFFFF)

static fathom_status_t ask_for(uint32_t timeout_us)
{
    fathom_modbus_read_holding_registers(&bench.request.message, 1, 0x0100, 1, &bench.value);
    bench.request.transaction.timeout_us = timeout_us;
    bench.request.transaction.retries = 0;
    return fathom_modbus_client_submit(&bench.line, &bench.request);
}

TEST(a_unit_is_quarantined_for_twice_the_longest_time_out)
{
    assert_int_equal(ask_for(LONGEST_US), FATHOM_PENDING);
    run(T3_5_US + 200);
    assert_int_equal(bench.fake.written, 1);
    fathom_line_cancel(&bench.line, &bench.request.transaction); /* while it leaves */
    bench.fake.now_us += 10000;
    (void)fathom_line_poll(&bench.line); /* now it has left */
    assert_true(bench.line.quarantine_left_us == 2 * LONGEST_US);

    assert_int_equal(ask_for(1000), FATHOM_PENDING);
    assert_true(fathom_line_due_us(&bench.line) == 2 * LONGEST_US);
    for (unsigned i = 0; i != 2; i++) {
        bench.fake.now_us += LONGEST_US - 1000;
        (void)fathom_line_poll(&bench.line);
    }
    assert_int_equal(bench.fake.written, 1);
    bench.fake.now_us += 2000;
    (void)fathom_line_poll(&bench.line);
    assert_int_equal(bench.fake.written, 2);
}

TEST(a_time_out_over_the_longest_is_refused_and_not_cut)
{
    static const uint32_t too_long_us[] = {LONGEST_US + 1, UINT32_C(0x90000000), UINT32_MAX};
    for (unsigned i = 0; i != 3; i++) {
        bench.request.transaction.status = FATHOM_OK;
        assert_int_equal(ask_for(too_long_us[i]), FATHOM_ERR_ARGUMENT);
        assert_int_equal(status_of(&bench.request), FATHOM_OK);
        assert_false(fathom_line_is_queued(&bench.line, &bench.request.transaction));
    }
    run(T3_5_US + 200);
    assert_int_equal(bench.fake.written, 0);
}
