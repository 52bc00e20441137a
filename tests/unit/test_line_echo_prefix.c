/* SPDX-License-Identifier: MIT */
#include "echo_bench.h"

/*
 * A read whose request begins with a whole answer to it: 53 03 02 00 00 01 88 are seven of the eight bytes that ask
 * unit 83 for register 0200, the address of an A16 or A05, and they say that it is 0. 0188, low byte first, is the CRC
 * of 53 03 02 00 00. Unit 147 is the other one: 93 03 02 00 00 01 99.
 */
typedef struct {
    uint8_t unit;
    uint8_t request[8];
    uint8_t answer[7]; /* the register holds the address */
} prefix_t;

static const prefix_t prefixes[] = {
    {83, {0x53, 0x03, 0x02, 0x00, 0x00, 0x01, 0x88, 0x00}, {0x53, 0x03, 0x02, 0x00, 0x53, 0x41, 0xB5}},
    {147, {0x93, 0x03, 0x02, 0x00, 0x00, 0x01, 0x99, 0x00}, {0x93, 0x03, 0x02, 0x00, 0x93, 0x41, 0xF4}},
};

static void ask_address(const prefix_t *prefix, uint32_t step_us)
{
    const size_t before = bench.fake.written;
    bench.value = 0xDEAD;
    fathom_modbus_read_holding_registers(&bench.request.message, prefix->unit, 0x0200, 1, &bench.value);
    bench.request.exchange.timeout_us = TIMEOUT_US;
    bench.request.exchange.retries = 0;
    assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_PENDING);
    run_until_written(before + 1, step_us);
    assert_memory_equal(bench.fake.writes[before].bytes, prefix->request, 8);
}

static void echoed_prefix(void **state, uint8_t mode, unsigned seed, uint32_t pause_us, uint32_t step_us)
{
    for (size_t i = 0; i != COUNT_OF(prefixes); i++) {
        if (mode == FATHOM_LINE_ECHO_OFF) return; /* told that there is none, while there is */
        set_up_with(state, mode);
        ask_address(&prefixes[i], step_us);
        come(seed, 0, prefixes[i].request, 8);
        come(seed, 8 * BYTE_US + pause_us, prefixes[i].answer, 7);
        run_in_steps(80000, step_us);
        assert_int_equal(status_of(&bench.request), FATHOM_READY);
        assert_int_equal(bench.value, prefixes[i].unit);
        assert_int_equal(counter(FATHOM_LINE_ANSWERS), 1);
    }
}

static const suite_t suite = {.set_up = set_up};

TEST(an_echo_that_begins_with_a_whole_answer_is_no_answer) { in_every_way(state, echoed_prefix); }

TEST(an_echo_that_begins_with_a_whole_answer_and_nothing_else_is_a_failure)
{
    for (size_t i = 0; i != COUNT_OF(prefixes); i++)
        for (size_t m = 0; m != COUNT_OF(modes); m++) {
            if (modes[m] == FATHOM_LINE_ECHO_OFF) continue;
            set_up_with(state, modes[m]);
            ask_address(&prefixes[i], 100);
            come(BY_BYTE, 0, prefixes[i].request, 8);
            run(2 * TIMEOUT_US);
            assert_int_equal(status_of(&bench.request),
                             modes[m] == FATHOM_LINE_ECHO_ON ? FATHOM_ERR_NO_ANSWER : FATHOM_ERR_ECHO);
            assert_int_equal(counter(FATHOM_LINE_ANSWERS), 0);
        }
}

TEST(without_echo_the_same_bytes_are_the_answer)
{
    for (size_t i = 0; i != COUNT_OF(prefixes); i++) {
        set_up_with(state, FATHOM_LINE_ECHO_OFF);
        ask_address(&prefixes[i], 100);
        come(BY_BYTE, 8 * BYTE_US, prefixes[i].request, 7);
        run(80000);
        assert_int_equal(status_of(&bench.request), FATHOM_READY);
        assert_int_equal(bench.value, 0);
    }
}
