/* SPDX-License-Identifier: MIT */
#include "line_conversation.h"

/* Local echo: found out, told, forgotten. Most tests run with all that an echo may be known as, and with bytes that come in
 * every way. */

enum { BY_BYTE = 0, SEEDS = 6 }; /* one by one, or in pieces that the seed cuts */

typedef struct {
    uint8_t mode; /* FATHOM_LINE_ECHO_... */
    unsigned seed;
    uint32_t pause_us; /* between the request and what follows it */
    uint32_t step_us;  /* of the loop */
} way_t;

static const uint8_t modes[3] = {FATHOM_LINE_ECHO_AUTO, FATHOM_LINE_ECHO_OFF, FATHOM_LINE_ECHO_ON};
static const uint32_t pauses_us[3] = {0, 2000, 20000};
static const uint32_t steps_us[3] = {100, 1000, 20000};

/* Calls the test with each of them. */
static void in_every_way(void (*test)(const way_t *way))
{
    for (size_t m = 0; m != COUNT_OF(modes); m++)
        for (unsigned seed = BY_BYTE; seed != SEEDS; seed++)
            for (size_t p = 0; p != COUNT_OF(pauses_us); p++)
                for (size_t s = 0; s != COUNT_OF(steps_us); s++)
                    test(&(way_t){modes[m], seed, pauses_us[p], steps_us[s]});
}

static void set_up_with(uint8_t echo)
{
    void *state;
    set_up(&state);
    set_up_echo(echo);
}

static void run_until_written(size_t written, uint32_t step_us)
{
    for (unsigned i = 0; bench.fake.written < written; i++) {
        assert_true(i < 10000);
        run_in_steps(step_us, step_us);
    }
}

/* Asks unit 1; the request is on its way from now on. */
static void send_1(uint8_t retries, uint32_t step_us)
{
    const size_t before = bench.fake.written;
    ask_1(retries);
    run_until_written(before + 1, step_us);
}

/* The bytes come at the speed of the line, the first one complete in_us + BYTE_US from now. */
static void come(unsigned seed, uint32_t in_us, const uint8_t *bytes, size_t length)
{
    uint32_t random = seed * 2654435761u;
    for (size_t at = 0; at != length;) {
        size_t piece = 1;
        if (seed != BY_BYTE) {
            random = random * 1664525u + 1013904223u;
            piece += (random >> 24) % 4; /* under GAP_US apart */
        }
        if (piece > length - at) piece = length - at;
        fake_receive(&bench.fake, in_us + (uint32_t)(at + piece) * BYTE_US, bytes + at, piece);
        at += piece;
    }
}

#define come_all(in_us, array) come(BY_BYTE, in_us, array, sizeof(array))

/* Unit 1 is asked, and responds 754, behind the echo if there is one. */
static void read_once(bool echoes)
{
    send_1(0, 100);
    if (echoes) come_all(0, ask_1_processed);
    come_all(20000, response_1_754);
    run(60000);
    expect_mm(754);
}

#define expect_echo(echo) assert_int_equal(fathom_line_get_echo(&bench.line), echo)

/* What the line knows of the echo now, or what was told. */
static void expect_learned(uint8_t mode, uint8_t echo)
{
    expect_echo(mode == FATHOM_LINE_ECHO_AUTO ? echo : mode);
}

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

/* ---- 55 AA reads, whose response may begin like the request ---- */

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

