/* SPDX-License-Identifier: MIT */
#include "loop_fake.h"
#include "suite.h"

/* The uart that fathom_loop_uart gives, and what fathom_loop_add_line makes of its arguments, in simulated time. */

enum { MANY = 300 };

static fake_source_t one;
static fake_sensor_t first;
static fathom_uart_t uart;

/* The port behind it. */
static struct {
    int bytes; /* of each read; < 0: it is lost */
    unsigned reads;
    bool on;
    uint32_t baud;
} port;

static int port_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    assert_ptr_equal(ctx, &port);
    port.reads++;
    return port.bytes > (int)capacity ? (int)capacity : port.bytes;
}

static int port_write(void *ctx, const uint8_t *bytes, size_t length)
{
    assert_ptr_equal(ctx, &port);
    return bytes[0] + (int)length;
}

static bool port_sent(void *ctx)
{
    assert_ptr_equal(ctx, &port);
    return port.on;
}

static int port_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    assert_ptr_equal(ctx, &port);
    port.baud = settings->baud;
    return 7;
}

static int port_set_break(void *ctx, bool on)
{
    assert_ptr_equal(ctx, &port);
    port.on = on;
    return 8;
}

static uint32_t port_leaves_in_us(void *ctx)
{
    assert_ptr_equal(ctx, &port);
    return 4000000000u;
}

static int set_up(void **state)
{
    const fathom_uart_t inner = {.read = port_read, .write = port_write, .sent = port_sent, .ctx = &port};
    (void)fake_set_up(state);
    memset(&port, 0, sizeof port);
    fake_source(&one);
    uart = fathom_loop_uart(&one.source, &inner);
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = fake_tear_down};

static void add(void) { fathom_loop_add(&fake.loop, &one.source); }

/* A read of so many bytes brings so many, and the port was asked or not. */
static void expect_read(size_t capacity, int bytes, bool is_asked)
{
    static uint8_t into[MANY];
    fathom_rx_t rx = {0, 0};
    const unsigned before = port.reads;
    assert_int_equal(uart.read(uart.ctx, into, capacity, &rx), bytes);
    assert_int_equal(port.reads - before, is_asked);
}

/* ---- when a read asks ---- */

TEST(what_came_before_it_was_open_is_looked_for_once)
{
    add();
    expect_read(8, 0, true);
    expect_read(8, 0, false);
}

TEST(a_read_asks_once_it_has_become_ready_until_it_brings_nothing)
{
    add();
    expect_read(8, 0, true);
    fathom_loop_wake(&one.source);
    port.bytes = 3;
    expect_read(8, 3, true);
    expect_read(8, 3, true);
    port.bytes = 0;
    expect_read(8, 0, true);
    expect_read(8, 0, false);
}

TEST(a_read_asks_if_the_loop_looked_five_milliseconds_ago)
{
    add();
    expect_read(8, 0, true);
    fake.now_us += 4999;
    expect_read(8, 0, false);
    fake.now_us++;
    expect_read(8, 0, true);
    expect_read(8, 0, false); /* the port itself was empty a moment ago */
    fake.now_us += 5000;
    port.bytes = 3;
    expect_read(8, 3, true);
    fathom_loop_step(&fake.loop, 0);
    expect_read(8, 0, false);
}

/* reads_all, as ttys do: each row is a read of so many bytes, what it brings, and whether the next one asks. */
TEST(where_a_short_read_has_brought_all_the_next_one_does_not_ask)
{
    static const struct {
        size_t capacity;
        int bytes;
        bool asks_again;
    } rows[] = {{8, 1, false}, {8, 7, false}, {8, 8, true}, {256, 200, false}, {256, 256, true}};
    one.source.reads_all = true;
    add();
    for (unsigned i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        fathom_loop_wake(&one.source);
        port.bytes = rows[i].bytes;
        expect_read(rows[i].capacity, rows[i].bytes, true);
        port.bytes = 0;
        expect_read(8, 0, rows[i].asks_again);
    }
}

/* As a connection has one: bytes may wait there since before the loop watched it. */
TEST(another_descriptor_is_watched_and_read_at_once)
{
    add();
    expect_read(8, 0, true);
    expect_read(8, 0, false);
    one.fd++;
    fathom_loop_wake(&one.source);
    fathom_loop_step(&fake.loop, 0);
    assert_int_equal(one.source.fd, one.fd);
    expect_read(8, 0, true);
    expect_read(8, 0, false);
}

TEST(a_port_that_is_lost_or_closed_is_asked_and_says_so)
{
    one.source.reads_all = true;
    port.bytes = -1;
    expect_read(8, -1, true); /* it was not added */
    one.cannot_open = true;
    add();
    expect_read(8, -1, true);
    expect_read(8, -1, true);
}

static void read_of_lost(fathom_status_t status)
{
    if (status == FATHOM_ERR_PORT) expect_read(8, -1, true);
}

