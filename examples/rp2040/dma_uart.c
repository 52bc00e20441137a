/* SPDX-License-Identifier: MIT */
#include "dma_uart.h"

#include "internal/alarm.h"
#include "rp2040.h"

/* 2.5.7 DMA, of a channel: CTRL_TRIG and AL1_TRANS_COUNT_TRIG begin a transfer. And of interrupt 0. */
#define DMA_CHANNEL(number, offset)      RP2040_REGISTER(0x50000000u + 0x40u * (number) + (offset))
#define DMA_READ_ADDR(number)            DMA_CHANNEL(number, 0x00u)
#define DMA_WRITE_ADDR(number)           DMA_CHANNEL(number, 0x04u)
#define DMA_TRANS_COUNT(number)          DMA_CHANNEL(number, 0x08u)
#define DMA_CTRL_TRIG(number)            DMA_CHANNEL(number, 0x0Cu)
#define DMA_AL1_TRANS_COUNT_TRIG(number) DMA_CHANNEL(number, 0x1Cu)
#define DMA_INTE0                        RP2040_REGISTER(0x50000404)
#define DMA_INTS0                        RP2040_REGISTER(0x5000040C)

enum {
    CTRL_EN = 1 << 0,
    CTRL_HALFWORDS = 1 << 2,
    CTRL_INCR_WRITE = 1 << 5,
    CTRL_RING_SIZE = 7 << 6, /* 2^7 bytes: 64 halfwords */
    CTRL_RING_SEL_WRITE = 1 << 10,
    CTRL_CHAIN_TO = 11, /* shift; to itself: to none */
    CTRL_TREQ_SEL = 15, /* shift */
    DREQ_UART0_RX = 21, /* 2.5.3.1; UART1's is two further */
    UART_RXDMAE = 1,    /* UARTDMACR */
    RESETS_DMA = 1 << 2
};

enum {
    /* A transfer ends after so many bytes, and the next one begins. It could be 2^32 - 1 as well; then that would
     * happen for the first time after a month in the field. */
    TRANSFER = 1024,
    IDLE_BITS = 32, /* as the UART's own time-out has it: three characters */
    MARGIN = 4,     /* bytes that may come while the ring is read */
    /* In `before`, a multiple of TRANSFER: it has the bytes of a transfer already, and the next one has not begun. */
    BETWEEN = 1,
    ERRORS = RP2040_UART_DR_FE | RP2040_UART_DR_BE | RP2040_UART_DR_PE | RP2040_UART_DR_OE,
    US_PER_S = 1000000
};

static uint32_t now_us(void) { return fathom_rp2040_clock.now_us(fathom_rp2040_clock.ctx); }

/* All bytes so far; wraps. For the main loop and any interrupt, also one that comes within dma_uart_ended. */
static uint32_t count(const dma_uart_t *uart)
{
    uint32_t before;
    uint32_t left;
    do {
        before = uart->before;
        left = DMA_TRANS_COUNT(uart->config->channel);
    } while (before != uart->before); /* a transfer ended in between */
    if ((before & BETWEEN) == 0) return before + (TRANSFER - left);
    before -= BETWEEN;
    return left == 0 ? before : before + (TRANSFER - left);
}

void dma_uart_ended(dma_uart_t *uart)
{
    const uint32_t bit = UINT32_C(1) << uart->config->channel;
    if ((DMA_INTS0 & bit) == 0) return;
    DMA_INTS0 = bit;
    const uint32_t before = uart->before + TRANSFER;
    uart->before = before + BETWEEN;
    DMA_AL1_TRANS_COUNT_TRIG(uart->config->channel) = TRANSFER; /* goes on in the ring where it stands */
    uart->before = before;
}

/* ---- silence ---- */

static uint32_t falling(const dma_uart_t *uart)
{
    return (uint32_t)RP2040_IO_EDGE_LOW << (4u * (uart->config->wiring.rx % 8u));
}

static void look_later(const dma_uart_t *uart)
{
    fathom_rp2040_alarm_set(uart->config->wiring.alarm, uart->look_us);
}

void dma_uart_edge(dma_uart_t *uart)
{
    const unsigned rx = uart->config->wiring.rx;
    if ((RP2040_IO_PROC0_INTS(rx) & falling(uart)) == 0) return;
    rp2040_clear(&RP2040_IO_PROC0_INTE(rx), falling(uart));
    look_later(uart);
}

static void mark(dma_uart_t *uart, uint32_t at)
{
    const uint8_t marked = uart->marked;
    volatile dma_uart_mark_t *const next = &uart->marks[marked % DMA_UART_MARKS];
    next->at = at;
    next->last_us = uart->seen_us;
    uart->marked = (uint8_t)(marked + 1); /* now that it is there */
}

void dma_uart_look(dma_uart_t *uart)
{
    const unsigned rx = uart->config->wiring.rx;
    fathom_rp2040_alarm_clear(uart->config->wiring.alarm);
    /* The edges are forgotten before the bytes are counted: one that comes from here on is found by the next look, or
     * interrupts as soon as it may. */
    const bool has_fallen = (RP2040_IO_INTR(rx) & falling(uart)) != 0;
    RP2040_IO_INTR(rx) = falling(uart);
    const uint32_t at = count(uart);
    if (has_fallen || at != uart->seen) {
        uart->seen = at;
        uart->seen_us = now_us();
        look_later(uart);
        return;
    }
    mark(uart, at);
    rp2040_set(&RP2040_IO_PROC0_INTE(rx), falling(uart));
    if (uart->config->idle != NULL) uart->config->idle->has_news = true;
}

