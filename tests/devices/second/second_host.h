/* SPDX-License-Identifier: MIT */
/* A host on the wire of one device or of several on one pair, for the tests of this folder. */
#ifndef SECOND_TEST_HOST_H
#define SECOND_TEST_HOST_H

#include "second_device.h"

#include <string.h>

#include "suite.h"

#define HOST_BYTES   262144
#define HOST_DEVICES 3

typedef struct {
    second_device_t device[HOST_DEVICES];
    size_t devices, running;
    uint64_t now_us, step_us; /* step_us: the longest run at once; 0: any */
    second_line_t line;
    second_byte_t got[HOST_BYTES];
    size_t got_len, read_len;
} host_t;

static const second_line_t line_9600 = {9600, 'N', 1};
static const second_line_t line_hps = {19200, 'E', 1};

/* A byte of one device: the host and the other devices hear it. */
static inline void host_hears(void *context, const second_byte_t *byte)
{
    host_t *h = context;
    assert_true(h->got_len < HOST_BYTES);
    h->got[h->got_len++] = *byte;
    for (size_t i = 0; i < h->devices; i++) {
        if (i != h->running)
            second_host_byte(&h->device[i], byte->value, byte->start_us, byte->end_us, byte->line);
    }
}

static inline void host_run(host_t *h, uint64_t until_us)
{
    while (h->now_us < until_us) {
        uint64_t next_us = until_us;
        for (size_t i = 0; i < h->devices; i++) {
            uint64_t device_us = second_next_us(&h->device[i]);
            if (device_us < next_us) next_us = device_us;
        }
        if (h->devices == 1) next_us = until_us;
        if (h->step_us != 0 && next_us > h->now_us + h->step_us) next_us = h->now_us + h->step_us;
        if (next_us < h->now_us) next_us = h->now_us;
        for (h->running = 0; h->running < h->devices; h->running++)
            second_run(&h->device[h->running], next_us, host_hears, h);
        h->now_us = next_us;
    }
}

static inline void host_open(host_t *h, const second_config_t *config)
{
    h->now_us = h->step_us = 0;
    h->got_len = h->read_len = 0;
    h->devices = 1;
    h->line = config->kind == SECOND_HPS167S ? line_hps : line_9600;
    assert_true(second_init(&h->device[0], config));
}

static inline void host_power(host_t *h, bool on)
{
    for (size_t i = 0; i < h->devices; i++) second_power(&h->device[i], on, h->now_us);
    host_run(h, h->now_us + 1);
}

/* Sends and runs up to the end of the last byte. */
static inline void host_send(host_t *h, const uint8_t *bytes, size_t len)
{
    uint64_t bits = 9U + (h->line.parity != 'N' ? 1U : 0U) + h->line.stop_bits;
    uint64_t begin_us = h->now_us + 1;
    for (size_t i = 0; i < len; i++) {
        uint64_t start_us = begin_us + i * bits * 1000000 / h->line.baud;
        uint64_t end_us = begin_us + (i + 1) * bits * 1000000 / h->line.baud;
        for (size_t k = 0; k < h->devices; k++)
            second_host_byte(&h->device[k], bytes[i], start_us, end_us, h->line);
    }
    h->read_len = h->got_len;
    host_run(h, begin_us + len * bits * 1000000 / h->line.baud);
}

static inline size_t from_hex(const char *hex, uint8_t *bytes)
{
    size_t len = 0;
    unsigned value;
    int used;
    while (sscanf(hex, " %2x%n", &value, &used) == 1) {
        bytes[len++] = (uint8_t)value;
        hex += used;
    }
    return len;
}

static inline void host_send_hex(host_t *h, const char *hex)
{
    uint8_t bytes[64];
    host_send(h, bytes, from_hex(hex, bytes));
}

/* Adds the CRC of a Modbus frame; bit by bit, as HPS-167S 2.2.5 tells. */
static inline void host_request(host_t *h, const char *hex)
{
    uint8_t bytes[64];
    size_t len = from_hex(hex, bytes);
    uint16_t crc = 0xFFFF;
    for (size_t i = 0; i < len; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++) crc = (uint16_t)((crc & 1) != 0 ? (crc >> 1) ^ 0xA001 : crc >> 1);
    }
    bytes[len++] = (uint8_t)(crc & 0xFF);
    bytes[len++] = (uint8_t)(crc >> 8);
    host_send(h, bytes, len);
}

/* What came since the last request, as hex; waits first. */
static inline const char *host_response(host_t *h, uint64_t wait_us)
{
    static char hex[3 * 256];
    host_run(h, h->now_us + wait_us);
    hex[0] = '\0';
    size_t used = 0;
    for (size_t i = h->read_len; i < h->got_len && used + 4 < sizeof hex; i++)
        used +=
            (size_t)snprintf(hex + used, sizeof hex - used, used == 0 ? "%02X" : " %02X", h->got[i].value);
    return hex;
}

/* The host of a file of tests. */
static host_t host;

static inline const char *ask(const char *request)
{
    host_request(&host, request);
    return host_response(&host, 450000);
}

static inline second_state_t now(void) { return second_state(&host.device[0]); }

static inline void cycle_power(void)
{
    host_power(&host, false);
    host_run(&host, host.now_us + 100000);
    host_power(&host, true);
    host_run(&host, host.now_us + 12000000);
}

#endif
