/* SPDX-License-Identifier: MIT */
#include "libmodbus_rig.h"

static const uint8_t response_1[] = {RESPONSE(1)};
static const uint8_t other_1[] = {OTHER(1)};

static void ask_second(void)
{
    rig_ask_three(&rig.request, 1, 0);
    rig_run_fine(FINE_US);
    rig_expect_request(2);
}

static const suite_t suite = {.set_up = rig_tcp_set_up, .tear_down = rig_tear_down};

TEST(a_request_has_a_header_and_no_crc_and_its_response_is_read)
{
    rig_ask(0);
    rig.fake.now_us += 5000;
    rig_say_response(1);
    assert_int_equal(fathom_line_poll(rig.transport.line), FATHOM_PENDING);
    rig_expect_three();
    assert_int_equal(rig.request.transaction.attempts, 1);
    assert_int_equal(rig.request.transaction.link.heard_us, rig.fake.now_us);
    assert_int_equal(rig.port.counters[FATHOM_LINE_RESPONSES], 1);
}

TEST(every_request_has_a_transaction_of_its_own)
{
    rig_ask(0);
    rig_answered(1);
    ask_second();
    rig_answered(2);
}

TEST(transactions_begin_again_at_zero)
{
    static const uint8_t request[] = {0, 0, 0, 0, 0, 6, 1, 3, 1, 7, 0, 3};
    static const uint8_t response[] = {0, 0, 0, 0, 0, 9, 1, 3, 6, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A};
    rig.port.transaction = 0xFFFF;
    rig_ask_three(&rig.request, 1, 0);
    rig_run_fine(FINE_US);
    rig_expect_sent(request, sizeof request);
    rig_say(response, sizeof response);
    rig_run_fine(FINE_US);
    rig_expect_three();
}

TEST(a_response_that_comes_a_byte_at_a_time_is_read_when_it_is_whole)
{
    rig_ask(0);
    for (size_t i = 0; i != sizeof response_1; i++) {
        rig_expect_none();
        rig_say(response_1 + i, 1);
        rig_run_fine(5000); /* 75 ms in all; the time-out is 100 */
    }
    rig_expect_three();
}

TEST(a_response_cut_anywhere_is_no_response)
{
    for (size_t cut = 1; cut != sizeof response_1; cut++) {
        rig_again(cut == 1);
        rig_ask(0);
        rig_say(response_1, cut);
        rig_run_fine(RIG_TIMEOUT_US + 1000);
        assert_int_equal(status(), FATHOM_ERR_NO_RESPONSE);
        rig_expect_none();
    }
}

TEST(the_rest_of_a_cut_response_is_late_and_the_next_is_read)
{
    rig_ask(0);
    rig_say(response_1, 9);
    rig_run_fine(2 * RIG_TIMEOUT_US + 1000);
    assert_int_equal(status(), FATHOM_ERR_NO_RESPONSE);
    ask_second();
    rig_say(response_1 + 9, sizeof response_1 - 9);
    rig_run_fine(1000);
    rig_expect_none();
    rig_answered(2);
    assert_int_equal(rig.port.late_responses, 1);
}

/* Twice the time-out after the request its unit may be asked again, and only the transaction tells the two apart. */
TEST(a_response_to_an_earlier_transaction_is_never_taken)
{
    rig_ask(0);
    rig_run_fine(2 * RIG_TIMEOUT_US + 1000);
    assert_int_equal(status(), FATHOM_ERR_NO_RESPONSE);
    ask_second();
    rig_say(other_1, sizeof other_1);
    rig_run_fine(1000);
    assert_int_equal(status(), FATHOM_PENDING);
    rig_expect_none();
    rig_answered(2);
    assert_int_equal(rig.port.late_responses, 1);
}

TEST(responses_glued_together_are_told_apart)
{
    static const uint8_t glued[] = {OTHER(0), OTHER(7), RESPONSE(1), OTHER(1)};
    rig_ask(0);
    rig_say(glued, sizeof glued);
    rig_run_fine(FINE_US);
    rig_expect_three();
    assert_int_equal(rig.port.foreign_responses, 2);
    rig_run_fine(2000);
    /* A second response to the same: unit, PDU (8 bytes) and the CRC that it was given. */
    assert_int_equal(rig.port.counters[FATHOM_LINE_DROPPED_BYTES], 11);
    rig_expect_three();
}

TEST(many_foreign_responses_at_once_do_not_hide_the_right_one)
{
    rig_ask(0);
    for (int i = 0; i != 100; i++) rig_say((const uint8_t[]){OTHER(0)}, sizeof other_1);
    rig_say_response(1);
    rig_run_fine(10 * FINE_US);
    rig_expect_three();
    assert_int_equal(rig.port.foreign_responses, 100);
}

TEST(a_late_response_serves_the_retry_that_waits)
{
    rig_ask(1);
    rig_run_fine(RIG_TIMEOUT_US + 1000);
    assert_int_equal(status(), FATHOM_PENDING);
    rig_expect_sent(NULL, 0); /* its unit is quarantined */
    rig_answered(1);
    assert_int_equal(rig.request.transaction.attempts, 1);
    assert_int_equal(rig.port.counters[FATHOM_LINE_LATE_RESPONSES], 1);
}

TEST(retries_are_sent_and_then_it_has_failed)
{
    rig_ask(2);
    rig_run_fine(2 * RIG_TIMEOUT_US + 1000);
    rig_expect_request(2);
    rig_run_fine(2 * RIG_TIMEOUT_US);
    rig_expect_request(3);
    assert_int_equal(status(), FATHOM_PENDING);
    rig_run_fine(2 * RIG_TIMEOUT_US);
    assert_int_equal(status(), FATHOM_ERR_NO_RESPONSE);
    assert_int_equal(rig.request.transaction.attempts, 3);
    rig_expect_sent(NULL, 0);
}