/* ---- the HAL's view ---- */

/* The oldest mark at `taken` or behind it; NULL: there is none. Of those that are remembered one may be written
 * anew. */
static const volatile dma_uart_mark_t *next_mark(dma_uart_t *uart)
{
    const uint8_t marked = uart->marked;
    if ((uint8_t)(marked - uart->marks_taken) >= DMA_UART_MARKS)
        uart->marks_taken = (uint8_t)(marked - (DMA_UART_MARKS - 1));
    for (; uart->marks_taken != marked; uart->marks_taken++) {
        const volatile dma_uart_mark_t *const next = &uart->marks[uart->marks_taken % DMA_UART_MARKS];
        const uint32_t passed = uart->taken - next->at;
        if (passed > INT32_MAX) return next;
        if (passed == 0) uart->is_after_silence = true;
    }
    return NULL;
}

static uint8_t flags_of(unsigned entry)
{
    unsigned flags = 0;
    if ((entry & (RP2040_UART_DR_FE | RP2040_UART_DR_BE)) != 0) flags |= FATHOM_RX_FRAMING;
    if ((entry & RP2040_UART_DR_PE) != 0) flags |= FATHOM_RX_PARITY;
    if ((entry & RP2040_UART_DR_OE) != 0) flags |= FATHOM_RX_OVERRUN;
    return (uint8_t)flags;
}

static int dma_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    dma_uart_t *const uart = ctx;
    uint32_t end = count(uart);
    uint32_t taken = uart->taken;
    if (end == taken) return 0;
    if (end - taken > DMA_UART_RING - MARGIN) {
        taken = end - (DMA_UART_RING - MARGIN);
        uart->taken = taken;
        uart->is_after_silence = false;
        uart->overruns++;
        rx->flags |= FATHOM_RX_OVERRUN;
    }
    const volatile dma_uart_mark_t *const next = next_mark(uart);
    const bool has_silence = next != NULL && next->at - taken <= end - taken;
    if (has_silence) end = next->at;
    if (uart->is_after_silence) rx->flags |= FATHOM_RX_SILENCE;
    uart->is_after_silence = false;

    int n = 0;
    while (taken != end && (size_t)n < capacity) {
        const unsigned entry = uart->ring[taken % DMA_UART_RING];
        const bool is_wrong = (entry & ERRORS) != 0;
        if (is_wrong && n != 0) break;
        bytes[n++] = (uint8_t)entry;
        taken++;
        if (is_wrong) {
            rx->flags |= flags_of(entry);
            uart->errors++;
            break;
        }
    }
    uart->taken = taken;
    if (has_silence && taken == end) {
        rx->flags |= FATHOM_RX_TIMED;
        rx->last_us = next->last_us;
    }
    return n;
}

fathom_uart_t dma_uart(dma_uart_t *uart)
{
    const fathom_uart_t hal = {.read = dma_read, .ctx = uart};
    return hal;
}

bool dma_uart_begin(dma_uart_t *uart, const dma_uart_config_t *config)
{
    const unsigned number = config->wiring.number;
    const unsigned alarm = config->wiring.alarm;
    const unsigned channel = config->channel;
    if (alarm >= FATHOM_RP2040_ALARMS || !fathom_rp2040_uart_setup(&config->wiring, &config->line))
        return false;
    rp2040_clear(&RP2040_RESETS_RESET, RESETS_DMA);
    while ((RP2040_RESETS_RESET_DONE & RESETS_DMA) == 0) { /* some cycles of clk_sys */
    }
    uart->config = config;
    uart->errors = uart->overruns = 0;
    uart->look_us = IDLE_BITS * US_PER_S / config->line.baud;
    uart->before = uart->taken = uart->seen = 0;
    uart->seen_us = now_us();
    uart->is_after_silence = false;
    uart->marks_taken = uart->marked = 0;

    RP2040_UART(number)->dmacr = UART_RXDMAE;
    DMA_READ_ADDR(channel) = (uint32_t)(uintptr_t)&RP2040_UART(number)->dr;
    DMA_WRITE_ADDR(channel) = (uint32_t)(uintptr_t)uart->ring;
    DMA_TRANS_COUNT(channel) = TRANSFER;
    DMA_CTRL_TRIG(channel) = CTRL_EN | CTRL_HALFWORDS | CTRL_INCR_WRITE | CTRL_RING_SIZE |
                             CTRL_RING_SEL_WRITE | channel << CTRL_CHAIN_TO |
                             (DREQ_UART0_RX + 2u * number) << CTRL_TREQ_SEL;
    rp2040_set(&DMA_INTE0, UINT32_C(1) << channel);
    fathom_rp2040_alarm_enable(alarm);
    look_later(uart); /* a silence from here on counts */
    RP2040_NVIC_ISER = UINT32_C(1) << RP2040_IRQ_DMA_0 | UINT32_C(1) << RP2040_IRQ_IO_BANK0;
    return true;
}
