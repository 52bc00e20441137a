/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>

#include "fathom/codec/crc16.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/sensor/hps167s.h"

/*
 * Reads UNITS sensors on one line, the way a program with many sensors does: fathom_poll() of each, round after round.
 * tests/bench/run.py counts the instructions below fathom_poll() and leaves out the functions of this file. The first
 * argument says how many readings; the program prints how often the library read the port for them. Two rounds
 * after a request has left the response is there. A round takes 5 ms, and the clock moves
 * between two calls.
 */
enum { UNITS = 32, ROUND_US = 5000 };

static uint8_t response[13] = {0, 3, 8, 0x04, 0xD2, 0x16, 0x2E, 0, 1, 0xFF, 0xFF};
static uint32_t time_us;
static unsigned long reads;
static int rounds_left; /* until the response is there; 0: there is none */

static int stub_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    reads++;
    if (rounds_left != 1 || capacity < sizeof response) return 0;
    rounds_left = 0;
    for (size_t i = 0; i != sizeof response; i++) bytes[i] = response[i];
    return (int)sizeof response;
}

static int stub_write(void *ctx, const uint8_t *bytes, size_t length)
{
    response[0] = bytes[0];
    const uint16_t crc = fathom_crc16(response, 11);
    response[11] = (uint8_t)crc;
    response[12] = (uint8_t)(crc >> 8);
    rounds_left = 4;
    return (int)length;
}

static bool stub_sent(void *ctx) { return true; }

static uint32_t stub_now_us(void *ctx) { return ++time_us; }

static const fathom_uart_t uart = {.read = stub_read, .write = stub_write, .sent = stub_sent};
static const fathom_clock_t clock = {stub_now_us, NULL};
static uint8_t frame[32];
static const fathom_line_parts_t config = {.uart = &uart,
                                           .clock = &clock,
                                           .frame = frame,
                                           .frame_size = sizeof frame,
                                           .echo = FATHOM_LINE_ECHO_OFF,
                                           .silence_us = FATHOM_T3_5_US(19200, 11)};
static fathom_line_t line;
static fathom_modbus_t modbus;
static fathom_hps167s_t units[UNITS];
static fathom_sensor_t sensors[UNITS];
static long readings;

static void units_round(void)
{
    fathom_sample_t sample;
    for (unsigned i = 0; i != UNITS; i++)
        if (fathom_poll(&sensors[i], &sample) == FATHOM_OK) readings++;
}

int main(int argc, char **argv)
{
    if (argc < 2) return EXIT_FAILURE;
    const long wanted = atol(argv[1]);
    (void)fathom_line_init(&line, &config);
    modbus = fathom_modbus_client(&line);
    for (unsigned i = 0; i != UNITS; i++) {
        const fathom_hps167s_config_t of_unit = {.modbus.address = (uint8_t)(i + 1)};
        if (fathom_hps167s_init(&units[i], &modbus, &of_unit) != FATHOM_OK) return EXIT_FAILURE;
        sensors[i] = fathom_hps167s_sensor(&units[i]);
    }
    while (readings < wanted) {
        time_us += ROUND_US;
        if (rounds_left > 1) rounds_left--;
        units_round();
    }
    printf("%lu\n", reads / (unsigned long)wanted);
    return EXIT_SUCCESS;
}
