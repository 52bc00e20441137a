/* SPDX-License-Identifier: MIT */
#include "fathom/dyp_client.h"
#include "line_bench.h"

/* The two units with a meaning of their own: 255, whoever answers first, and 0, all are told. */

/* FF + FF + 10 = 20E. */
static const uint8_t ask_anyone[] = {0x55, 0xAA, 0xFF, 0x10, 0x0E};

static size_t make_first_probe(uint8_t *frame, uint8_t unit, uint8_t low)
{
    const uint8_t made[] = {0x55, 0xAA, unit, 0x10, 0x07, low, (uint8_t)(0xFF + unit + 0x10 + 0x07 + low)};
    memcpy(frame, made, sizeof made);
    return sizeof made;
}

static void receive_first_probe(uint8_t unit, uint8_t low)
{
    uint8_t frame[7];
    receive(frame, make_first_probe(frame, unit, low));
}

static void ask_any(uint8_t retries)
{
    const size_t before = bench.fake.written;
    fathom_modbus_read_holding_registers(&bench.request.message, 255, 0x0106, 1, &bench.value);
    bench.request.exchange.timeout_us = TIMEOUT_US;
    bench.request.exchange.retries = retries;
    bench.value = 0xDEAD;
    assert_int_equal(fathom_dyp_client_submit(&bench.line, &bench.request), FATHOM_PENDING);
    run(T3_5_US + 200);
    assert_int_equal(bench.fake.written, before + 1);
    assert_memory_equal(bench.fake.writes[before].bytes, ask_anyone, sizeof ask_anyone);
    run(5 * BYTE_US + 100);
}

static const suite_t suite = {.set_up = set_up};

TEST(any_unit_may_answer_who_asked_them_all)
{
    for (unsigned unit = 1; unit != 255; unit++) {
        set_up(state);
        ask_any(0);
        receive_first_probe((uint8_t)unit, (uint8_t)unit);
        run(100);
        assert_int_equal(status_of(&bench.request), FATHOM_READY);
        assert_int_equal(bench.value, 0x0700 + unit);
        assert_int_equal(bench.request.message.head[0], unit);
    }
}

TEST(what_is_damaged_is_nobodys_answer)
{
    uint8_t frame[7];
    ask_any(0);
    receive(frame, make_first_probe(frame, 9, 0xA1) - 2);
    run(GAP_US + 300);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_CHECKSUM);
    assert_int_equal(bench.value, 0xDEAD);
    assert_int_equal(bench.request.message.head[0], 255);
}

TEST(after_a_question_to_anyone_nobody_is_asked_until_twice_its_time_out)
{
    for (unsigned unit = 1; unit != 255; unit++) {
        set_up(state);
        ask_any(0);
        run(TIMEOUT_US + 200);
        assert_int_equal(status_of(&bench.request), FATHOM_ERR_NO_ANSWER);
        ask(&bench.other, (uint8_t)unit, &bench.other_value, 0);
        run_in_steps(TIMEOUT_US - 1000, 500);
        assert_int_equal(bench.fake.written, 1);
        run(1500);
        assert_int_equal(bench.fake.written, 2);
    }
}

TEST(nobody_is_asked_for_anyone_while_somebody_owes)
{
    ask_1_and_send(0);
    run(TIMEOUT_US + 200);
    fathom_modbus_read_holding_registers(&bench.other.message, 255, 0x0106, 1, &bench.other_value);
    bench.other.exchange.timeout_us = TIMEOUT_US;
    assert_int_equal(fathom_dyp_client_submit(&bench.line, &bench.other), FATHOM_PENDING);
    run(TIMEOUT_US - 1000);
    assert_int_equal(bench.fake.written, 1);
    run(1500);
    assert_int_equal(bench.fake.written, 2);
}

TEST(a_late_answer_to_a_question_to_anyone_is_no_other_requests)
{
    ask_any(0);
    run(TIMEOUT_US + 200);
    fathom_modbus_read_holding_registers(&bench.other.message, 9, 0x0106, 1, &bench.other_value);
    bench.other.exchange.timeout_us = TIMEOUT_US;
    bench.other_value = 0xDEAD;
    assert_int_equal(fathom_dyp_client_submit(&bench.line, &bench.other), FATHOM_PENDING);
    run(20000);
    receive_first_probe(9, 0xA1);
    run(100);
    assert_int_equal(counter(FATHOM_LINE_LATE_ANSWERS), 1);
    assert_int_equal(bench.other_value, 0xDEAD);
    assert_int_equal(status_of(&bench.other), FATHOM_PENDING);
}

TEST(a_cancelled_question_to_anyone_is_owed_by_all)
{
    ask_any(0);
    fathom_line_cancel(&bench.line, &bench.request.exchange);
    ask(&bench.other, 77, &bench.other_value, 0);
    run(2 * TIMEOUT_US - 1000);
    assert_int_equal(bench.fake.written, 1);
    run(2000);
    assert_int_equal(bench.fake.written, 2);
}

TEST(what_all_are_told_none_owes_an_answer_to)
{
    fathom_modbus_write_single_register(&bench.request.message, 0, 0x0200, 5);
    bench.request.exchange.timeout_us = TIMEOUT_US;
    assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_PENDING);
    run(T3_5_US + 8 * BYTE_US + 400);
    ask(&bench.other, 16, &bench.other_value, 0); /* modulo 16 the same */
    receive_answer(3, 333);                       /* a unit that answers all the same is not heard */
    run(TIMEOUT_US - 1000);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    assert_int_equal(bench.fake.written, 1);
    run(1500);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_int_equal(bench.fake.written, 2);
    assert_int_equal(counter(FATHOM_LINE_NO_ANSWERS) + counter(FATHOM_LINE_ANSWERS), 0);
}

TEST(a_cancelled_broadcast_is_owed_by_none)
{
    fathom_modbus_write_single_register(&bench.request.message, 0, 0x0200, 5);
    bench.request.exchange.timeout_us = TIMEOUT_US;
    assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_PENDING);
    run(T3_5_US + 8 * BYTE_US + 400);
    fathom_line_cancel(&bench.line, &bench.request.exchange);
    ask(&bench.other, 16, &bench.other_value, 0);
    run(T3_5_US + 400);
    assert_int_equal(bench.fake.written, 2);
}

TEST(a_request_that_was_cancelled_on_its_way_is_owed_from_then_on)
{
    ask(&bench.request, 1, &bench.value, 0);
    run(T3_5_US + 200);
    assert_int_equal(bench.fake.written, 1);
    fathom_line_cancel(&bench.line, &bench.request.exchange);
    ask(&bench.other, 1, &bench.other_value, 0);
    run(2 * TIMEOUT_US - 1000);
    assert_int_equal(bench.fake.written, 1);
    run(2000);
    assert_int_equal(bench.fake.written, 2);
}
