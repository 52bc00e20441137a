/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* What line.h promises a protocol that is not from here: fathom_protocol_t. This one asks with one byte, '?'. A
 * response is its unit (1..15), a count and so many bytes; there is no checksum but that FF as the last byte is
 * wrong. */

static const suite_t suite = {.set_up = set_up};

static fathom_transaction_t transaction;

static uint8_t encode(const fathom_transaction_t *asked, uint8_t *frame)
{
    (void)asked;
    frame[0] = '?';
    return 1;
}

static uint8_t length_of(const uint8_t *frame, uint8_t have)
{
    if (frame[0] == 0 || frame[0] > 15) return 0;
    return have < 2 ? 2 : (uint8_t)(frame[1] + 2);
}

static uint16_t check(const uint8_t *frame, uint8_t length) { return frame[length - 1] == 0xFF; }

static bool is_request(const fathom_transaction_t *asked, const uint8_t *frame, uint8_t have)
{
    (void)asked;
    (void)have;
    return frame[0] == '?';
}

/* "from a unit that was asked": of another nothing is to be judged. */
static fathom_status_t response_of(fathom_transaction_t *asked, const uint8_t *frame)
{
    assert_int_equal(frame[0], asked->address);
    return frame[1] == 9 ? FATHOM_ERR_MALFORMED : FATHOM_OK;
}

static const fathom_protocol_t protocol = {.encode = encode,
                                           .length = length_of,
                                           .check = check,
                                           .is_request = is_request,
                                           .parse_response = response_of};

static void start(void)
{
    memset(&transaction, 0, sizeof transaction);
    transaction.protocol = &protocol;
    transaction.address = 1;
    transaction.timeout_us = TIMEOUT_US;
    assert_int_equal(fathom_line_submit(&bench.line, &transaction), FATHOM_PENDING);
    run(T3_5_US + 200);
    run(BYTE_US + 100);
}

/* "its length, 1..255". */
TEST(a_request_may_be_one_byte)
{
    static const uint8_t response[] = {1, 2, 0xF1, 0xF2};
    start();
    assert_int_equal(bench.fake.written, 1);
    assert_int_equal(bench.fake.writes[0].length, 1);
    assert_int_equal(bench.fake.writes[0].bytes[0], '?');
    receive(response, sizeof response);
    run(100);
    assert_int_equal(transaction.status, FATHOM_OK);
}

/* A line that only listens has no room for it. */
TEST(nothing_is_submitted_to_a_line_that_only_listens)
{
    assert_int_equal(fathom_line_init_listening(&bench.line, &bench.config), FATHOM_OK);
    memset(&transaction, 0, sizeof transaction);
    transaction.protocol = &protocol;
    transaction.address = 1;
    assert_int_equal(fathom_line_submit(&bench.line, &transaction), FATHOM_ERR_UNSUPPORTED);
    assert_false(fathom_line_is_queued(&bench.line, &transaction));
    run(100000);
    expect_written(0);
}
