/* SPDX-License-Identifier: MIT */
/* What the UART ports of 32-bit machines share, port/serial: the ring between interrupt and main loop, and the
 * request that leaves. The test is both sides. */
#include "suite.h"

#include "../../port/serial/fathom_serial.h"

enum { RING = 128, SIZE = 8 }; /* the ring as its header has it */

static fathom_serial_t serial;
static uint8_t request[SIZE], got[256];
static fathom_rx_t rx;

EACH_BEGINS(fathom_serial_init(&serial, request, SIZE))

static const suite_t suite = {.set_up = begins};

static int read_all(size_t capacity)
{
    rx = (fathom_rx_t){0, 0};
    return fathom_serial_read(&serial, got, capacity, &rx);
}

/* So many bytes come, the first of them this, with these flags. */
static void expect_read(int count, uint8_t first, uint8_t flags)
{
    assert_int_equal(read_all(sizeof got), count);
    assert_int_equal(got[0], first);
    assert_int_equal(rx.flags, flags);
}

static void put(unsigned from, unsigned count)
{
    for (unsigned i = 0; i != count; i++) fathom_serial_put(&serial, (uint8_t)(from + i), 0);
}

TEST(bytes_come_out_as_they_went_in_through_many_rounds)
{
    unsigned in = 0, out = 0;
    /* Chunks of 1..128 bytes from every place in the ring; 8256 bytes, so that the indices wrap 32 times. */
    for (unsigned chunk = 1; chunk <= RING; chunk++) {
        put(in, chunk);
        in += chunk;
        assert_true(fathom_serial_waits(&serial));
        assert_int_equal(read_all(sizeof got), chunk);
        assert_int_equal(rx.flags, 0);
        for (unsigned i = 0; i != chunk; i++, out++) assert_int_equal(got[i], (uint8_t)out);
        assert_false(fathom_serial_waits(&serial));
    }
    assert_int_equal(serial.overruns, 0);
}

TEST(the_ring_holds_128_bytes_and_the_next_one_after_a_loss_is_told_of_it)
{
    put(0, 77); /* so that it does not stand at its beginning */
    assert_int_equal(read_all(sizeof got), 77);
    put(0, RING);
    assert_int_equal(serial.overruns, 0);
    put(200, 3); /* find no room */
    assert_int_equal(serial.overruns, 3);
    expect_read(RING, 0, 0);
    assert_int_equal(got[RING - 1], 127);
    put(50, 2);
    expect_read(1, 50, FATHOM_RX_OVERRUN);
    expect_read(1, 51, 0);
}

TEST(a_byte_with_a_flag_comes_alone)
{
    put(1, 2);
    fathom_serial_put(&serial, 3, FATHOM_RX_PARITY);
    fathom_serial_put(&serial, 4, FATHOM_RX_PARITY | FATHOM_RX_FRAMING);
    put(5, 2);
    expect_read(2, 1, 0);
    expect_read(1, 3, FATHOM_RX_PARITY);
    expect_read(1, 4, FATHOM_RX_PARITY | FATHOM_RX_FRAMING);
    expect_read(2, 5, 0);
    assert_int_equal(serial.parity, 2);
    assert_int_equal(serial.framing, 1);
}

TEST(a_loss_that_the_uart_tells_of_is_before_this_byte_or_before_the_next)
{
    put(1, 1);
    fathom_serial_put(&serial, 2, FATHOM_RX_OVERRUN);
    fathom_serial_lose(&serial);
    put(3, 2);
    static const uint8_t flags[4] = {0, FATHOM_RX_OVERRUN, FATHOM_RX_OVERRUN, 0};
    for (uint8_t i = 0; i != 4; i++) {
        assert_int_equal(read_all(1), 1);
        assert_int_equal(got[0], i + 1);
        assert_int_equal(rx.flags, flags[i]);
    }
    assert_int_equal(serial.overruns, 2);
}

TEST(counters_stop_at_65535)
{
    serial.parity = serial.framing = serial.overruns = 65534;
    for (int i = 0; i != 3; i++)
        fathom_serial_put(&serial, 0, FATHOM_RX_PARITY | FATHOM_RX_FRAMING | FATHOM_RX_OVERRUN);
    assert_int_equal(serial.parity, 65535);
    assert_int_equal(serial.framing, 65535);
    assert_int_equal(serial.overruns, 65535);
}

TEST(a_request_is_kept_and_handed_out_byte_by_byte)
{
    uint8_t bytes[SIZE] = {1, 2, 3, 4, 5, 6, 7, 8}, byte = 99;
    assert_false(fathom_serial_next(&serial, &byte));
    assert_int_equal(byte, 99);
    for (int round = 0; round != 2; round++) {
        assert_int_equal(fathom_serial_load(&serial, bytes, SIZE), SIZE);
        assert_true(serial.leaving);
        bytes[0] = 0; /* the caller's again */
        for (uint8_t i = 0; i != SIZE; i++) {
            assert_true(fathom_serial_next(&serial, &byte));
            assert_int_equal(byte, i + 1);
        }
        assert_false(fathom_serial_next(&serial, &byte));
        serial.leaving = false;
        bytes[0] = 1;
    }
}

