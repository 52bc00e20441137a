/* SPDX-License-Identifier: MIT */
#ifndef RP2040_DMA_UART_H
#define RP2040_DMA_UART_H

#include "fathom_rp2040.h"

/*
 * A line that is only listened to, received by DMA: no interrupt a byte, and every silence is known, however slow the
 * loop. The DMA moves each byte and its error bits from the UART to a ring.
 *
 * The UART has no idle-line interrupt. Its receive time-out cannot stand for one: it comes only while bytes wait in the
 * FIFO, and the DMA leaves none there. So a start bit, by the interrupt of the pin, sets an alarm, which looks again
 * every 32 bits; when neither a byte nor an edge has come in between, the line is silent, and the place in the ring and
 * the time are noted. Three or four interrupts a frame, and none in silence. Where there is an idle-line interrupt
 * (STM32), it takes the place of both. The three interrupts may have any priorities.
 */
enum {
    /* Bytes that wait for the main loop. A power of two: the DMA's addresses wrap by it. */
    DMA_UART_RING = 64,
    /* Silences that are remembered; older ones are forgotten. A power of two. */
    DMA_UART_MARKS = 16
};

/* Read at every call; it outlives the use. */
typedef struct {
    fathom_rp2040_wiring_t wiring; /* without a driver; the alarm is used here */
    fathom_line_settings_t line;
    uint8_t channel; /* 0..11, used for nothing else */
    /* Woken when the line falls silent; the looks before that wake the core as well. NULL: none. */
    fathom_rp2040_idle_t *idle;
} dma_uart_config_t;

typedef struct {
    uint32_t at;      /* so many bytes came before it */
    uint32_t last_us; /* when the last of them had come, and up to 32 bits later */
} dma_uart_mark_t;

typedef struct {
    uint32_t errors;   /* bytes with wrong parity or without a stop bit */
    uint32_t overruns; /* times that the main loop came too late */

    const dma_uart_config_t *config;
    uint32_t look_us;
    volatile uint32_t before; /* bytes of the transfers that have ended, and a mark */
    uint32_t taken;           /* bytes so far; wraps */
    uint32_t seen;            /* bytes at the last look */
    uint32_t seen_us;
    bool is_after_silence; /* what comes next */
    uint8_t marks_taken;   /* so far; wraps */
    volatile uint8_t marked;
    volatile dma_uart_mark_t marks[DMA_UART_MARKS];
    volatile uint16_t ring[DMA_UART_RING] __attribute__((aligned(2 * DMA_UART_RING)));
} dma_uart_t;

/* Begins to receive; enables DMA_IRQ_0, IO_IRQ_BANK0 and the alarm's. false: as fathom_rp2040_uart_setup. */
bool dma_uart_begin(dma_uart_t *uart, const dma_uart_config_t *config);

/* It only reads: write, sent, set_line and set_break are NULL, which a line without transactions never calls. */
fathom_uart_t dma_uart(dma_uart_t *uart);

void dma_uart_ended(dma_uart_t *uart); /* for DMA_IRQ_0 */
void dma_uart_edge(dma_uart_t *uart);  /* for IO_IRQ_BANK0 */
void dma_uart_look(dma_uart_t *uart);  /* for TIMER_IRQ_n of its alarm */

#endif
