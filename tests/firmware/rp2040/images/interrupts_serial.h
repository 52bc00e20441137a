/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_INTERRUPTS_SERIAL_H
#define FATHOM_TEST_INTERRUPTS_SERIAL_H

#include <stddef.h>

#include "fathom/hal.h"
#include "rp2040.h"

/* ../../../../port/serial, which the RP2040's own port does not use, on a PL011 without FIFOs: an interrupt for each byte
 * that has come, and for each that the next one may follow, as the machines of that folder have it. */
void serial_begin(rp2040_uart_t *hardware, const fathom_line_settings_t *line);
void serial_interrupt(rp2040_uart_t *hardware);
int serial_read(uint8_t *bytes, size_t capacity, fathom_rx_t *rx);
int serial_write(rp2040_uart_t *hardware, const uint8_t *bytes, size_t length);
uint32_t serial_leaves_in_us(void);

#endif
