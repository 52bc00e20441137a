/* SPDX-License-Identifier: MIT */
#include "echo_bench.h"

/* Local echo with 55 AA reads, whose response may begin like the request; with retries, late responses, broadcasts
 * and a listener. */

/* SUM is the low byte of the sum of all before it; 55 + AA = FF. */
typedef struct {
    uint8_t count;
    uint16_t values[4];
    uint8_t request[5];
    uint8_t length;
    uint8_t response[13];
} probe_t;

static const probe_t probes[] = {
    /* A05 2(3)3 with the sum put right, and 2(3)4. */
    {4,
     {1000, 2000, 1953, 3562},
     {0x55, 0xAA, 0x01, 0x01, 0x01},
     13,
     {0x55, 0xAA, 0x01, 0x01, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x62}},
    {1, {1953}, {0x55, 0xAA, 0x01, 0x10, 0x10}, 7, {0x55, 0xAA, 0x01, 0x10, 0x07, 0xA1, 0xB8}},
    /* 1H = 01 and H = 10: the first five bytes are the request. 500 mm: 62 - 03 - E8 + 01 + F4 = 6C. 4106 mm: FF + 01 +
     * 10 + 10 + 0A = 12A. */
    {4,
     {500, 2000, 1953, 3562},
     {0x55, 0xAA, 0x01, 0x01, 0x01},
     13,
     {0x55, 0xAA, 0x01, 0x01, 0x01, 0xF4, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x6C}},
    {1, {4106}, {0x55, 0xAA, 0x01, 0x10, 0x10}, 7, {0x55, 0xAA, 0x01, 0x10, 0x10, 0x0A, 0x2A}},
    /* The same with 1L = 55, which begins no second frame: 6C - F4 + 55 = CD. */
    {4,
     {341, 2000, 1953, 3562},
     {0x55, 0xAA, 0x01, 0x01, 0x01},
     13,
     {0x55, 0xAA, 0x01, 0x01, 0x01, 0x55, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0xCD}},
    /* Echo and response glued: the 12 bytes 55 AA 01 01 01 55 AA 01 01 03 E8 07 have the sum FF + 03 + FF + 02 + 03 +
     * E8 + 07 = 2F5, and F5 is the 13th, so that they look like one response. 62 - D0 + F5 = 87. */
    {4,
     {1000, 2037, 1953, 3562},
     {0x55, 0xAA, 0x01, 0x01, 0x01},
     13,
     {0x55, 0xAA, 0x01, 0x01, 0x03, 0xE8, 0x07, 0xF5, 0x07, 0xA1, 0x0D, 0xEA, 0x87}},
};

static uint16_t values[4];

static void ask_probes(const probe_t *probe, uint8_t mode, uint32_t step_us)
{
    set_up_with(mode);
    ask_dyp(&bench.request, 1, probe->count, values);
    run_until_written(1, step_us);
    expect_bytes(0, probe->request, 5);
}

static void dyp_read(const way_t *way)
{
    for (size_t i = 0; i != COUNT_OF(probes); i++)
        for (unsigned echoes = 0; echoes != 2; echoes++) {
            ask_probes(&probes[i], way->mode, way->step_us);
            if (echoes != 0) come(way->seed, 0, probes[i].request, 5);
            come(way->seed, 5 * BYTE_US + way->pause_us, probes[i].response, probes[i].length);
            run_in_steps(80000, way->step_us);
            expect(FATHOM_OK);
            assert_memory_equal(values, probes[i].values, probes[i].count * sizeof *values);
            expect_learned(way->mode, echoes != 0 ? FATHOM_LINE_ECHO_ON : FATHOM_LINE_ECHO_OFF);
            expect_count(FATHOM_LINE_RESPONSES, 1);
        }
}

static const suite_t suite = {.set_up = set_up};

TEST(a_response_that_begins_like_its_request_is_told_from_the_echo) { in_every_way(dyp_read); }

TEST(the_echo_of_a_dyp_read_is_no_response)
{
    for (size_t i = 0; i != COUNT_OF(probes); i++)
        for (size_t s = 0; s != COUNT_OF(steps_us); s++) {
            ask_probes(&probes[i], FATHOM_LINE_ECHO_AUTO, steps_us[s]);
            come_all(0, probes[i].request);
            run_in_steps(2 * TIMEOUT_US, steps_us[s]);
            expect(FATHOM_ERR_NO_RESPONSE);
            assert_int_equal(values[0], 0xDEAD);
            expect_echo(FATHOM_LINE_ECHO_ON);
        }
}

/* ---- a read whose request begins with a whole response to it ---- */

/*
 * 53 03 02 00 00 01 88 are seven of the eight bytes that ask unit 83 for register 0200, the address of an A16 or A05,
 * and they say that it is 0. 0188, low byte first, is the CRC of 53 03 02 00 00. Unit 147 is the other one: 93 03 02
 * 00 00 01 99.
 */
typedef struct {
    uint8_t unit;
    uint8_t request[8];
    uint8_t response[7]; /* the register holds the address */
} prefix_t;

static const prefix_t prefixes[] = {
    {83, {0x53, 0x03, 0x02, 0x00, 0x00, 0x01, 0x88, 0x00}, {0x53, 0x03, 0x02, 0x00, 0x53, 0x41, 0xB5}},
    {147, {0x93, 0x03, 0x02, 0x00, 0x00, 0x01, 0x99, 0x00}, {0x93, 0x03, 0x02, 0x00, 0x93, 0x41, 0xF4}},
};

static void ask_address(const prefix_t *prefix, uint8_t mode, uint32_t step_us)
{
    set_up_with(mode);
    bench.value = 0xDEAD;
    fathom_modbus_read_holding_registers(&bench.request.message, prefix->unit, 0x0200, 1, &bench.value);
    submit(&bench.request);
    run_until_written(1, step_us);
    expect_bytes(0, prefix->request, 8);
}

