/* SPDX-License-Identifier: MIT */
#include <stddef.h>

#include "fathom_virt.h"
#include "internal/virt.h"

/* PC16550D, table II: registers of one byte. With DLAB the first two are the divisor. */
#define UART VIRT_UART
enum { RBR = 0, THR = 0, DLL = 0, IER = 1, DLM = 1, FCR = 2, LCR = 3, LSR = 5 };
enum { IER_RECEIVED = 1, IER_EMPTY = 2, IER_ERROR = 4 };
/* Interrupt from the first byte on: a response's last one must not wait. */
enum { FCR_ON = 1, FCR_CLEAR = 6 };
enum { LCR_8_BITS = 3, LCR_2_STOPS = 4, LCR_PARITY = 8, LCR_EVEN = 0x10, LCR_BREAK = 0x40, LCR_DLAB = 0x80 };
enum { LSR_READY = 1, LSR_OVERRUN = 2, LSR_PARITY = 4, LSR_FRAMING = 8, LSR_EMPTY = 0x20, LSR_SENT = 0x40 };
enum { LSR_ERRORS = LSR_OVERRUN | LSR_PARITY | LSR_FRAMING };
enum { FIFO = 16, SAMPLES = 16 };

/* 0: not within 2.5 %. */
static uint32_t divider(uint32_t clock_hz, const fathom_line_settings_t *line)
{
    return fathom_serial_divider(clock_hz / SAMPLES, line, 1, UINT16_MAX);
}

static void set_up(fathom_virt_uart_t *uart, const fathom_line_settings_t *line, uint32_t by)
{
    unsigned control = LCR_8_BITS;
    if (line->parity != FATHOM_PARITY_NONE) control |= LCR_PARITY;
    if (line->parity == FATHOM_PARITY_EVEN) control |= LCR_EVEN;
    if (line->stop_bits == 2u) control |= LCR_2_STOPS;
    UART[IER] = 0; /* with DLAB the interrupt would not find its registers */
    UART[LCR] = LCR_DLAB;
    UART[DLL] = (uint8_t)by;
    UART[DLM] = (uint8_t)(by >> 8);
    UART[LCR] = (uint8_t)control;
    UART[IER] = IER_RECEIVED | IER_ERROR;
    uart->line = *line;
}

/* LSR; its errors of the next byte are cleared by reading it, so they are kept until that byte is read. */
static unsigned status(fathom_virt_uart_t *uart)
{
    const unsigned now = UART[LSR];
    uart->next_errors = (uint8_t)(uart->next_errors | (now & LSR_ERRORS));
    return now;
}

static void receive(fathom_virt_uart_t *uart)
{
    fathom_serial_t *const serial = &uart->serial;
    for (;;) {
        const unsigned why = status(uart) | uart->next_errors;
        uint8_t flags = 0;
        uart->next_errors = 0;
        if ((why & LSR_PARITY) != 0u) flags |= FATHOM_RX_PARITY;
        if ((why & LSR_FRAMING) != 0u) flags |= FATHOM_RX_FRAMING;
        if ((why & LSR_READY) != 0u) fathom_serial_put(serial, UART[RBR], flags);
        /* The FIFO keeps what it has: the loss is behind that; where exactly is not known. */
        if ((why & LSR_OVERRUN) != 0u) fathom_serial_lose(serial);
        if ((why & LSR_READY) == 0u) return;
    }
}

/* There is room for a FIFO of bytes. */
static void send(fathom_virt_uart_t *uart)
{
    uint8_t byte;
    for (int space = FIFO; space != 0; space--) {
        if (!fathom_serial_next(&uart->serial, &byte)) {
            UART[IER] = IER_RECEIVED | IER_ERROR;
            uart->serial.leaving = false;
            return;
        }
        UART[THR] = byte;
    }
}

