/* SPDX-License-Identifier: MIT */
#include "echo_bench.h"

/* Local echo on a read, whose answer cannot equal its request: found out, told, forgotten. */

/* Asks unit 1; the request is on its way from now on. */
static void ask_1(uint8_t retries, uint32_t step_us)
{
    const size_t before = bench.fake.written;
    ask(&bench.request, 1, &bench.value, retries);
    run_until_written(before + 1, step_us);
}

/* The echo comes while the request leaves, and this behind it. */
static void echo_and(unsigned seed, uint32_t pause_us, const uint8_t *bytes, size_t length)
{
    come(seed, 0, ask_1_processed, sizeof ask_1_processed);
    if (length != 0) come(seed, 8 * BYTE_US + pause_us, bytes, length);
}

static void assert_answered(uint16_t value)
{
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_int_equal(bench.value, value);
}

/* ---- a read ---- */

static void echoed_read(void **state, uint8_t mode, unsigned seed, uint32_t pause_us, uint32_t step_us)
{
    set_up_with(state, mode);
    ask_1(0, step_us);
    echo_and(seed, pause_us, answer_1_754, sizeof answer_1_754);
    run_in_steps(80000, step_us);
    assert_answered(754);
    assert_int_equal(known_echo(), mode == FATHOM_LINE_ECHO_AUTO ? FATHOM_LINE_ECHO_ON : mode);
    assert_int_equal(counter(FATHOM_LINE_ANSWERS), 1);
    assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), 0);
    assert_int_equal(counter(FATHOM_LINE_STRAYS) + counter(FATHOM_LINE_MALFORMED), 0);
}

static const suite_t suite = {.set_up = set_up};

TEST(a_read_on_an_echoing_line_is_answered_and_shows_the_echo) { in_every_way(state, echoed_read); }

static void clean_read(void **state, uint8_t mode, unsigned seed, uint32_t pause_us, uint32_t step_us)
{
    set_up_with(state, mode);
    ask_1(0, step_us);
    come(seed, 8 * BYTE_US + pause_us, answer_1_754, sizeof answer_1_754);
    run_in_steps(80000, step_us);
    assert_answered(754);
    assert_int_equal(known_echo(), mode == FATHOM_LINE_ECHO_AUTO ? FATHOM_LINE_ECHO_OFF : mode);
}

TEST(a_read_without_echo_shows_that_there_is_none)
{
    assert_int_equal(known_echo(), FATHOM_LINE_ECHO_OFF); /* the bench says so */
    in_every_way(state, clean_read);
}

static void echoed_late_sent(void **state, uint8_t mode, unsigned seed, uint32_t pause_us, uint32_t step_us)
{
    set_up_with(state, mode);
    bench.fake.never_sent = true;
    ask_1(0, step_us);
    echo_and(seed, pause_us, answer_1_754, sizeof answer_1_754);
    run_in_steps(80000, step_us);
    assert_answered(754);
    assert_int_equal(known_echo(), mode == FATHOM_LINE_ECHO_AUTO ? FATHOM_LINE_ECHO_ON : mode);
}

/* hal.h: sent may turn true late; what was read before still counts. */
TEST(echo_and_answer_count_before_the_port_says_that_the_request_has_left)
{
    in_every_way(state, echoed_late_sent);
}

TEST(nothing_is_known_before_the_first_answer)
{
    set_up_with(state, FATHOM_LINE_ECHO_AUTO);
    assert_int_equal(known_echo(), FATHOM_LINE_ECHO_AUTO);
    ask_1(0, 100);
    run(3 * TIMEOUT_US);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(known_echo(), FATHOM_LINE_ECHO_AUTO);
}

TEST(an_echo_without_an_answer_is_no_answer_and_shows_the_echo)
{
    for (size_t m = 0; m != COUNT_OF(modes); m++) {
        set_up_with(state, modes[m]);
        ask_1(0, 100);
        echo_and(BY_BYTE, 0, NULL, 0);
        run(TIMEOUT_US);
        assert_int_equal(status_of(&bench.request), FATHOM_PENDING); /* the echo is no answer */
        run(9 * BYTE_US);
        assert_int_equal(status_of(&bench.request), FATHOM_ERR_NO_ANSWER);
        assert_int_equal(bench.value, 0xDEAD);
        assert_int_equal(counter(FATHOM_LINE_NO_ANSWERS), 1);
        assert_int_equal(known_echo(), modes[m] == FATHOM_LINE_ECHO_AUTO ? FATHOM_LINE_ECHO_ON : modes[m]);
    }
}

TEST(an_exception_behind_an_echo_ends_the_exchange_and_keeps_its_number)
{
    for (size_t p = 0; p != COUNT_OF(pauses_us); p++) {
        set_up_with(state, FATHOM_LINE_ECHO_AUTO);
        ask_1(3, 100);
        echo_and(BY_BYTE, pauses_us[p], exception_1_2, sizeof exception_1_2);
        run(60000);
        assert_int_equal(status_of(&bench.request), FATHOM_ERR_EXCEPTION);
        assert_int_equal(bench.request.message.exception, 2);
        assert_int_equal(known_echo(), FATHOM_LINE_ECHO_ON);
        assert_int_equal(bench.fake.written, 1);
    }
}