/* A character of 8E1 has 11 bits, 572.92 us at 19200 baud. Of a UART that holds two, the first two bytes that it is
 * given have not left when it takes the third. */
TEST(a_request_has_left_after_the_bytes_that_wait_and_those_that_the_uart_holds)
{
    static const uint8_t bytes[SIZE] = {0};
    static const fathom_line_settings_t line = {19200, FATHOM_PARITY_EVEN, 1};
    static const uint32_t left_us[SIZE + 1] = {4584, 4584, 4584, 4011, 3438, 2865, 2292, 1719, 1146};
    uint8_t byte = 0;
    assert_int_equal(fathom_serial_load(&serial, bytes, SIZE), SIZE);
    for (uint8_t i = 0; i <= SIZE; i++) {
        assert_int_equal(fathom_serial_leaves_in_us(&serial, &line, 2), left_us[i]);
        assert_int_equal(fathom_serial_leaves_in_us(&serial, &line, 17), 4584);
        (void)fathom_serial_next(&serial, &byte);
    }
}

/* As long as it can take: 255 characters of 12 bits at 1200 baud. */
TEST(the_longest_request_at_the_slowest_rate_has_left_after_2_55_s)
{
    static const fathom_line_settings_t line = {1200, FATHOM_PARITY_ODD, 2};
    serial.length = 255;
    serial.at = 0;
    assert_int_equal(fathom_serial_leaves_in_us(&serial, &line, 2), 2550000);
}

TEST(a_request_waits_for_the_one_before_and_has_to_fit)
{
    static const uint8_t bytes[SIZE + 1] = {1, 2, 3};
    assert_true(fathom_serial_load(&serial, bytes, 0) < 0);
    assert_true(fathom_serial_load(&serial, bytes, SIZE + 1) < 0);
    assert_false(serial.leaving);
    assert_int_equal(fathom_serial_load(&serial, bytes, 2), 2);
    assert_int_equal(fathom_serial_load(&serial, bytes + 1, 2), 0);
    assert_true(fathom_serial_load(&serial, bytes, SIZE + 1) < 0);
    assert_int_equal(request[0], 1);
    assert_int_equal(request[1], 2);
}

TEST(a_line_is_the_same_if_its_rate_its_parity_and_its_stop_bits_are)
{
    static const fathom_line_settings_t line = {9600, FATHOM_PARITY_NONE, 1};
    static const fathom_line_settings_t others[] = {
        {19200, FATHOM_PARITY_NONE, 1}, {9600, FATHOM_PARITY_EVEN, 1}, {9600, FATHOM_PARITY_NONE, 2}};
    const fathom_line_settings_t same = line;
    assert_true(fathom_serial_is_same(&line, &same));
    for (size_t i = 0; i != 3; i++) assert_false(fathom_serial_is_same(&line, &others[i]));
}

/* 16 MHz, by 16 to 50000: 9600 baud is 1666.7, so 1667; 1 Mbaud is 16; 320 baud is 50000. 700000 is 22.86, and by 23 it is
 * 695652, 0.6 % off; 300000 is 53.3, by 53 0.6 % too fast. */
TEST(a_clock_is_divided_to_the_nearest_rate)
{
    static const struct {
        fathom_line_settings_t line;
        uint32_t divider;
    } rows[] = {{{9600, FATHOM_PARITY_NONE, 1}, 1667},
                {{1000000, FATHOM_PARITY_ODD, 2}, 16},
                {{320, FATHOM_PARITY_EVEN, 1}, 50000},
                {{700000, FATHOM_PARITY_NONE, 1}, 23},
                {{300000, FATHOM_PARITY_NONE, 1}, 53},
                {{0, FATHOM_PARITY_NONE, 1}, 0},
                {{1000001, FATHOM_PARITY_NONE, 1}, 0},
                {{300, FATHOM_PARITY_NONE, 1}, 0},
                {{9600, 3, 1}, 0},
                {{9600, FATHOM_PARITY_NONE, 0}, 0},
                {{9600, FATHOM_PARITY_NONE, 3}, 0}};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++)
        assert_int_equal(fathom_serial_divider(16000000, &rows[i].line, 16, 50000), rows[i].divider);
    /* 100 Hz by 3 is 33.3, which is 16.7 % off of 40 baud. */
    const fathom_line_settings_t odd = {40, FATHOM_PARITY_NONE, 1};
    assert_int_equal(fathom_serial_divider(100, &odd, 1, 100), 0);
}
