/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "hex.h"
#include "suite.h"

#include "fathom/sensor/hps167s.h"
#include "fathom_posix.h"
#include "posix_pty.h"

/*
 * The bus of the POSIX port: what it is made of, what a driver gets from it, and its errors. The sensor is this file,
 * at the other end of a pseudo terminal; its response stands in the datasheet of the HPS-167S (#5).
 */

static posix_pty_t pty;
static fathom_posix_bus_t bus;
static fathom_hps167s_t gate;

static const fathom_line_settings_t settings = {19200, FATHOM_PARITY_EVEN, 1};

static int set_up(void **state)
{
    memset(&bus, 0xA5, sizeof bus); /* any content will do */
    posix_pty_open(&pty);
    assert_int_equal(fathom_posix_bus_open(&bus, pty.path, &settings), FATHOM_POSIX_OK);
    return 0;
}

static int tear_down(void **state)
{
    fathom_posix_bus_close(&bus);
    posix_pty_close(&pty);
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = tear_down, .begin_round = posix_start_watchdog};

static fathom_sensor_t gate_sensor(void)
{
    assert_int_equal(fathom_hps167s_init(&gate, &bus.modbus, NULL), FATHOM_OK);
    return fathom_hps167s_sensor(&gate);
}

/* Polls the sensor until its request has arrived at the other end. */
static void expect_request(const fathom_sensor_t *sensor, const char *hex)
{
    uint8_t expected[16], seen[16];
    const uint8_t length = hex_parse(hex, expected);
    size_t have = 0;
    fathom_sample_t sample;
    while (have < length) {
        assert_int_equal(fathom_poll(sensor, &sample), FATHOM_PENDING);
        fathom_posix_wait(&bus.port, 1000);
        have += posix_pty_receive(&pty, seen + have, sizeof seen - have);
    }
    assert_int_equal(have, length);
    assert_memory_equal(seen, expected, length);
}

static void respond(const char *hex)
{
    uint8_t bytes[32];
    posix_pty_send(&pty, bytes, hex_parse(hex, bytes));
}

/* The far end sends two pieces, `pause_us` apart; then the driver has the reading. */
static void reads_pieces(const char *piece, uint32_t pause_us, const char *next)
{
    fathom_sample_t sample = {0};
    const fathom_sensor_t sensor = gate_sensor();
    expect_request(&sensor, "01 03 00 08 00 04 C5 CB");
    respond(piece);
    for (const uint64_t since_us = fathom_posix_now_us(); fathom_posix_now_us() - since_us < pause_us;) {
        assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_PENDING);
        fathom_posix_wait(&bus.port, 1000);
    }
    respond(next);
    assert_int_equal(fathom_posix_bus_read(&bus, sensor, &sample), FATHOM_OK);
    assert_int_equal(sample.kind, FATHOM_TARGET);
    assert_int_equal(sample.distance_mm, 2083);
    assert_int_equal(bus.counters[FATHOM_LINE_RESPONSES], 1);
}

TEST(a_response_in_two_pieces_is_whole_as_an_ftdi_chip_holds_bytes_back_for_16_ms)
{
    reads_pieces("01 03 08 08 23 DC", 16000, "B2 07 01 00 00 FD 41");
}

/* Some adapters echo: the request comes back first. */
TEST(an_echo_is_no_response)
{
    reads_pieces("01 03 00 08 00 04 C5 CB", 0, "01 03 08 08 23 DC B2 07 01 00 00 FD 41");
}

TEST(a_silent_sensor_is_an_error)
{
    fathom_sample_t sample;
    assert_int_equal(fathom_posix_bus_read(&bus, gate_sensor(), &sample), FATHOM_ERR_NO_RESPONSE);
    assert_int_equal(bus.counters[FATHOM_LINE_NO_RESPONSES], 1);
}

TEST(a_lost_port_is_told_at_once_and_then_each_second)
{
    fathom_sample_t sample;
    const fathom_sensor_t sensor = gate_sensor();
    posix_pty_close(&pty);
    const uint64_t began_us = fathom_posix_now_us();
    assert_int_equal(fathom_posix_bus_read(&bus, sensor, &sample), FATHOM_ERR_PORT);
    const uint64_t first_us = fathom_posix_now_us();
    assert_non_null(strstr(fathom_posix_bus_error(&bus), "unplugged"));
    assert_int_equal(fathom_posix_bus_read(&bus, sensor, &sample), FATHOM_ERR_PORT);
    assert_in_range(fathom_posix_now_us() - first_us, 1000000, 60000000);
    assert_true(first_us >= began_us);
}

TEST(a_bus_that_is_opened_again_serves_the_same_driver)
{
    fathom_sample_t sample = {0};
    const fathom_sensor_t sensor = gate_sensor();
    expect_request(&sensor, "01 03 00 08 00 04 C5 CB");
    fathom_posix_bus_close(&bus);
    assert_int_equal(fathom_posix_bus_read(&bus, sensor, &sample), FATHOM_ERR_PORT);
    assert_int_equal(fathom_posix_bus_open(&bus, pty.path, &settings), FATHOM_POSIX_OK);
    expect_request(&sensor, "01 03 00 08 00 04 C5 CB");
    respond("01 03 08 08 23 DC B2 07 01 00 00 FD 41");
    assert_int_equal(fathom_posix_bus_read(&bus, sensor, &sample), FATHOM_OK);
}

TEST(a_bus_that_cannot_be_opened_says_why_and_no_driver_accepts_it)
{
    static fathom_posix_bus_t none;
    memset(&none, 0xA5, sizeof none);
    assert_int_equal(fathom_posix_bus_open(&none, "/nowhere/tty", &settings), FATHOM_POSIX_ERR_NOT_FOUND);
    assert_non_null(strstr(fathom_posix_bus_error(&none), "/nowhere/tty: "));
    assert_int_equal(fathom_hps167s_init(&gate, &none.modbus, NULL), FATHOM_ERR_ARGUMENT);
    fathom_posix_bus_close(&none); /* which is no error */
}

TEST(nothing_is_opened_without_a_bus_a_path_or_settings)
{
    static fathom_posix_bus_t none;
    assert_int_equal(fathom_posix_bus_open(NULL, pty.path, &settings), FATHOM_POSIX_ERR_ARGUMENT);
    assert_int_equal(fathom_posix_bus_open(&none, NULL, &settings), FATHOM_POSIX_ERR_ARGUMENT);
    assert_int_equal(fathom_posix_bus_open(&none, pty.path, NULL), FATHOM_POSIX_ERR_ARGUMENT);
    fathom_posix_bus_close(NULL);
    assert_string_not_equal(fathom_posix_bus_error(&none), "");
}
