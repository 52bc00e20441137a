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

#ifdef JOB_ALL
static int stub_set_line(void *ctx, const fathom_line_settings_t *settings) { return 1; }
#define SET_LINE stub_set_line
#else
#define SET_LINE NULL
#endif

const fathom_uart_t uart = {.read = stub_read, .write = stub_write, .sent = stub_sent, .set_line = SET_LINE};
const fathom_clock_t clock = {stub_now_us, NULL};

/* On RISC-V, which has no libc here, GCC copies by it what a program assigns; of the library nothing may call it
 * (tests/checks/objects.py). volatile: or it would make a call of memcpy of this too. */
void *memcpy(void *restrict to, const void *restrict from, size_t length);
void *memcpy(void *restrict to, const void *restrict from, size_t length)
{
    volatile uint8_t *at = to;
    for (const uint8_t *byte = from; length != 0; length--) *at++ = *byte++;
    return to;
}
