/* SPDX-License-Identifier: MIT */
#include "loopback.h"

#include "fathom_serial.h"

static uint8_t request[8];
static fathom_serial_t serial;

static uint32_t now_us(void *ctx)
{
    static uint32_t count;
    (void)ctx;
    return ++count;
}

static int read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    return fathom_serial_read(ctx, bytes, capacity, rx);
}

static int write(void *ctx, const uint8_t *bytes, size_t length)
{
    const int taken = fathom_serial_load(ctx, bytes, length);
    uint8_t byte;
    while (taken > 0 && fathom_serial_next(ctx, &byte)) fathom_serial_put(ctx, byte, 0);
    serial.leaving = false;
    return taken;
}

static bool sent(void *ctx)
{
    (void)ctx;
    return true;
}

const fathom_clock_t loopback_clock = {now_us, 0};
const fathom_uart_t loopback_uart = {.read = read, .write = write, .sent = sent, .ctx = &serial};

void loopback_begin(void) { fathom_serial_init(&serial, request, sizeof request); }
