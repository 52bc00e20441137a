/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* The two units with a meaning of their own: 255, the one that answers first, and 0, all of them. */

/* FF + FF + 10 = 20E. */

/* 07xx mm from a unit, at probe 1; so much of it. */
static void receive_first_probe(uint8_t unit, uint8_t low, size_t length)
{
    const uint8_t frame[] = {0x55, 0xAA, unit, 0x10, 0x07, low, (uint8_t)(0xFF + unit + 0x10 + 0x07 + low)};
    receive(frame, length);
}

static void ask_any(void)
{
    const size_t before = bench.fake.written;
    ask_dyp(&bench.request, 255, 1, &bench.value);
    run(T3_5_US + 200);
    expect_hex(before, "55 AA FF 10 0E");
    run(5 * BYTE_US + 100);
}

static const suite_t suite = {.set_up = set_up};

TEST(any_unit_may_answer_who_asked_them_all)
{
    for (unsigned unit = 1; unit != 255; unit++) {
        set_up(state);
        ask_any();
        receive_first_probe((uint8_t)unit, (uint8_t)unit, 7);
        run(100);
        expect_mm((uint16_t)(0x0700 + unit));
        assert_int_equal(bench.request.message.head[0], unit);
    }
}

TEST(after_a_request_to_unit_255_none_is_asked_until_twice_its_time_out)
{
    for (unsigned unit = 1; unit != 255; unit++) {
        set_up(state);
        ask_any();
        expect_after(TIMEOUT_US + 200, FATHOM_ERR_NO_RESPONSE);
        ask_other((uint8_t)unit);
        run_in_steps(TIMEOUT_US - 1000, 500);
        expect_written(1);
        expect_written_after(1500, 2);
    }
}

TEST(a_late_response_to_a_request_to_unit_255_is_no_other_requests)
{
    ask_any();
    run(TIMEOUT_US + 200);
    ask_dyp(&bench.other, 9, 1, &bench.other_value);
    run(20000);
    receive_first_probe(9, 0xA1, 7);
    run(100);
    expect_count(FATHOM_LINE_LATE_RESPONSES, 1);
    assert_int_equal(bench.other_value, 0xDEAD);
    expect_other(FATHOM_PENDING);
}

TEST(a_cancelled_request_to_unit_255_quarantines_all)
{
    ask_any();
    cancel(&bench.request);
    ask_other(77);
    expect_sent(2 * TIMEOUT_US - 1000, 2000);
}

/* Two A05 respond to FF, the second one 10 ms later (A05 2(3)1: 65..75 ms). */
TEST(the_second_response_to_unit_255_is_not_the_next_requests)
{
    ask_any();
    run(65000);
    receive_first_probe(5, 0xA1, 7);
    expect_after(100, FATHOM_OK);
    ask_dyp(&bench.other, 254, 1, &bench.other_value);
    run(10000);
    receive_first_probe(254, 0xA1, 7);
    run(100);
    assert_int_equal(bench.other_value, 0xDEAD);
}
