/* SPDX-License-Identifier: MIT */
#include "echo_bench.h"

/* Local echo on a read, whose response cannot equal its request: found out, told, forgotten. */

/* The echo comes while the request leaves, and the response behind it. */
static void echo_and_response(const way_t *way)
{
    come(way->seed, 0, ask_1_processed, sizeof ask_1_processed);
    come(way->seed, 8 * BYTE_US + way->pause_us, response_1_754, sizeof response_1_754);
    run_in_steps(80000, way->step_us);
    expect_mm(754);
    expect_learned(way->mode, FATHOM_LINE_ECHO_ON);
}

/* ---- a read ---- */

static const suite_t suite = {.set_up = set_up};

static void echoed_read(const way_t *way)
{
    set_up_with(way->mode);
    send_1(0, way->step_us);
    echo_and_response(way);
    expect_count(FATHOM_LINE_RESPONSES, 1);
    expect_count(FATHOM_LINE_DROPPED_BYTES, 0);
    assert_int_equal(counter(FATHOM_LINE_STRAYS) + counter(FATHOM_LINE_MALFORMED), 0);
}

TEST(a_read_on_an_echoing_line_is_answered_and_shows_the_echo) { in_every_way(echoed_read); }

static void clean_read(const way_t *way)
{
    set_up_with(way->mode);
    send_1(0, way->step_us);
    come(way->seed, 8 * BYTE_US + way->pause_us, response_1_754, sizeof response_1_754);
    run_in_steps(80000, way->step_us);
    expect_mm(754);
    expect_learned(way->mode, FATHOM_LINE_ECHO_OFF);
}

TEST(a_read_without_echo_shows_that_there_is_none)
{
    expect_echo(FATHOM_LINE_ECHO_OFF); /* the bench says so */
    in_every_way(clean_read);
}

static void echoed_late_sent(const way_t *way)
{
    set_up_with(way->mode);
    bench.fake.never_sent = true;
    send_1(0, way->step_us);
    echo_and_response(way);
}

/* hal.h: sent may turn true late; what was read before still counts. */
TEST(echo_and_response_count_before_the_port_says_that_the_request_has_left)
{
    in_every_way(echoed_late_sent);
}

TEST(nothing_is_known_before_the_first_response)
{
    set_up_with(FATHOM_LINE_ECHO_AUTO);
    expect_echo(FATHOM_LINE_ECHO_AUTO);
    send_1(0, 100);
    expect_after(3 * TIMEOUT_US, FATHOM_ERR_NO_RESPONSE);
    expect_echo(FATHOM_LINE_ECHO_AUTO);
}

TEST(an_echo_without_a_response_is_no_response_and_shows_the_echo)
{
    for (size_t m = 0; m != COUNT_OF(modes); m++) {
        set_up_with(modes[m]);
        send_1(0, 100);
        come_all(0, ask_1_processed);
        run(8 * BYTE_US + 100);
        expect_learned(modes[m], FATHOM_LINE_ECHO_ON);
        expect_after(TIMEOUT_US - 8 * BYTE_US, FATHOM_PENDING); /* the echo is no response */
        run(9 * BYTE_US);
        expect_failed(FATHOM_ERR_NO_RESPONSE);
        expect_count(FATHOM_LINE_NO_RESPONSES, 1);
        expect_learned(modes[m], FATHOM_LINE_ECHO_ON);
    }
}

TEST(an_exception_behind_an_echo_ends_the_transaction_and_keeps_its_number)
{
    for (size_t p = 0; p != COUNT_OF(pauses_us); p++) {
        set_up_with(FATHOM_LINE_ECHO_AUTO);
        send_1(3, 100);
        come_all(0, ask_1_processed);
        come_all(8 * BYTE_US + pauses_us[p], exception_1_2);
        expect_after(60000, FATHOM_ERR_EXCEPTION);
        assert_int_equal(bench.request.message.exception, 2);
        expect_echo(FATHOM_LINE_ECHO_ON);
        expect_written(1);
    }
}

