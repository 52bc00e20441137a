/* SPDX-License-Identifier: MIT */
#ifndef LOOPBACK_H
#define LOOPBACK_H

#include "fathom/hal.h"

/* A UART whose TX is joined with its RX, in memory, and a clock that counts how often it was looked at. */
extern const fathom_clock_t loopback_clock;
extern const fathom_uart_t loopback_uart;
void loopback_begin(void);

#endif