/* What comes instead of a response leads to that outcome within that time, and to no values. */
static void expect_outcome(const uint8_t *instead, size_t length, uint32_t in_us, int outcome)
{
    rig_ask(0);
    rig_say(instead, length);
    rig_run_fine(in_us);
    assert_int_equal(status(), outcome);
    assert_int_equal(rig.port.gateway_exception, 0);
    rig_expect_none();
}

TEST(another_function_is_malformed)
{
    static const uint8_t wrong[] = {0xF0, 1, 0, 0, 0, 6, 1, 0x06, 0x01, 0x07, 0x00, 0x03};
    expect_outcome(wrong, sizeof wrong, RIG_TIMEOUT_US + 1000, FATHOM_ERR_MALFORMED);
}

/* Six bytes of registers are announced, four are there: by its header the frame is whole. */
static const uint8_t too_short[] = {0xF0, 1, 0, 0, 0, 7, 1, 0x03, 6, 0x00, 0xFA, 0x02, 0x93};

TEST(a_byte_count_that_is_not_the_headers_is_no_response_and_nothing_gets_out_of_step)
{
    rig_ask(1);
    rig_say(too_short, sizeof too_short);
    rig_run_fine(2 * RIG_TIMEOUT_US + 1000);
    rig_expect_none();
    rig_expect_request(2);
    rig_answered(2);
    assert_int_equal(rig.port.counters[FATHOM_LINE_CHECKSUM_ERRORS], 1);
}

TEST(a_damaged_response_is_given_up_at_once)
{
    expect_outcome(too_short, sizeof too_short, 2000, FATHOM_ERR_CHECKSUM);
}

/* An exception is three bytes behind the header. */
TEST(what_only_begins_like_a_gateways_exception_is_none)
{
    static const uint8_t longer[] = {0xF0, 1, 0, 0, 0, 4, 1, 0x83, 0x0B, 0x55};
    expect_outcome(longer, sizeof longer, RIG_TIMEOUT_US + 1000, FATHOM_ERR_CHECKSUM);
}

/* What says 11 where an exception would, but has not the bit of one: a count that nothing has asked for. */
TEST(what_is_as_long_as_a_gateways_exception_is_none)
{
    static const uint8_t plain[] = {0xF0, 1, 0, 0, 0, 3, 1, 0x03, 0x0B};
    expect_outcome(plain, sizeof plain, RIG_TIMEOUT_US + 1000, FATHOM_ERR_NO_RESPONSE);
    assert_int_equal(rig.port.gateway_refusals, 0);
}

TEST(exceptions_have_their_numbers)
{
    for (unsigned number = 1; number != 256; number++) {
        if (number == 0x0A || number == 0x0B) continue;
        rig_again(number == 1);
        rig_ask(0);
        rig_say((const uint8_t[]){REFUSAL(1, (uint8_t)number)}, 9);
        rig_run_fine(FINE_US);
        assert_int_equal(status(), FATHOM_ERR_EXCEPTION);
        assert_int_equal(rig.request.message.exception, number);
        assert_int_equal(rig.port.gateway_exception, 0);
    }
}

TEST(counters_stop_at_65535)
{
    static const uint8_t other_unit[] = {0xF0, 1, 0, 0, 0, 3, 2, 0x83, 2};
    rig.port.late_responses = rig.port.foreign_responses = UINT16_MAX;
    rig.port.other_units = rig.port.gateway_refusals = UINT16_MAX;
    rig_ask(0);
    rig_answered(1);
    ask_second();
    rig_say((const uint8_t[]){OTHER(1), OTHER(7), REFUSAL(2, 0x0A)}, 2 * sizeof other_1 + 9);
    rig_run_fine(FINE_US);
    rig_say(other_unit, sizeof other_unit);
    rig_run_fine(FINE_US);
    assert_int_equal(rig.port.gateway_exception, 0x0A);
    assert_int_equal(rig.port.late_responses, UINT16_MAX);
    assert_int_equal(rig.port.foreign_responses, UINT16_MAX);
    assert_int_equal(rig.port.gateway_refusals, UINT16_MAX);
}

/* 125 registers are 253 bytes behind the header; the longest that Modbus has are 254. */
TEST(the_longest_response_is_read_and_a_longer_one_dropped)
{
    static uint8_t longer[6 + 254] = {0xF0, 1, 0, 0, 0, 254, 1, 0x03, 251};
    static uint8_t response[6 + 253] = {0xF0, 1, 0, 0, 0, 253, 1, 0x03, 250};
    rig.request.transaction.timeout_us = RIG_TIMEOUT_US;
    fathom_modbus_read_holding_registers(&rig.request.message, 1, 0, 125, rig.values);
    assert_int_equal(rig.transport.submit(rig.transport.line, &rig.request), FATHOM_PENDING);
    rig_run_fine(FINE_US);
    for (uint8_t i = 0; i != 250; i++) response[9 + i] = i;
    rig_say(longer, sizeof longer);
    rig_run_fine(1000);
    assert_int_equal(status(), FATHOM_PENDING);
    rig_say(response, sizeof response);
    rig_run_fine(FINE_US);
    assert_int_equal(status(), FATHOM_OK);
    for (uint8_t i = 0; i != 125; i++) assert_int_equal(rig.values[i], (2 * i) * 256 + 2 * i + 1);
}
