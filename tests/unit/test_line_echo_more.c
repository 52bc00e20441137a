/* SPDX-License-Identifier: MIT */
#include "echo_bench.h"
#include "fathom/dyp_client.h"

/* Local echo with 55 AA reads, whose answer may begin like the request; with retries, late answers, broadcasts
 * and a listener. */

/* SUM is the low byte of the sum of all before it; 55 + AA = FF. */
typedef struct {
    uint8_t count;
    const uint8_t *request;
    const uint8_t *answer;
    uint8_t length;
    uint16_t values[4];
} probe_t;

static const uint8_t ask_all[] = {0x55, 0xAA, 0x01, 0x01, 0x01};
static const uint8_t ask_first[] = {0x55, 0xAA, 0x01, 0x10, 0x10};

/* A05 2(3)3 with the sum put right, and 2(3)4. */
static const uint8_t all_1000[] = {0x55, 0xAA, 0x01, 0x01, 0x03, 0xE8, 0x07,
                                   0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x62};
static const uint8_t first_1953[] = {0x55, 0xAA, 0x01, 0x10, 0x07, 0xA1, 0xB8};

/* 1H = 01 and H = 10: the first five bytes are the request. 500 mm: 62 - 03 - E8 + 01 + F4 = 6C. 4106 mm: FF + 01 +
 * 10 + 10 + 0A = 12A. */
static const uint8_t all_500[] = {0x55, 0xAA, 0x01, 0x01, 0x01, 0xF4, 0x07,
                                  0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x6C};
static const uint8_t first_4106[] = {0x55, 0xAA, 0x01, 0x10, 0x10, 0x0A, 0x2A};

/* The same with 1L = 55, which begins no second frame: 6C - F4 + 55 = CD. */
static const uint8_t all_341[] = {0x55, 0xAA, 0x01, 0x01, 0x01, 0x55, 0x07,
                                  0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0xCD};

/* Echo and answer glued: the 12 bytes 55 AA 01 01 01 55 AA 01 01 03 E8 07 have the sum FF + 03 + FF + 02 + 03 + E8
 * + 07 = 2F5, and F5 is the 13th, so that they look like one answer. 62 - D0 + F5 = 87. */
static const uint8_t all_2037[] = {0x55, 0xAA, 0x01, 0x01, 0x03, 0xE8, 0x07,
                                   0xF5, 0x07, 0xA1, 0x0D, 0xEA, 0x87};

static const probe_t probes[] = {
    {4, ask_all, all_1000, sizeof all_1000, {1000, 2000, 1953, 3562}},
    {4, ask_all, all_500, sizeof all_500, {500, 2000, 1953, 3562}},
    {4, ask_all, all_341, sizeof all_341, {341, 2000, 1953, 3562}},
    {4, ask_all, all_2037, sizeof all_2037, {1000, 2037, 1953, 3562}},
    {1, ask_first, first_1953, sizeof first_1953, {1953}},
    {1, ask_first, first_4106, sizeof first_4106, {4106}},
};

static uint16_t values[4];

static void ask_probes(const probe_t *probe, uint8_t retries, uint32_t step_us)
{
    const size_t before = bench.fake.written;
    memset(values, 0xA5, sizeof values);
    fathom_modbus_read_holding_registers(&bench.request.message, 1, 0x0106, probe->count, values);
    bench.request.exchange.timeout_us = TIMEOUT_US;
    bench.request.exchange.retries = retries;
    assert_int_equal(fathom_dyp_client_submit(&bench.line, &bench.request), FATHOM_PENDING);
    run_until_written(before + 1, step_us);
    assert_int_equal(bench.fake.writes[before].length, 5);
    assert_memory_equal(bench.fake.writes[before].bytes, probe->request, 5);
}

static void dyp_read(void **state, uint8_t mode, unsigned seed, uint32_t pause_us, uint32_t step_us)
{
    for (size_t i = 0; i != COUNT_OF(probes); i++)
        for (unsigned echoes = 0; echoes != 2; echoes++) {
            const uint8_t learned = echoes != 0 ? FATHOM_LINE_ECHO_ON : FATHOM_LINE_ECHO_OFF;
            set_up_with(state, mode);
            ask_probes(&probes[i], 0, step_us);
            if (echoes != 0) come(seed, 0, probes[i].request, 5);
            come(seed, 5 * BYTE_US + pause_us, probes[i].answer, probes[i].length);
            run_in_steps(80000, step_us);
            assert_int_equal(status_of(&bench.request), FATHOM_READY);
            assert_memory_equal(values, probes[i].values, probes[i].count * sizeof *values);
            assert_int_equal(known_echo(), mode == FATHOM_LINE_ECHO_AUTO ? learned : mode);
            assert_int_equal(counter(FATHOM_LINE_ANSWERS), 1);
        }
}

static const suite_t suite = {.set_up = set_up};

TEST(an_answer_that_begins_like_its_request_is_told_from_the_echo) { in_every_way(state, dyp_read); }

