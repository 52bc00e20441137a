/* SPDX-License-Identifier: MIT */
#include <stddef.h>

#include "nrf51.h"
#include "registers.h"

enum { STARTRX = 0x000, STARTTX = 0x008, RXDRDY = 0x108, TXDRDY = 0x11C, ERROR = 0x124, INTENSET = 0x304 };
enum { ERRORSRC = 0x480, ENABLE = 0x500, PSELTXD = 0x50C, PSELRXD = 0x514, RXD = 0x518, TXD = 0x51C };
enum { BAUDRATE = 0x524, CONFIG = 0x56C };
enum { INT_RXDRDY = 1 << 2, INT_TXDRDY = 1 << 7, INT_ERROR = 1 << 9 };
enum { SRC_OVERRUN = 1, SRC_PARITY = 2, SRC_FRAMING = 4, SRC_BREAK = 8 };
enum { ENABLED = 4, CONFIG_EVEN = 7 << 1 };
enum { OUTSET = 0x508, DIRSET = 0x518, PIN_CNF = 0x700, PULL_UP = 3 << 2 };

fathom_serial_t nrf51_serial;
static uint8_t request[NRF51_LONGEST];
static fathom_line_settings_t holds;
static volatile uint32_t taken_us; /* when the last TXDRDY came of what leaves */
static bool is_leaving;

/* 29.10: the rates that the manual gives a value for. 0: none. */
static uint32_t rate(const fathom_line_settings_t *line)
{
    static const struct {
        uint32_t baud, value;
    } rates[] = {{9600, 0x00275000},  {19200, 0x004EA000},  {38400, 0x009D5000},
                 {57600, 0x00EBF000}, {115200, 0x01D7E000}, {230400, 0x03AFB000}};
    if (line->parity > FATHOM_PARITY_EVEN || line->stop_bits != 1) return 0;
    for (unsigned i = 0; i != sizeof rates / sizeof rates[0]; i++)
        if (rates[i].baud == line->baud) return rates[i].value;
    return 0;
}

static uint32_t character_us(void)
{
    const uint32_t bits = holds.parity == FATHOM_PARITY_NONE ? 10 : 11;
    return (bits * 1000000u + holds.baud - 1) / holds.baud;
}

/* What is wrong with a byte is told by ERRORSRC, before the byte is taken. */
static void receive(void)
{
    uint8_t flags = 0;
    const uint32_t why = UART(ERRORSRC);
    UART(ERRORSRC) = why;
    if ((why & SRC_PARITY) != 0) flags |= FATHOM_RX_PARITY;
    if ((why & (SRC_FRAMING | SRC_BREAK)) != 0) flags |= FATHOM_RX_FRAMING;
    if ((why & SRC_OVERRUN) != 0) flags |= FATHOM_RX_OVERRUN;
    fathom_serial_put(&nrf51_serial, (uint8_t)UART(RXD), flags);
}

/* Each event is cleared before what it tells of is done: a byte that comes meanwhile sets it again. */
void nrf51_uart_interrupt(void)
{
    uint8_t byte;
    if (UART(ERROR) != 0) UART(ERROR) = 0; /* ERRORSRC keeps the reason for the byte */
    if (UART(RXDRDY) != 0) {
        UART(RXDRDY) = 0;
        receive();
    }
    if (UART(TXDRDY) == 0) return;
    UART(TXDRDY) = 0;
    if (fathom_serial_next(&nrf51_serial, &byte)) {
        UART(TXD) = byte;
        return;
    }
    taken_us = nrf51_clock.now_us(nrf51_clock.ctx);
    nrf51_serial.leaving = false;
}

static int uart_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    (void)ctx;
    return fathom_serial_read(&nrf51_serial, bytes, capacity, rx);
}

static bool uart_sent(void *ctx)
{
    (void)ctx;
    if (is_leaving && !nrf51_serial.leaving &&
        fathom_elapsed_us(nrf51_clock.now_us(nrf51_clock.ctx), taken_us) > character_us())
        is_leaving = false;
    return !is_leaving;
}

/* TXDRDY is an event and comes of a byte that has left, so the first one is put here. */
static int uart_write(void *ctx, const uint8_t *bytes, size_t length)
{
    uint8_t byte;
    if (!uart_sent(ctx)) return 0;
    const int taken = fathom_serial_load(&nrf51_serial, bytes, length);
    if (taken <= 0) return taken;
    is_leaving = true;
    if (fathom_serial_next(&nrf51_serial, &byte)) UART(TXD) = byte;
    return taken;
}

static uint32_t uart_leaves_in_us(void *ctx)
{
    if (uart_sent(ctx)) return 0;
    if (!nrf51_serial.leaving) return character_us();
    return fathom_serial_leaves_in_us(&nrf51_serial, &holds, 1) + character_us();
}

static void set_up(const fathom_line_settings_t *line, uint32_t value)
{
    UART(ENABLE) = 0;
    UART(BAUDRATE) = value;
    UART(CONFIG) = line->parity == FATHOM_PARITY_EVEN ? CONFIG_EVEN : 0;
    UART(ENABLE) = ENABLED;
    UART(STARTRX) = 1;
    UART(STARTTX) = 1;
    holds = *line;
}

static int uart_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    const uint32_t value = rate(settings);
    if (value == 0) return -1;
    if (fathom_serial_is_same(settings, &holds)) return 1;
    if (!uart_sent(ctx)) return 0;
    set_up(settings, value);
    return 1;
}

const fathom_uart_t nrf51_uart = {.read = uart_read,
                                  .write = uart_write,
                                  .sent = uart_sent,
                                  .set_line = uart_set_line,
                                  .leaves_in_us = uart_leaves_in_us,
                                  .ctx = NULL};

bool nrf51_uart_begin(uint8_t tx_pin, uint8_t rx_pin, const fathom_line_settings_t *line)
{
    const uint32_t value = rate(line);
    if (value == 0 || tx_pin > 31 || rx_pin > 31) return false;
    fathom_serial_init(&nrf51_serial, request, sizeof request);
    is_leaving = false;
    GPIO(OUTSET) = 1u << tx_pin; /* idle is high, also while the UART is off */
    GPIO(DIRSET) = 1u << tx_pin;
    GPIO(PIN_CNF + 4 * rx_pin) = PULL_UP;
    UART(PSELTXD) = tx_pin; /* before ENABLE (29.1) */
    UART(PSELRXD) = rx_pin;
    set_up(line, value);
    UART(RXDRDY) = 0;
    UART(TXDRDY) = 0;
    UART(INTENSET) = INT_RXDRDY | INT_TXDRDY | INT_ERROR;
    NVIC_ISER = 1u << UART_INTERRUPT;
    return true;
}
