/* SPDX-License-Identifier: MIT */
#include <stdlib.h>

#include "fathom/codec/crc16.h"
#include "job.h"

/*
 * Reads 4 registers over and over from a device in memory. tests/bench/run.py counts the instructions below
 * job_read() and leaves out the functions of this file and of job.c. Every transaction takes three polls:
 * the request goes out, it has left, the response is there; or two with a second argument: it goes out, and by the next
 * poll it has left and was answered. The first argument says how often.
 */
static uint8_t response[13] = {1, 3, 8, 0x04, 0xD2, 0x16, 0x2E, 0, 1, 0xFF, 0xFF};
static uint32_t time_us;
static int reads; /* since the request left; < 0 before */
static int answered_at = 2;

static int stub_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    if (reads < 0 || capacity < sizeof response || ++reads != answered_at) return 0;
    for (size_t i = 0; i != sizeof response; i++) bytes[i] = response[i];
    return (int)sizeof response;
}

static int stub_write(void *ctx, const uint8_t *bytes, size_t length)
{
    reads = 0;
    return (int)length;
}

static bool stub_sent(void *ctx) { return true; }

static uint32_t stub_now_us(void *ctx) { return time_us += 5000; }

#ifdef JOB_ALL
static int stub_set_line(void *ctx, const fathom_line_settings_t *settings) { return 1; }
#define SET_LINE stub_set_line
#else
#define SET_LINE NULL
#endif

const fathom_uart_t uart = {.read = stub_read, .write = stub_write, .sent = stub_sent, .set_line = SET_LINE};
const fathom_clock_t clock = {stub_now_us, NULL};

int main(int argc, char **argv)
{
    if (argc < 2) return EXIT_FAILURE;
    if (argc > 2) answered_at = 1;
    const uint16_t crc = fathom_crc16(response, 11);
    response[11] = (uint8_t)crc;
    response[12] = (uint8_t)(crc >> 8);
    job_begin();
    for (int i = atoi(argv[1]); i > 0; i--) {
        reads = -1;
        if (job_read() != FATHOM_OK) return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
