/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_AVR_PORT_H
#define FATHOM_AVR_PORT_H

/* The declarations that the files of this port share. */

#include <avr/interrupt.h>
#include <avr/io.h>
#include <stdint.h>

#include "../fathom_avr.h"

#if F_CPU != 16000000UL && F_CPU != 8000000UL
#error "F_CPU is to be 16000000UL or 8000000UL: Timer1 divides it by 8 and has to count 0.5 or 1 us"
#endif

enum { FATHOM_AVR_TICKS_PER_US = F_CPU / 8000000UL }; /* of Timer1 */

/* clock.c, which is always linked, defines these for idle.c. */
extern volatile uint8_t
    fathom_avr_happened; /* An interrupt has happened for which the main loop may be waiting. */
/* The indices of the ring in usart0.c. While they differ, bytes wait. */
extern volatile uint8_t fathom_avr_rx_in;
extern volatile uint8_t fathom_avr_rx_out;

/* Returns the clock at the time when Timer1 was at `ticks`. That was less than half a period ago, and interrupts are
 * disabled. */
uint32_t fathom_avr_stamp_us(uint16_t ticks);

#endif