/* Register 0200: 01 03 02 begins an answer of 7 bytes; register 1400: one of 25. */
TEST(an_echo_that_begins_like_an_answer_is_an_echo)
{
    static const uint8_t echoes[][8] = {{0x01, 0x03, 0x02, 0x00, 0x00, 0x01, 0x85, 0xB2},
                                        {0x01, 0x03, 0x14, 0x00, 0x00, 0x01, 0x81, 0xFA}};
    static const uint16_t registers[] = {0x0200, 0x1400};
    for (size_t i = 0; i != COUNT_OF(echoes); i++)
        for (size_t p = 0; p != COUNT_OF(pauses_us); p++) {
            set_up_with(state, FATHOM_LINE_ECHO_AUTO);
            fathom_modbus_read_holding_registers(&bench.request.message, 1, registers[i], 1, &bench.value);
            bench.request.exchange.timeout_us = TIMEOUT_US;
            assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_PENDING);
            run_until_written(1, 100);
            assert_memory_equal(bench.fake.writes[0].bytes, echoes[i], 8);
            come(BY_BYTE, 0, echoes[i], 8);
            come(BY_BYTE, 8 * BYTE_US + pauses_us[p], answer_1_754, sizeof answer_1_754);
            run(60000);
            assert_answered(754);
            assert_int_equal(known_echo(), FATHOM_LINE_ECHO_ON);
        }
}

/* ---- what teaches nothing ---- */

TEST(a_damaged_echo_never_shows_that_there_is_none)
{
    uint8_t echo[sizeof ask_1_processed];
    for (unsigned bit = 0; bit != 8 * sizeof echo; bit++)
        for (size_t p = 0; p != COUNT_OF(pauses_us); p++) {
            set_up_with(state, FATHOM_LINE_ECHO_AUTO);
            memcpy(echo, ask_1_processed, sizeof echo);
            echo[bit / 8] ^= (uint8_t)(1u << bit % 8);
            ask_1(0, 100);
            come(BY_BYTE, 0, echo, sizeof echo);
            come(BY_BYTE, 8 * BYTE_US + pauses_us[p], answer_1_754, sizeof answer_1_754);
            run(60000);
            assert_true(status_of(&bench.request) == FATHOM_READY ||
                        status_of(&bench.request) == FATHOM_ERR_CHECKSUM);
            assert_int_equal(bench.value, status_of(&bench.request) == FATHOM_READY ? 754 : 0xDEAD);
            assert_int_equal(known_echo(), FATHOM_LINE_ECHO_AUTO);
        }
}

TEST(an_echo_that_lost_bytes_never_shows_that_there_is_none)
{
    for (size_t lost = 1; lost != sizeof ask_1_processed; lost++)
        for (size_t from = 0; from <= lost; from += lost) { /* the last ones, or the first */
            set_up_with(state, FATHOM_LINE_ECHO_AUTO);
            ask_1(0, 100);
            come(BY_BYTE, 0, ask_1_processed + from, sizeof ask_1_processed - lost);
            come(BY_BYTE, 9 * BYTE_US, answer_1_754, sizeof answer_1_754);
            run(60000);
            assert_answered(754);
            assert_int_equal(known_echo(), FATHOM_LINE_ECHO_AUTO);
        }
}

/* What came before the answer may have been a rest of the echo. */
TEST(an_answer_that_anything_precedes_shows_nothing)
{
    static const fathom_rx_t marks[] = {
        {0, FATHOM_RX_PARITY}, {0, FATHOM_RX_FRAMING}, {0, FATHOM_RX_OVERRUN}};
    for (unsigned noise = 0; noise != 256; noise++) {
        const uint8_t byte = (uint8_t)noise;
        set_up_with(state, FATHOM_LINE_ECHO_AUTO);
        ask_1(0, 100);
        come(BY_BYTE, 8 * BYTE_US, &byte, 1);
        come(BY_BYTE, 20000, answer_1_754, sizeof answer_1_754);
        run(60000);
        assert_answered(754);
        assert_int_equal(known_echo(), FATHOM_LINE_ECHO_AUTO);
    }
    for (size_t i = 0; i != COUNT_OF(marks); i++) {
        set_up_with(state, FATHOM_LINE_ECHO_AUTO);
        ask_1(0, 100);
        fake_receive_rx(&bench.fake, 4000, answer_1_754, 1, marks[i]);
        come(BY_BYTE, 20000, answer_1_754, sizeof answer_1_754);
        run(60000);
        assert_answered(754);
        assert_int_equal(known_echo(), FATHOM_LINE_ECHO_AUTO);
    }
}

TEST(another_units_answer_shows_nothing)
{
    set_up_with(state, FATHOM_LINE_ECHO_AUTO);
    ask_1(0, 100);
    run(10000);
    receive_answer(2, 222);
    run(TIMEOUT_US);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(known_echo(), FATHOM_LINE_ECHO_AUTO);
}

/* ---- what is known changes ---- */

static void read_once(bool echoes)
{
    ask_1(0, 100);
    if (echoes) come(BY_BYTE, 0, ask_1_processed, sizeof ask_1_processed);
    come(BY_BYTE, 20000, answer_1_754, sizeof answer_1_754);
    run(60000);
    assert_answered(754);
}

TEST(what_was_found_out_follows_the_newest_evidence)
{
    static const bool echoes[] = {true, false, false, true, true, false};
    set_up_with(state, FATHOM_LINE_ECHO_AUTO);
    for (size_t i = 0; i != COUNT_OF(echoes); i++) {
        read_once(echoes[i]);
        assert_int_equal(known_echo(), echoes[i] ? FATHOM_LINE_ECHO_ON : FATHOM_LINE_ECHO_OFF);
    }
}

TEST(a_broken_port_forgets_what_was_found_out_and_keeps_what_was_told)
{
    for (size_t m = 0; m != COUNT_OF(modes); m++)
        for (unsigned echoes = 0; echoes != 2; echoes++) {
            set_up_with(state, modes[m]);
            read_once(echoes != 0);
            bench.fake.read_fails = true;
            assert_int_equal(fathom_line_poll(&bench.line), FATHOM_ERR_PORT);
            bench.fake.read_fails = false;
            assert_int_equal(known_echo(), modes[m]);
        }
}
