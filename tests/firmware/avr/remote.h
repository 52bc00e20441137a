/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_AVR_REMOTE_H
#define FATHOM_TEST_AVR_REMOTE_H

#include "board.h"
#include "remote_calls.h"

/*
 * The image "remote" calls a function of the port when it is told to, so that a test can go through the port step by
 * step, with the processor running on in between. Each of these takes some hundred cycles of simulated time.
 * The driver-enable pin is PD3, another output is PD4; a request may have REMOTE_REQUEST bytes.
 */
void remote_start(void);

/* fathom_avr_usart0_init, with a driver-enable pin or none, and memory for so many bytes. */
bool remote_begin(const fathom_line_settings_t *line, bool driver, uint8_t request_size);
int remote_read(uint8_t *bytes, uint8_t capacity, uint8_t *flags);
int remote_write(const uint8_t *bytes, uint8_t length);
bool remote_sent(void);
uint32_t remote_leaves_in_us(void);
int remote_set_line(const fathom_line_settings_t *line);
int remote_set_break(bool on);
void remote_idle(uint32_t max_us);

/* Begins or ends to read the clock over and over, each time after `masked` * 1024 cycles with interrupts off (0: they
 * stay on). A REMOTE_MARK record comes just before each reading, and a REMOTE_CLOCK record with its 4 bytes after
 * it. */
void remote_watch_clock(bool on, uint8_t masked);

/* Begins a call and does not wait for its end. REMOTE_READ and REMOTE_PIN make a REMOTE_MARK record just before they
 * call the port. */
volatile remote_t *remote_call(uint8_t call);

#endif