TEST(without_echo_the_same_bytes_are_the_response)
{
    for (size_t i = 0; i != COUNT_OF(prefixes); i++) {
        ask_address(&prefixes[i], FATHOM_LINE_ECHO_OFF, 100);
        come(BY_BYTE, 8 * BYTE_US, prefixes[i].request, 7);
        run(80000);
        expect_mm(0);
    }
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

/* ---- writes, whose response equals the request ---- */

static const uint8_t dyp_address_5[] = {0x55, 0xAA, 0x05, 0x03, 0x07}; /* A05 2(3)5 */

/* Two protocols, one rule. */
typedef struct {
    const uint8_t *bytes;
    size_t length;
    bool is_dyp;
} write_t;

static const write_t writes[] = {{set_address_5, sizeof set_address_5, false},
                                 {dyp_address_5, sizeof dyp_address_5, true}};
static const write_t *wanted;

/* A new line, and what is written on it. */
static void set_up_for(size_t which, uint8_t mode)
{
    wanted = &writes[which];
    set_up_with(mode);
}

/* The write is on its way from now on. */
static void start_write(uint8_t retries, uint32_t step_us)
{
    const size_t before = bench.fake.written;
    bench.request.transaction.timeout_us = TIMEOUT_US;
    bench.request.transaction.retries = retries;
    if (wanted->is_dyp)
        assert_int_equal(fathom_dyp_client_broadcast_address(&bench.line, &bench.request, 5), FATHOM_PENDING);
    else
        ask_to_write(&bench.request, 1);
    run_until_written(before + 1, step_us);
    expect_bytes(before, wanted->bytes, wanted->length);
}

static uint32_t leaves_us(void) { return (uint32_t)wanted->length * BYTE_US; }

static void copy_in(unsigned seed, uint32_t in_us) { come(seed, in_us, wanted->bytes, wanted->length); }

/* What one copy of the request means where nothing else comes. */
static fathom_status_t of_one_copy(uint8_t mode)
{
    if (mode == FATHOM_LINE_ECHO_OFF) return FATHOM_OK;
    return mode == FATHOM_LINE_ECHO_ON ? FATHOM_ERR_NO_RESPONSE : FATHOM_ERR_ECHO;
}

static void one_copy(const way_t *way)
{
    for (size_t w = 0; w != COUNT_OF(writes); w++)
        for (unsigned is_response = 0; is_response != 2; is_response++) { /* while it leaves, or after that */
            set_up_for(w, way->mode);
            start_write(0, way->step_us);
            copy_in(way->seed, is_response != 0 ? leaves_us() + way->pause_us : 0);
            run_in_steps(80000, way->step_us);
            if (way->mode == FATHOM_LINE_ECHO_OFF) {
                expect(FATHOM_OK);
                continue;
            }
            expect(FATHOM_PENDING);
            expect_count(FATHOM_LINE_RESPONSES, 0);
            run_in_steps(60000, way->step_us);
            expect(of_one_copy(way->mode));
            expect_count(way->mode == FATHOM_LINE_ECHO_ON ? FATHOM_LINE_NO_RESPONSES : FATHOM_LINE_ECHOES, 1);
            expect_count(FATHOM_LINE_RESPONSES, 0);
            expect_echo(way->mode); /* it proves nothing */
        }
}

TEST(one_copy_of_a_write_acknowledges_it_only_where_there_is_no_echo) { in_every_way(one_copy); }

static void two_copies(const way_t *way)
{
    for (size_t w = 0; w != COUNT_OF(writes); w++)
        for (unsigned is_late = 0; is_late != 2; is_late++) { /* what the port says of the request */
            set_up_for(w, way->mode);
            bench.fake.never_sent = is_late != 0;
            start_write(0, way->step_us);
            copy_in(way->seed, 0);
            copy_in(way->seed, leaves_us() + way->pause_us);
            run_in_steps(80000, way->step_us);
            expect(FATHOM_OK);
            expect_count(FATHOM_LINE_RESPONSES, 1);
            /* Without an echo the first copy is the response. The second belongs to no transaction: it is a stray,
             * unless a silence or a slow loop has cut it in two. */
            assert_in_range(counter(FATHOM_LINE_STRAYS), 0, way->mode == FATHOM_LINE_ECHO_OFF ? 1 : 0);
            expect_count(FATHOM_LINE_LATE_RESPONSES, 0);
        }
}

TEST(two_copies_of_a_write_acknowledge_it) { in_every_way(two_copies); }

TEST(a_write_that_nothing_answers_is_no_response_whatever_is_known)
{
    for (size_t w = 0; w != COUNT_OF(writes); w++)
        for (size_t m = 0; m != COUNT_OF(modes); m++) {
            set_up_for(w, modes[m]);
            start_write(0, 100);
            expect_after(2 * TIMEOUT_US, FATHOM_ERR_NO_RESPONSE);
        }
}

/* A copy with a wrong checksum is no copy: of the two that came one was hit. */
TEST(a_damaged_copy_does_not_count)
{
    uint8_t damaged[8];
    for (size_t w = 0; w != COUNT_OF(writes); w++)
        for (size_t m = 0; m != COUNT_OF(modes); m++)
            for (unsigned bit = 0; bit != 8 * writes[w].length; bit++) {
                set_up_for(w, modes[m]);
                memcpy(damaged, wanted->bytes, wanted->length);
                damaged[bit / 8] ^= (uint8_t)(1u << bit % 8);
                start_write(0, 100);
                come(BY_BYTE, 0, damaged, wanted->length);
                run(2 * TIMEOUT_US);
                assert_int_not_equal(status_of(&bench.request), FATHOM_OK);
                assert_int_not_equal(status_of(&bench.request), FATHOM_ERR_ECHO);
                expect_count(FATHOM_LINE_RESPONSES, 0);
                expect_echo(modes[m]);
            }
}

/* FATHOM_ERR_ECHO: "one copy of the request came, and the line does not know yet whether it echoes". Bytes that the
 * port marked before it, or with it, do not tell. */
TEST(one_copy_behind_marked_bytes_is_no_acknowledgement)
{
    static const uint8_t flags[] = {FATHOM_RX_PARITY, FATHOM_RX_FRAMING, FATHOM_RX_OVERRUN};
    for (size_t i = 0; i != COUNT_OF(flags); i++) {
        const bool is_overrun =
            flags[i] == FATHOM_RX_OVERRUN; /* the port reports it with the bytes behind it */
        set_up_for(0, FATHOM_LINE_ECHO_AUTO);
        start_write(0, 100);
        run(8 * BYTE_US);
        if (!is_overrun) receive_rx(auto_frame, 2, flags[i]);
        run(100);
        receive_rx(set_address_5, sizeof set_address_5, is_overrun ? FATHOM_RX_OVERRUN : 0);
        expect_after(TIMEOUT_US + 100, FATHOM_ERR_ECHO);
    }
}

/* ---- attempts ---- */

TEST(each_attempt_of_a_write_needs_its_own_two_copies)
{
    set_up_for(0, FATHOM_LINE_ECHO_ON);
    start_write(1, 100);
    copy_in(BY_BYTE, 0);
    run_until_written(2, 100); /* twice the time-out later */
    copy_in(BY_BYTE, 0);
    expect_after(9 * BYTE_US, FATHOM_PENDING);
    copy_in(BY_BYTE, 0);
    expect_after(9 * BYTE_US, FATHOM_OK);
    assert_int_equal(bench.request.transaction.attempts, 2);
    expect_count(FATHOM_LINE_NO_RESPONSES, 1);
}

TEST(the_last_attempt_of_an_unknown_echo_says_echo)
{
    set_up_for(0, FATHOM_LINE_ECHO_AUTO);
    start_write(2, 100);
    for (unsigned attempt = 1; attempt <= 3; attempt++) {
        run_until_written(attempt, 100);
        expect(FATHOM_PENDING);
        copy_in(BY_BYTE, 0);
    }
    expect_after(TIMEOUT_US + 10000, FATHOM_ERR_ECHO);
    expect_count(FATHOM_LINE_ECHOES, 3);
}

TEST(a_refused_write_on_an_echoing_line_is_an_exception)
{
    static const uint8_t refusal[] = {0x01, 0x86, 0x03, 0x02, 0x61};
    for (size_t m = 0; m != COUNT_OF(modes); m++) {
        if (modes[m] == FATHOM_LINE_ECHO_OFF) continue;
        set_up_for(0, modes[m]);
        start_write(0, 100);
        copy_in(BY_BYTE, 0);
        come_all(20000, refusal);
        expect_after(30000, FATHOM_ERR_EXCEPTION);
        assert_int_equal(bench.request.message.exception, 3);
        expect_echo(modes[m]); /* not OFF, above all */
    }
}

/* ---- a write of many, whose response is shorter than the request ---- */

static void start_write_of_many(uint32_t step_us)
{
    ask_to_write_36_ms();
    run_until_written(1, step_us);
    expect_bytes(0, set_36_ms, sizeof set_36_ms);
}

static void write_of_many(const way_t *way)
{
    for (unsigned echoes = 0; echoes != 2; echoes++) {
        set_up_with(way->mode);
        start_write_of_many(way->step_us);
        if (echoes != 0) come(way->seed, 0, set_36_ms, sizeof set_36_ms);
        come(way->seed, sizeof set_36_ms * BYTE_US + way->pause_us, set_ms_done, sizeof set_ms_done);
        run_in_steps(80000, way->step_us);
        expect(FATHOM_OK);
        expect_learned(way->mode, echoes != 0 ? FATHOM_LINE_ECHO_ON : FATHOM_LINE_ECHO_OFF);
        expect_count(FATHOM_LINE_DROPPED_BYTES, 0);
    }
}

TEST(a_write_of_many_registers_is_told_from_its_echo) { in_every_way(write_of_many); }

/* ---- conversations ---- */

#define READ      "01 03 01 00 00 01 85 F6" /* of unit 1 */
#define RESPONDS  "01 03 02 02 F2 38 A1"    /* 754 mm */
#define COPY      "01 06 02 00 00 05 48 71" /* of a write of 5 to 0200 */
#define TO_ALL    "00 06 02 00 00 05 49 A0" /* the same to all units */
#define BEGINS(x) QUEUE(x, 1), SENT(0, T3_5_US + 200)

#define WRITE_TWICE STEP(write_twice, .which = A, .unit = 1)
#define WRITE_36_MS STEP(write_36_ms, .which = A)

static void play_write_twice(const step_t *step)
{
    request_of(step)->transaction.retries = 1;
    play_write(step);
}

static void play_write_36_ms(const step_t *step) { ask_to_write_36_ms(); }

static const conversation_t conversations[] = {
    ROW("nothing_is_known_before_the_first_response", COUNTS(.no_responses = 1), ECHO(AUTO), ECHO_IS(AUTO),
        ASK(A, 1), WAIT(3 * TIMEOUT_US), FAILS(A, NO_RESPONSE), ECHO_IS(AUTO)),
    /* line.h: the echo of a request to all units is of no unit, and goes where such bytes go */
    ROW("the_echo_of_a_request_to_all_units_shows_nothing", COUNTS(.dropped = 8), ECHO(AUTO), WRITE(A, 0),
        SENT(0, T3_5_US + 200), SEND(TO_ALL), WAIT(20000), ECHO_IS(AUTO)),
    ROW("another_units_response_shows_nothing", COUNTS(.no_responses = 1, .strays = 1, .dropped = 7),
        ECHO(AUTO), ASK(A, 1), RESPONSE(2, 222), WAIT(TIMEOUT_US), FAILS(A, NO_RESPONSE), ECHO_IS(AUTO)),
    /* what stands behind the part that has come is no part of it */
    ROW("an_echo_that_comes_in_parts_behind_noise_is_an_echo", COUNTS(.responses = 1, .dropped = 1),
        ECHO(AUTO), ASK(A, 1), RECEIVE("FF 01 03 01 00 00"), RECEIVE("01 85 F6"), ECHO_IS(ON),
        RECEIVE(RESPONDS), READS(A, 754)),
    ROW("a_retry_on_an_echoing_line_takes_the_response_behind_its_own_echo",
        COUNTS(.no_responses = 1, .responses = 1), ECHO(AUTO), QUEUE_TWICE(A, 1), SENT(0, T3_5_US + 200),
        SEND(READ), SENT(2 * TIMEOUT_US - 1000, 2000), COUNT(NO_RESPONSES, 1), SEND(READ), WAIT(12000),
        SEND(RESPONDS), READS(A, 754)),
    ROW("a_late_response_on_an_echoing_line_is_no_other_requests",
        COUNTS(.no_responses = 1, .late = 1, .dropped = 7, .responses = 1, .maybe_unsolicited = 1),
        ECHO(AUTO), BEGINS(A), SEND(READ), WAIT(TIMEOUT_US + 10000), FAILS(A, NO_RESPONSE), QUEUE(B, 1),
        ARRIVE(RESPONDS), SENT(0, T3_5_US + 200), COUNT(LATE_RESPONSES, 1), PENDS(B), SEND(READ),
        RECEIVE("01 03 02 02 EF F8 A8"), READS(B, 751)),
    /* the device is dead, and the line says so */
    ROW("the_first_copy_alone_never_ends_a_write_where_an_echo_is_known",
        COUNTS(.responses = 1, .no_responses = 1), ECHO(AUTO), BEGINS(A), SEND(READ), WAIT(12000),
        SEND(RESPONDS), READS(A, 754), ECHO_IS(ON), WAIT(30000), WRITE(A, 1), SENT(0, T3_5_US + 200),
        SEND(COPY), WAIT(TIMEOUT_US + 10000), ENDS(A, FATHOM_ERR_NO_RESPONSE)),
    ROW("after_a_read_without_echo_one_copy_acknowledges_a_write", COUNTS(.responses = 2), ECHO(AUTO),
        ASK(A, 1), WAIT(12000), SEND(RESPONDS), READS(A, 754), WAIT(30000), WRITE(A, 1),
        SENT(0, T3_5_US + 200), WAIT(20000), SEND(COPY), ENDS(A, FATHOM_OK)),
    ROW("a_late_second_copy_serves_the_retry_of_a_write",
        COUNTS(.no_responses = 1, .late = 1, .responses = 1), ECHO(ON), WRITE_TWICE, SENT(0, T3_5_US + 200),
        SEND(COPY), WAIT(TIMEOUT_US + 12000), COUNT(NO_RESPONSES, 1), SEND(COPY), ENDS(A, FATHOM_OK),
        WRITTEN(1)),
    /* a write of many, whose response is shorter than the request */
    ROW("the_echo_of_a_write_of_many_is_no_response", COUNTS(.no_responses = 1), ECHO(AUTO), WRITE_36_MS,
        SENT(0, T3_5_US + 200), SEND("01 10 00 20 00 02 04 00 00 00 24 F1 AC"), WAIT(2 * TIMEOUT_US),
        ENDS(A, FATHOM_ERR_NO_RESPONSE), ECHO_IS(ON)),
};
CONVERSATIONS(set_up, conversations)