/* Register 0200: 01 03 02 begins a response of 7 bytes; register 1400: one of 25. */
TEST(an_echo_that_begins_like_a_response_is_an_echo)
{
    static const uint8_t echoes[][8] = {{0x01, 0x03, 0x02, 0x00, 0x00, 0x01, 0x85, 0xB2},
                                        {0x01, 0x03, 0x14, 0x00, 0x00, 0x01, 0x81, 0xFA}};
    static const uint16_t registers[] = {0x0200, 0x1400};
    for (size_t i = 0; i != COUNT_OF(echoes); i++)
        for (size_t p = 0; p != COUNT_OF(pauses_us); p++) {
            set_up_with(FATHOM_LINE_ECHO_AUTO);
            fathom_modbus_read_holding_registers(&bench.request.message, 1, registers[i], 1, &bench.value);
            submit(&bench.request);
            run_until_written(1, 100);
            expect_bytes(0, echoes[i], 8);
            come_all(0, echoes[i]);
            come_all(8 * BYTE_US + pauses_us[p], response_1_754);
            run(60000);
            expect_mm(754);
            expect_echo(FATHOM_LINE_ECHO_ON);
        }
}

/* line.h: the echo of a request to all units is of no unit, and goes where such bytes go. */
TEST(the_echo_of_a_request_to_all_units_shows_nothing)
{
    static const uint8_t write_0[8] = {0x00, 0x06, 0x02, 0x00, 0x00, 0x05, 0x49, 0xA0};
    set_up_with(FATHOM_LINE_ECHO_AUTO);
    ask_to_write(&bench.request, 0);
    run_until_written(1, 100);
    expect_bytes(0, write_0, 8);
    come_all(0, write_0);
    run(20000);
    expect_echo(FATHOM_LINE_ECHO_AUTO);
    expect_count(FATHOM_LINE_DROPPED_BYTES, 8);
}

/* An unsolicited frame with a right CRC, of the unit or of another, came before the response. */
TEST(a_response_behind_an_unasked_frame_shows_that_there_is_no_echo)
{
    static const uint8_t of_1[] = {0x01, 0x03, 0x04, 0x02, 0xF2, 0x02, 0xF2, 0xDA, 0x9D};
    static const uint8_t of_2[] = {0x02, 0x03, 0x02, 0x02, 0xF2, 0x7C, 0xA1};
    for (unsigned i = 0; i != 2; i++) {
        set_up_with(FATHOM_LINE_ECHO_AUTO);
        send_1(0, 100);
        run(8 * BYTE_US);
        if (i == 0)
            come_all(0, of_1);
        else
            come_all(0, of_2);
        come_all(20 * BYTE_US, response_1_754);
        run(60000);
        expect_mm(754);
        expect_echo(FATHOM_LINE_ECHO_OFF);
    }
}

/* 125 registers, each 256 i + 255 - i; the CRC was worked out apart, bit by bit. */
TEST(the_longest_response_is_no_echo_and_shows_whether_there_is_one)
{
    static uint8_t frame[255], response[255] = {0x01, 0x03, 250, [253] = 0xEB, [254] = 0x7C};
    static uint16_t values[125];
    for (unsigned i = 0; i != 125; i++) {
        response[3 + 2 * i] = (uint8_t)i;
        response[4 + 2 * i] = (uint8_t)(255 - i);
    }
    for (unsigned echoes = 0; echoes != 2; echoes++) {
        set_up_with(FATHOM_LINE_ECHO_AUTO);
        bench.config.frame = frame;
        bench.config.frame_size = sizeof frame;
        memset(values, 0xA5, sizeof values);
        fathom_modbus_read_holding_registers(&bench.request.message, 1, 0x0020, 125, values);
        submit(&bench.request);
        run_until_written(1, 100);
        if (echoes != 0) receive(bench.fake.writes[0].bytes, bench.fake.writes[0].length);
        run(8 * BYTE_US);
        deliver(response, sizeof response); /* one read of the port may bring all of them */
        expect(FATHOM_OK);
        for (unsigned i = 0; i != 125; i++) assert_int_equal(values[i], 256 * i + 255 - i);
        expect_echo(echoes != 0 ? FATHOM_LINE_ECHO_ON : FATHOM_LINE_ECHO_OFF);
        expect_count(FATHOM_LINE_DROPPED_BYTES, 0);
        expect_count(FATHOM_LINE_BAD_BYTES, 0); /* no flag is made of the number of bytes */
    }
}

