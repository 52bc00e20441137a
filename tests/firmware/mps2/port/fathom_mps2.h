/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MPS2_H
#define FATHOM_MPS2_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"
#include "fathom_serial.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The HAL on Arm's MPS2 board with a Cortex-M3 (AN385), on bare registers: five serial lines at once. It runs on
 * QEMU's mps2-an385, where the tests run it. Not seen on the board.
 *
 *   clock.c   the counter of FPGAIO                       no interrupt
 *   uart.c    CMSDK APB UART 0..4, RX and TX interrupts   fathom_uart_t
 *   idle.c    CMSDK timer 0 and its interrupt             sleep until bytes come or time is up
 *
 * These UARTs have 8 data bits, one stop bit and NO parity, and report no framing errors. An HPS-167S, which speaks
 * 19200 8E1 from the factory, cannot be on such a UART; in front of QEMU it can, since no bits are there.
 * Registers: "Cortex-M System Design Kit Technical Reference Manual" (DDI 0479), "AN385".
 * All functions but the interrupts belong to the main loop.
 */

#define FATHOM_MPS2_HZ 25000000u /* the clock of the core and of its peripherals (AN385 3.4) */

/* The counter runs from here on, from 0, in us; it wraps at 2^32 by itself. Called before all the others. */
void fathom_mps2_clock_begin(void);
extern const fathom_clock_t fathom_mps2_clock;

/* Read by begin only. */
typedef struct {
    /* memory for the longest request; outlives the use of the UART. 8 bytes for all reads and single writes */
    uint8_t *request;
    uint8_t request_size;        /* 1..255 */
    uint8_t number;              /* 0..4 */
    fathom_line_settings_t line; /* to begin with */
} fathom_mps2_uart_config_t;

/* The port's; `serial` has counters that the caller may read. */
typedef struct {
    fathom_serial_t serial;
    volatile uint32_t *registers;
    uint32_t baud;
    volatile uint32_t taken_us; /* the last byte went from the buffer to the wire */
    bool is_sending;            /* as `sent` has seen it */
} fathom_mps2_uart_t;

/*
 * Makes it ready and enables its two interrupts in the NVIC. Where a table of AN385 has no such UART, or the settings
 * cannot be reached, or there is no memory for a request: false, and nothing has changed.
 */
bool fathom_mps2_uart_begin(fathom_mps2_uart_t *uart, const fathom_mps2_uart_config_t *config);

/* For both interrupts of this UART: 0 and 1 of UART 0, 2 and 3 of 1, 4 and 5 of 2, 18 and 19 of 3, 20 and 21 of 4. */
void fathom_mps2_uart_interrupt(fathom_mps2_uart_t *uart);

/*
 * By value; it points to `uart`. FATHOM_RX_OVERRUN is reported; there is no FATHOM_RX_TIMED, no FATHOM_RX_SILENCE.
 * write      takes 1 to request_size bytes; of none or more it returns < 0. It begins with the first byte at once.
 * sent       one character of time after the last byte has left the buffer: no flag shows more. Up to one character
 *            late.
 * set_line   8N1, the clock divided by 16 or more: 24..1562500 baud, within 2.5 %; < 0 beyond, and for parity or 2 stop
 *            bits.
 * set_break  NULL: it has none. An RS-485 transceiver has to switch over by itself.
 */
fathom_uart_t fathom_mps2_uart(fathom_mps2_uart_t *uart);

/* Which UARTs end a sleep. The caller's, and outlives the sleep. */
typedef struct {
    const fathom_mps2_uart_t *uarts;
    uint8_t count;
} fathom_mps2_idle_t;

/*
 * For fathom_wait, or a main loop that has nothing to do: sleeps (WFI) until an interrupt has run or max_us have
 * passed, and returns; at once if a byte waits already. A byte that comes while it goes to sleep wakes it. At most
 * 100 s in one call. ctx: a fathom_mps2_idle_t. Interrupts are enabled afterwards.
 */
void fathom_mps2_idle(void *ctx, uint32_t max_us);

/* For interrupt 8, which idle enables. */
void fathom_mps2_timer0_interrupt(void);

#ifdef __cplusplus
}
#endif

#endif
