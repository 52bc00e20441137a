/* SPDX-License-Identifier: MIT */
#include <stddef.h>

#include "fathom_mps2.h"

/* CMSDK APB UART (DDI 0479, 4.3): one byte in the buffer and one on the wire, each way. */
enum { DATA = 0x00 / 4, STATE = 0x04 / 4, CTRL = 0x08 / 4, INTSTATUS = 0x0C / 4, BAUDDIV = 0x10 / 4 };
enum { STATE_TXFULL = 1, STATE_RXFULL = 2, STATE_RXOVERRUN = 8 };
enum { CTRL_TX = 1, CTRL_RX = 2, CTRL_TX_INTERRUPT = 4, CTRL_RX_INTERRUPT = 8 };
enum { INTSTATUS_TX = 1, INTSTATUS_RX = 2 };
enum { MIN_BAUDDIV = 16, MAX_BAUDDIV = 0xFFFFF };
enum { CHARACTER_BITS = 10, HELD = 2 /* bytes: one in the buffer, one on the wire */ };

#define NVIC_ISER ((volatile uint32_t *)0xE000E100u)

/* AN385 3.2 and 3.7: where they are, and the first of the two interrupts. */
typedef struct {
    volatile uint32_t *registers;
    uint32_t interrupt;
} place_t;
static const place_t places[] = {{(volatile uint32_t *)0x40004000u, 0},
                                 {(volatile uint32_t *)0x40005000u, 2},
                                 {(volatile uint32_t *)0x40006000u, 4},
                                 {(volatile uint32_t *)0x40007000u, 18},
                                 {(volatile uint32_t *)0x40009000u, 20}};
enum { PLACES = sizeof(places) / sizeof(places[0]) };

/* 0: not within 2.5 %, or not 8N1, which is all that these UARTs have. */
static uint32_t divider(const fathom_line_settings_t *line)
{
    return ((line->parity != FATHOM_PARITY_NONE) || (line->stop_bits != 1u))
               ? 0u
               : fathom_serial_divider(FATHOM_MPS2_HZ, line, MIN_BAUDDIV, MAX_BAUDDIV);
}

void fathom_mps2_uart_interrupt(fathom_mps2_uart_t *uart)
{
    volatile uint32_t *const registers = uart->registers;
    const uint32_t why = registers[INTSTATUS];
    uint8_t byte;
    registers[INTSTATUS] = why; /* before the bytes: one that comes after this interrupts again */
    while ((registers[STATE] & STATE_RXFULL) != 0u) {
        const bool is_overrun = (registers[STATE] & STATE_RXOVERRUN) != 0u;
        if (is_overrun) registers[STATE] = STATE_RXOVERRUN;
        fathom_serial_put(&uart->serial, (uint8_t)registers[DATA], is_overrun ? FATHOM_RX_OVERRUN : 0);
    }
    if (((why & INTSTATUS_TX) == 0u) || !uart->serial.leaving) return;
    if (fathom_serial_next(&uart->serial, &byte)) {
        registers[DATA] = byte;
        return;
    }
    uart->taken_us = fathom_mps2_clock.now_us(NULL);
    uart->serial.leaving = false;
}

static int uart_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    return fathom_serial_read(&((fathom_mps2_uart_t *)ctx)->serial, bytes, capacity, rx);
}

static bool uart_sent(void *ctx)
{
    fathom_mps2_uart_t *const uart = ctx;
    if (uart->is_sending && !uart->serial.leaving &&
        (fathom_elapsed_us(fathom_mps2_clock.now_us(NULL), uart->taken_us) >
         (CHARACTER_BITS * 1000000u / uart->baud)))
        uart->is_sending = false;
    return !uart->is_sending;
}

static uint32_t uart_leaves_in_us(void *ctx)
{
    const fathom_mps2_uart_t *const uart = ctx;
    const fathom_line_settings_t line = {uart->baud, FATHOM_PARITY_NONE, 1};
    return uart_sent(ctx) ? 0u : fathom_serial_leaves_in_us(&uart->serial, &line, HELD);
}

static int uart_write(void *ctx, const uint8_t *bytes, size_t length)
{
    fathom_mps2_uart_t *const uart = ctx;
    const int loaded = fathom_serial_load(&uart->serial, bytes, length);
    uint8_t byte;
    if (loaded <= 0) return loaded;
    uart->is_sending = true;
    /* The buffer is free: the last request's last byte has left it. */
    if (fathom_serial_next(&uart->serial, &byte)) uart->registers[DATA] = byte;
    return loaded;
}

static int uart_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    fathom_mps2_uart_t *const uart = ctx;
    const uint32_t by = divider(settings);
    if (by == 0u) return -1;
    if (settings->baud == uart->baud) return 1;
    if (!uart_sent(uart)) return 0;
    uart->registers[BAUDDIV] = by;
    uart->baud = settings->baud;
    return 1;
}

bool fathom_mps2_uart_begin(fathom_mps2_uart_t *uart, const fathom_mps2_uart_config_t *config)
{
    if ((config->number >= PLACES) || (config->request == NULL) || (config->request_size == 0u)) return false;
    const uint32_t by = divider(&config->line);
    if (by == 0u) return false;
    const place_t *const place = &places[config->number];
    fathom_serial_init(&uart->serial, config->request, config->request_size);
    uart->registers = place->registers;
    uart->baud = config->line.baud;
    uart->is_sending = false;
    uart->registers[CTRL] = 0;
    uart->registers[BAUDDIV] = by;
    uart->registers[INTSTATUS] = INTSTATUS_TX | INTSTATUS_RX;
    __asm__ volatile("" ::: "memory"); /* all that is stored before the interrupts are enabled */
    NVIC_ISER[place->interrupt / 32u] = 3u << (place->interrupt % 32u);
    uart->registers[CTRL] = CTRL_TX | CTRL_RX | CTRL_TX_INTERRUPT | CTRL_RX_INTERRUPT;
    return true;
}

fathom_uart_t fathom_mps2_uart(fathom_mps2_uart_t *uart)
{
    const fathom_uart_t hal = {.read = uart_read,
                               .write = uart_write,
                               .sent = uart_sent,
                               .set_line = uart_set_line,
                               .leaves_in_us = uart_leaves_in_us,
                               .ctx = uart};
    return hal;
}