/* ---- what teaches nothing ---- */

TEST(a_damaged_echo_never_shows_that_there_is_none)
{
    uint8_t echo[sizeof ask_1_processed];
    for (unsigned bit = 0; bit != 8 * sizeof echo; bit++)
        for (size_t p = 0; p != COUNT_OF(pauses_us); p++) {
            set_up_with(FATHOM_LINE_ECHO_AUTO);
            memcpy(echo, ask_1_processed, sizeof echo);
            echo[bit / 8] ^= (uint8_t)(1u << bit % 8);
            send_1(0, 100);
            come_all(0, echo);
            come_all(8 * BYTE_US + pauses_us[p], response_1_754);
            run(60000);
            if (status_of(&bench.request) != FATHOM_OK) {
                expect_failed(FATHOM_ERR_CHECKSUM);
            } else {
                expect_mm(754);
            }
            expect_echo(FATHOM_LINE_ECHO_AUTO);
        }
}

TEST(an_echo_that_lost_bytes_never_shows_that_there_is_none)
{
    for (size_t lost = 1; lost != sizeof ask_1_processed; lost++)
        for (size_t from = 0; from <= lost; from += lost) { /* the last ones, or the first */
            set_up_with(FATHOM_LINE_ECHO_AUTO);
            send_1(0, 100);
            come(BY_BYTE, 0, ask_1_processed + from, sizeof ask_1_processed - lost);
            come_all(9 * BYTE_US, response_1_754);
            run(60000);
            expect_mm(754);
            expect_echo(FATHOM_LINE_ECHO_AUTO);
        }
}

/* What came before the response may have been a rest of the echo: any byte, or one that the port has marked. */
TEST(a_response_that_anything_precedes_shows_nothing)
{
    static const uint8_t flags[] = {FATHOM_RX_PARITY, FATHOM_RX_FRAMING, FATHOM_RX_OVERRUN};
    for (unsigned noise = 0; noise != 256 + sizeof flags; noise++) {
        const uint8_t byte = (uint8_t)noise;
        set_up_with(FATHOM_LINE_ECHO_AUTO);
        send_1(0, 100);
        if (noise < 256)
            come(BY_BYTE, 8 * BYTE_US, &byte, 1);
        else
            fake_receive_rx(&bench.fake, 4000, response_1_754, 1, (fathom_rx_t){0, flags[noise - 256]});
        come_all(20000, response_1_754);
        run(60000);
        expect_mm(754);
        expect_echo(FATHOM_LINE_ECHO_AUTO);
    }
}

TEST(another_units_response_shows_nothing)
{
    set_up_with(FATHOM_LINE_ECHO_AUTO);
    send_1(0, 100);
    run(10000);
    receive_response(2, 222);
    expect_after(TIMEOUT_US, FATHOM_ERR_NO_RESPONSE);
    expect_echo(FATHOM_LINE_ECHO_AUTO);
}

/* ---- what is known changes ---- */

TEST(what_was_found_out_follows_the_newest_evidence)
{
    static const bool echoes[] = {true, false, false, true, true, false};
    set_up_with(FATHOM_LINE_ECHO_AUTO);
    for (size_t i = 0; i != COUNT_OF(echoes); i++) {
        read_once(echoes[i]);
        expect_echo(echoes[i] ? FATHOM_LINE_ECHO_ON : FATHOM_LINE_ECHO_OFF);
    }
}

TEST(a_broken_port_forgets_what_was_found_out_and_keeps_what_was_told)
{
    for (size_t m = 0; m != COUNT_OF(modes); m++)
        for (unsigned echoes = 0; echoes != 2; echoes++) {
            set_up_with(modes[m]);
            read_once(echoes != 0);
            break_port();
            expect_echo(modes[m]);
        }
}