TEST(a_sensor_that_reads_while_its_port_is_being_lost_hears_it_from_the_port)
{
    add();
    fake_sensor(&first, &one);
    fathom_loop_step(&fake.loop, 0);
    port.bytes = 0;
    expect_read(8, 0, true);
    port.bytes = -1;
    one.is_lost = true;
    first.when_taken = read_of_lost;
    fathom_loop_step(&fake.loop, FATHOM_NO_DEADLINE);
    assert_int_equal(first.port_errors, 1);
}

/* The rest of what was not read does not become ready again, so it is polled a millisecond later. */
TEST(one_that_leaves_bytes_unread_is_polled_again_after_a_millisecond)
{
    add();
    fathom_loop_step(&fake.loop, 0);
    assert_int_equal(fathom_loop_due_us(&fake.loop), 1000);
    expect_read(8, 0, true);
    fathom_loop_step(&fake.loop, FATHOM_NO_DEADLINE);
    assert_int_equal(fathom_loop_due_us(&fake.loop), 1000000);
}

/* ---- the other members ---- */

TEST(the_other_members_are_the_ports)
{
    static const fathom_line_settings_t settings = {19200, FATHOM_PARITY_EVEN, 1};
    static const uint8_t bytes[] = {40};
    const fathom_uart_t inner = {.read = port_read,
                                 .write = port_write,
                                 .sent = port_sent,
                                 .set_line = port_set_line,
                                 .set_break = port_set_break,
                                 .leaves_in_us = port_leaves_in_us,
                                 .ctx = &port};
    uart = fathom_loop_uart(&one.source, &inner);
    assert_int_equal(uart.write(uart.ctx, bytes, 1), 41);
    assert_false(uart.sent(uart.ctx));
    assert_int_equal(uart.set_line(uart.ctx, &settings), 7);
    assert_int_equal(port.baud, 19200);
    assert_int_equal(uart.set_break(uart.ctx, true), 8);
    assert_true(uart.sent(uart.ctx));
    assert_int_equal(uart.set_break(uart.ctx, false), 8);
    assert_false(uart.sent(uart.ctx));
    assert_int_equal(uart.leaves_in_us(uart.ctx), 4000000000u);
}

TEST(what_the_port_has_not_it_has_not_either)
{
    assert_null(uart.set_line);
    assert_null(uart.set_break);
    assert_null(uart.leaves_in_us);
}

/* ---- lines ---- */

/* Modbus over serial line 2.5.1.1: 3.5 characters. silence.h: of 11 bits, at 9600 or 19200 baud. 38.5 / 9600 is 4010.4
 * us; 38.5 / 19200 is 2005.2. The port has slower rates, too: 35 / 1200 is 29166.7, 42 / 4800 is 8750. */
TEST(a_line_has_the_silence_of_its_settings)
{
    static const struct {
        fathom_line_settings_t settings;
        uint16_t silence_us;
    } rows[] = {{{9600, FATHOM_PARITY_NONE, 1}, 4011},   {{9600, FATHOM_PARITY_EVEN, 1}, 4011},
                {{19200, FATHOM_PARITY_EVEN, 1}, 2006},  {{19200, FATHOM_PARITY_NONE, 1}, 2006},
                {{115200, FATHOM_PARITY_NONE, 1}, 2006}, {{1200, FATHOM_PARITY_NONE, 1}, 29167},
                {{4800, FATHOM_PARITY_ODD, 2}, 8750}};
    static fathom_loop_line_t line;
    for (unsigned i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        memset(&line, 0xA5, sizeof line); /* any content will do */
        assert_int_equal(fathom_loop_add_line(&fake.loop, &line, "/nowhere", &rows[i].settings),
                         FATHOM_POSIX_OK);
        assert_int_equal(line.bus.parts.silence_us, rows[i].silence_us);
        fathom_loop_remove(&line.source);
    }
}

TEST(a_line_finds_out_about_echo_waits_25_ms_and_counts)
{
    static const fathom_line_settings_t settings = {9600, FATHOM_PARITY_NONE, 1};
    static fathom_loop_line_t line;
    memset(&line, 0xA5, sizeof line);
    assert_int_equal(fathom_loop_add_line(&fake.loop, &line, "/nowhere", &settings), FATHOM_POSIX_OK);
    assert_true(line.bus.parts.find_echo == fathom_line_find_echo);
    assert_int_equal(line.bus.parts.gap_us, 25000);
    assert_ptr_equal(line.bus.parts.senders, &fathom_line_senders);
    assert_ptr_equal(line.bus.parts.masters, &fathom_line_masters);
    assert_true(line.bus.parts.count == fathom_line_count);
    assert_int_equal(line.bus.parts.echo, FATHOM_LINE_ECHO_AUTO);
    assert_ptr_equal(line.bus.parts.uart, &line.bus.uart);
    assert_ptr_equal(line.bus.parts.clock, &line.bus.clock);
    assert_int_equal(fake_failures((fake_source_t *)&line.source),
                     1); /* no such path, which is no failure of the call */
    fathom_loop_step(&fake.loop, FATHOM_NO_DEADLINE);
    assert_int_equal(fake_elapsed_us(), 500000);
    fathom_loop_remove(&line.source);
}