TEST(the_echo_of_a_dyp_read_is_no_answer)
{
    for (size_t i = 0; i != COUNT_OF(probes); i++)
        for (size_t s = 0; s != COUNT_OF(steps_us); s++) {
            set_up_with(state, FATHOM_LINE_ECHO_AUTO);
            ask_probes(&probes[i], 0, steps_us[s]);
            come(BY_BYTE, 0, probes[i].request, 5);
            run_in_steps(2 * TIMEOUT_US, steps_us[s]);
            assert_int_equal(status_of(&bench.request), FATHOM_ERR_NO_ANSWER);
            assert_int_equal(values[0], 0xA5A5);
            assert_int_equal(known_echo(), FATHOM_LINE_ECHO_ON);
        }
}

/* ---- attempts ---- */

TEST(a_retry_on_an_echoing_line_takes_the_answer_behind_its_own_echo)
{
    set_up_with(state, FATHOM_LINE_ECHO_AUTO);
    ask(&bench.request, 1, &bench.value, 1);
    run_until_written(1, 100);
    come(BY_BYTE, 0, ask_1_processed, sizeof ask_1_processed);
    run_until_written(2, 100);
    assert_int_equal(counter(FATHOM_LINE_NO_ANSWERS), 1);
    come(BY_BYTE, 0, ask_1_processed, sizeof ask_1_processed);
    come(BY_BYTE, 20000, answer_1_754, sizeof answer_1_754);
    run(40000);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_int_equal(bench.value, 754);
}

TEST(a_late_answer_on_an_echoing_line_is_no_other_requests)
{
    set_up_with(state, FATHOM_LINE_ECHO_AUTO);
    ask(&bench.request, 1, &bench.value, 0);
    run_until_written(1, 100);
    come(BY_BYTE, 0, ask_1_processed, sizeof ask_1_processed);
    run(TIMEOUT_US + 10000);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_NO_ANSWER);
    ask(&bench.other, 1, &bench.other_value, 0);
    receive(answer_1_754, sizeof answer_1_754);
    run_until_written(2, 100);
    assert_int_equal(counter(FATHOM_LINE_LATE_ANSWERS), 1);
    assert_int_equal(bench.other_value, 0xDEAD);
    come(BY_BYTE, 0, ask_1_processed, sizeof ask_1_processed);
    come(BY_BYTE, 9 * BYTE_US, answer_1_751, sizeof answer_1_751);
    run(30000);
    assert_int_equal(bench.other_value, 751);
}

/* ---- to all ---- */

/* Unit 0, register 0200, 5. */
static const uint8_t tell_all[] = {0x00, 0x06, 0x02, 0x00, 0x00, 0x05, 0x49, 0xA0};

TEST(a_broadcast_on_an_echoing_line_is_over_when_its_time_is)
{
    for (size_t m = 0; m != COUNT_OF(modes); m++) {
        set_up_with(state, modes[m]);
        fathom_modbus_write_single_register(&bench.request.message, 0, 0x0200, 5);
        bench.request.exchange.timeout_us = TIMEOUT_US;
        assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_PENDING);
        ask(&bench.other, 1, &bench.other_value, 0);
        run_until_written(1, 100);
        assert_memory_equal(bench.fake.writes[0].bytes, tell_all, sizeof tell_all);
        come(BY_BYTE, 0, tell_all, sizeof tell_all);
        run(TIMEOUT_US + 8 * BYTE_US - 1000);
        assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
        run(2000);
        assert_int_equal(status_of(&bench.request), FATHOM_READY);
        assert_int_equal(known_echo(), modes[m]);
        run_until_written(2, 100);
        come(BY_BYTE, 0, ask_1_processed, sizeof ask_1_processed);
        come(BY_BYTE, 20000, answer_1_754, sizeof answer_1_754);
        run(40000);
        assert_int_equal(bench.other_value, 754);
    }
}

/* ---- a listener ---- */

typedef struct {
    fathom_listener_t listener;
    uint8_t bytes[64];
    size_t length;
} ear_t;

static void hear(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                 uint32_t time_us)
{
    ear_t *const ear = (ear_t *)listener;
    (void)after_gap;
    (void)time_us;
    assert_true(ear->length + count <= sizeof ear->bytes);
    memcpy(ear->bytes + ear->length, bytes, count);
    ear->length += count;
}

static const uint8_t auto_frame[] = {0xFF, 0x07, 0xA1, 0xA7}; /* A16 2(4) */

TEST(a_listener_does_not_hear_the_echo_of_a_read)
{
    for (unsigned seed = BY_BYTE; seed != SEEDS; seed++) {
        ear_t ear = {.listener = {hear, GAP_US}};
        set_up_with(state, FATHOM_LINE_ECHO_AUTO);
        fathom_line_listen(&bench.line, &ear.listener);
        ask(&bench.request, 1, &bench.value, 0);
        run_until_written(1, 100);
        come(seed, 0, ask_1_processed, sizeof ask_1_processed);
        come(seed, 9 * BYTE_US, auto_frame, sizeof auto_frame);
        come(seed, 14 * BYTE_US, answer_1_754, sizeof answer_1_754);
        come(seed, 40000, auto_frame, sizeof auto_frame);
        run(80000);
        assert_int_equal(status_of(&bench.request), FATHOM_READY);
        assert_int_equal(bench.value, 754);
        assert_int_equal(ear.length, 8);
        assert_memory_equal(ear.bytes, auto_frame, 4);
        assert_memory_equal(ear.bytes + 4, auto_frame, 4);
        assert_int_equal(known_echo(), FATHOM_LINE_ECHO_ON);
    }
}