void fathom_virt_external_interrupt(fathom_virt_uart_t *uart)
{
    for (uint32_t source = VIRT_PLIC_CLAIM; source != 0u; source = VIRT_PLIC_CLAIM) {
        if (source == VIRT_UART_SOURCE) {
            receive(uart);
            if ((status(uart) & LSR_EMPTY) != 0u) {
                if (uart->serial.leaving)
                    send(uart);
                else /* sent already, by a byte's interrupt within write: this one would come again for ever */
                    UART[IER] = IER_RECEIVED | IER_ERROR;
            }
        }
        VIRT_PLIC_CLAIM = source; /* complete */
    }
}

static int uart_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    return fathom_serial_read(&((fathom_virt_uart_t *)ctx)->serial, bytes, capacity, rx);
}

static bool uart_sent(void *ctx)
{
    fathom_virt_uart_t *const uart = ctx;
    uint32_t before;
    if (uart->serial.leaving) return false;
    __asm__ volatile("csrrc %0, mstatus, %1" : "=r"(before) : "r"(VIRT_MSTATUS_MIE) : "memory");
    const bool is_sent = (status(uart) & LSR_SENT) != 0u;
    __asm__ volatile("csrs mstatus, %0" ::"r"(before & VIRT_MSTATUS_MIE) : "memory");
    return is_sent;
}

static uint32_t uart_leaves_in_us(void *ctx)
{
    const fathom_virt_uart_t *const uart = ctx;
    return uart_sent(ctx) ? 0u : fathom_serial_leaves_in_us(&uart->serial, &uart->line, FIFO + 1);
}

static int uart_write(void *ctx, const uint8_t *bytes, size_t length)
{
    fathom_virt_uart_t *const uart = ctx;
    if (uart->is_break || !uart_sent(uart)) return 0;
    const int loaded = fathom_serial_load(&uart->serial, bytes, length);
    if (loaded > 0)
        UART[IER] = IER_RECEIVED | IER_ERROR | IER_EMPTY; /* it is empty, which interrupts at once */
    return loaded;
}

static int uart_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    fathom_virt_uart_t *const uart = ctx;
    if (fathom_serial_is_same(settings, &uart->line)) return 1;
    const uint32_t by = divider(uart->clock_hz, settings);
    if (by == 0u) return -1;
    if (uart->is_break || !uart_sent(uart)) return 0; /* LCR has the break, too */
    set_up(uart, settings, by);
    return 1;
}

static int uart_set_break(void *ctx, bool on)
{
    fathom_virt_uart_t *const uart = ctx;
    if (!uart_sent(uart)) return 0;
    const unsigned control = UART[LCR];
    UART[LCR] = (uint8_t)(on ? (control | LCR_BREAK) : (control & ~(unsigned)LCR_BREAK));
    uart->is_break = on;
    return 1;
}

bool fathom_virt_uart_begin(fathom_virt_uart_t *uart, const fathom_virt_uart_config_t *config)
{
    const uint32_t by = divider(config->clock_hz, &config->line);
    if ((by == 0u) || (config->request == NULL) || (config->request_size == 0u)) return false;
    fathom_serial_init(&uart->serial, config->request, config->request_size);
    uart->clock_hz = config->clock_hz;
    uart->is_break = false;
    uart->next_errors = 0;
    UART[FCR] = FCR_ON | FCR_CLEAR;
    set_up(uart, &config->line, by);
    VIRT_PLIC_PRIORITY[VIRT_UART_SOURCE] = 1;
    VIRT_PLIC_ENABLE[VIRT_UART_SOURCE / 32] |= 1u << (VIRT_UART_SOURCE % 32);
    VIRT_PLIC_THRESHOLD = 0;
    __asm__ volatile("csrs mie, %0" ::"r"(VIRT_MIE_MEIE) : "memory");
    return true;
}

fathom_uart_t fathom_virt_uart(fathom_virt_uart_t *uart)
{
    const fathom_uart_t hal = {.read = uart_read,
                               .write = uart_write,
                               .sent = uart_sent,
                               .set_line = uart_set_line,
                               .set_break = uart_set_break,
                               .leaves_in_us = uart_leaves_in_us,
                               .ctx = uart};
    return hal;
}
