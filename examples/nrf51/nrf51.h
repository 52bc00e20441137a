/* SPDX-License-Identifier: MIT */
#ifndef NRF51_H
#define NRF51_H

#include <stdint.h>

#include "fathom/hal.h"
#include "fathom_serial.h" /* Fathom's port/serial */

/*
 * A port of Fathom to the nRF51 that stands in no folder of Fathom's: written by port/README.md, for one sensor on the
 * only UART. It runs on QEMU's machine "microbit"; not seen on a chip. Sections are those of the nRF51 Series Reference
 * Manual 3.0.
 *
 *   clock.c   TIMER0, 32 bits at 1 MHz                     fathom_clock_t
 *   uart.c    UART0: RXDRDY, TXDRDY and ERROR events       fathom_uart_t
 *   idle.c    TIMER0's second compare register, WFI        fathom_idle_t
 */

/* The crystal oscillator, whose 16 MHz the baud rates are made of, and TIMER0. Waits until the crystal runs, less than
 * 2 ms. */
void nrf51_clock_begin(void);
extern const fathom_clock_t nrf51_clock;

/*
 * Pins of port 0, and what the line begins with. False, and nothing has changed: these settings cannot be reached.
 *
 * FATHOM_RX_PARITY, _FRAMING and _OVERRUN are told of single bytes. No driver-enable: the manual does not say where in
 * the stop bit TXDRDY comes, so `sent` turns true a character after the last one; take a transceiver that switches over
 * by itself. set_line: 9600 to 230400 baud by factors of 2 or 3, no parity or even, one stop bit: UART0 has no other.
 * No set_break.
 */
bool nrf51_uart_begin(uint8_t tx_pin, uint8_t rx_pin, const fathom_line_settings_t *line);
extern const fathom_uart_t nrf51_uart;
extern fathom_serial_t nrf51_serial; /* its counters */

enum { NRF51_LONGEST = 32 }; /* bytes of a request; every read and every single write have 8 */

/* Sleeps until an interrupt or for max_us; at once if a byte waits. ctx is not looked at. */
void nrf51_idle(void *ctx, uint32_t max_us);

/* start.c calls them. */
void nrf51_uart_interrupt(void);
void nrf51_timer_interrupt(void);

#endif
