/* SPDX-License-Identifier: MIT */
#include "job.h"

/*
 * A UART that takes a frame into its FIFO and a microsecond timer, both as registers. Their addresses come
 * from the linker: on a Cortex-M0+ nothing is behind them, for only the size is wanted; on an ATmega328P
 * they are spare registers in which avr.c, the simulator, plays the device.
 */
enum { RX_READY = 1, TX_BUSY = 2 };
extern volatile uint8_t uart_status, uart_data;
extern volatile uint32_t timer_us;

static int stub_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    size_t n = 0;
    while (n != capacity && (uart_status & RX_READY) != 0) bytes[n++] = uart_data;
    return (int)n;
}

static int stub_write(void *ctx, const uint8_t *bytes, size_t length)
{
    if ((uart_status & TX_BUSY) != 0) return 0;
    for (size_t i = 0; i != length; i++) uart_data = bytes[i];
    return (int)length;
}

static bool stub_sent(void *ctx) { return (uart_status & TX_BUSY) == 0; }

static uint32_t stub_now_us(void *ctx) { return timer_us; }

const fathom_uart_t uart = {stub_read, stub_write, stub_sent, NULL, NULL, NULL};
const fathom_clock_t clock = {stub_now_us, NULL};