static void echoed_prefix(const way_t *way)
{
    if (way->mode == FATHOM_LINE_ECHO_OFF) return; /* told that there is none, while there is */
    for (size_t i = 0; i != COUNT_OF(prefixes); i++) {
        ask_address(&prefixes[i], way->mode, way->step_us);
        come(way->seed, 0, prefixes[i].request, 8);
        come(way->seed, 8 * BYTE_US + way->pause_us, prefixes[i].response, 7);
        run_in_steps(80000, way->step_us);
        expect_mm(prefixes[i].unit);
        expect_count(FATHOM_LINE_RESPONSES, 1);
    }
}

TEST(an_echo_that_begins_with_a_whole_response_is_no_response) { in_every_way(echoed_prefix); }

TEST(an_echo_that_begins_with_a_whole_response_and_nothing_else_is_a_failure)
{
    for (size_t i = 0; i != COUNT_OF(prefixes); i++)
        for (size_t m = 0; m != COUNT_OF(modes); m++) {
            if (modes[m] == FATHOM_LINE_ECHO_OFF) continue;
            ask_address(&prefixes[i], modes[m], 100);
            come_all(0, prefixes[i].request);
            expect_after(2 * TIMEOUT_US,
                         modes[m] == FATHOM_LINE_ECHO_ON ? FATHOM_ERR_NO_RESPONSE : FATHOM_ERR_ECHO);
            expect_count(FATHOM_LINE_RESPONSES, 0);
        }
}

/* What stands behind the part that has come is no part of it. */
TEST(an_echo_that_comes_in_parts_behind_noise_is_an_echo)
{
    static const uint8_t noise_and_part[] = {0xFF, 0x01, 0x03, 0x01, 0x00, 0x00};
    set_up_echo(FATHOM_LINE_ECHO_AUTO);
    ask_1_and_send(0);
    deliver_all(noise_and_part);
    deliver(ask_1_processed + 5, 3);
    assert_int_equal(fathom_line_get_echo(&bench.line), FATHOM_LINE_ECHO_ON);
    deliver_all(response_1_754);
    expect_mm(754);
    expect_count(FATHOM_LINE_DROPPED_BYTES, 1);
}

TEST(without_echo_the_same_bytes_are_the_response)
{
    for (size_t i = 0; i != COUNT_OF(prefixes); i++) {
        ask_address(&prefixes[i], FATHOM_LINE_ECHO_OFF, 100);
        come(BY_BYTE, 8 * BYTE_US, prefixes[i].request, 7);
        run(80000);
        expect_mm(0);
    }
}

/* ---- attempts ---- */

TEST(a_retry_on_an_echoing_line_takes_the_response_behind_its_own_echo)
{
    set_up_with(FATHOM_LINE_ECHO_AUTO);
    send_1(1, 100);
    come_all(0, ask_1_processed);
    run_until_written(2, 100);
    expect_count(FATHOM_LINE_NO_RESPONSES, 1);
    come_all(0, ask_1_processed);
    come_all(20000, response_1_754);
    run(40000);
    expect_mm(754);
}

TEST(a_late_response_on_an_echoing_line_is_no_other_requests)
{
    set_up_with(FATHOM_LINE_ECHO_AUTO);
    send_1(0, 100);
    come_all(0, ask_1_processed);
    expect_after(TIMEOUT_US + 10000, FATHOM_ERR_NO_RESPONSE);
    ask_other(1);
    receive_all(response_1_754);
    run_until_written(2, 100);
    expect_count(FATHOM_LINE_LATE_RESPONSES, 1);
    assert_int_equal(bench.other_value, 0xDEAD);
    come_all(0, ask_1_processed);
    come_all(9 * BYTE_US, response_1_751);
    run(30000);
    assert_int_equal(bench.other_value, 751);
}

/* ---- to all ---- */

TEST(a_broadcast_on_an_echoing_line_is_over_when_its_time_is)
{
    static const uint8_t tell_all[] = {0x00, 0x06, 0x02, 0x00, 0x00, 0x05, 0x49, 0xA0};
    for (size_t m = 0; m != COUNT_OF(modes); m++) {
        set_up_with(modes[m]);
        ask_to_write(&bench.request, 0);
        ask_other(1);
        run_until_written(1, 100);
        expect_bytes(0, tell_all, sizeof tell_all);
        come_all(0, tell_all);
        expect_after(TIMEOUT_US + 8 * BYTE_US - 1000, FATHOM_PENDING);
        expect_after(2000, FATHOM_OK);
        expect_echo(modes[m]);
        run_until_written(2, 100);
        come_all(0, ask_1_processed);
        come_all(20000, response_1_754);
        run(40000);
        assert_int_equal(bench.other_value, 754);
    }
}

/* ---- a listener ---- */

TEST(a_listener_does_not_hear_the_echo_of_a_read)
{
    for (unsigned seed = BY_BYTE; seed != SEEDS; seed++) {
        set_up_with(FATHOM_LINE_ECHO_AUTO);
        listen_for(GAP_US);
        send_1(0, 100);
        come(seed, 0, ask_1_processed, sizeof ask_1_processed);
        come(seed, 9 * BYTE_US, auto_frame, sizeof auto_frame);
        come(seed, 14 * BYTE_US, response_1_754, sizeof response_1_754);
        come(seed, 40000, auto_frame, sizeof auto_frame);
        run(80000);
        expect_mm(754);
        expect_heard(auto_frame, 4, auto_frame, 4);
        expect_echo(FATHOM_LINE_ECHO_ON);
    }
}
