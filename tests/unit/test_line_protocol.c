/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* What line.h promises a protocol that is not from here: fathom_protocol_t and fathom_match_t. This one asks with one
 * byte, '?'. An answer is its unit (1..15), a count and so many bytes. What a match need not say it says wrongly. */

static const suite_t suite = {.set_up = set_up};

static fathom_exchange_t exchange;
static unsigned looks; /* at received bytes */

static void protocol(fathom_exchange_t *asked, uint8_t *frame, uint8_t have, fathom_match_t *match)
{
    if (have == 0) {
        frame[0] = '?';
        match->length = 1;
        return;
    }
    looks++;
    match->status = FATHOM_READY; /* counts of a whole frame only */
    match->unit = 1;              /* counts where length is not 0 */
    match->request = 0;
    match->length = 0;
    if (frame[0] == 0 || frame[0] > 15) return;
    match->unit = frame[0];
    match->length = have < 2 ? 2 : (uint8_t)(frame[1] + 2);
    if (match->length <= have && (asked == NULL || asked->unit != frame[0])) match->status = FATHOM_PENDING;
}

static void start(void)
{
    memset(&exchange, 0, sizeof exchange);
    exchange.protocol = protocol;
    exchange.unit = 1;
    exchange.timeout_us = TIMEOUT_US;
    assert_int_equal(fathom_line_submit(&bench.line, &exchange), FATHOM_PENDING);
    run(T3_5_US + 200);
    run(BYTE_US + 100);
    looks = 0;
}

/* "its length, 1..255". */
TEST(a_request_may_be_one_byte)
{
    static const uint8_t answer[] = {1, 2, 0xF1, 0xF2};
    start();
    assert_int_equal(bench.fake.written, 1);
    assert_int_equal(bench.fake.writes[0].length, 1);
    assert_int_equal(bench.fake.writes[0].bytes[0], '?');
    receive(answer, sizeof answer);
    run(100);
    assert_int_equal(exchange.status, FATHOM_READY);
}

/* "status: of a whole frame". */
TEST(a_part_of_a_frame_is_no_answer_whatever_its_status_says)
{
    static const uint8_t part[] = {1, 3, 0xF1, 0xF2};
    start();
    receive(part, sizeof part);
    run(GAP_US - 200);
    assert_int_equal(exchange.status, FATHOM_PENDING);
    run(400);
    assert_int_equal(exchange.status, FATHOM_ERR_CHECKSUM);
    assert_int_equal(counter(FATHOM_LINE_ANSWERS), 0);
    assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), 4);
}

/* "length 0: none of its frames begins here": the first byte goes, and the next one is looked at. */
TEST(bytes_that_begin_no_frame_are_noise_whatever_their_status_says)
{
    static const uint8_t noise[] = {0xF1, 0xF2, 0xF3};
    static const uint8_t answer[] = {1, 1, 0xF1};
    start();
    receive(noise, sizeof noise);
    run(100);
    assert_int_equal(exchange.status, FATHOM_PENDING);
    assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), 3);
    receive(answer, sizeof answer);
    run(100);
    assert_int_equal(exchange.status, FATHOM_READY);
    assert_int_equal(counter(FATHOM_LINE_ANSWERS), 1);
    assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), 3);
}

/* "More than there are: so many are needed to tell": with fewer it is not asked again. A frame of 6 bytes is looked at
 * when 1, 2 and 6 of them are there. */
TEST(a_protocol_looks_again_when_as_many_bytes_are_there_as_it_needs)
{
    static const uint8_t answer[] = {1, 4, 0xF1, 0xF2, 0xF3, 0xF4};
    start();
    for (unsigned i = 0; i != sizeof answer; i++) {
        receive(answer + i, 1);
        run(1000);
    }
    assert_int_equal(exchange.status, FATHOM_READY);
    assert_int_equal(looks, 3);
}
