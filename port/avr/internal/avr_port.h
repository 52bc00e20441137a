/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_AVR_PORT_H
#define FATHOM_AVR_PORT_H

/* What the sources of this port share. */

#include <avr/interrupt.h>
#include <avr/io.h>
#include <stdint.h>

#include "../fathom_avr.h"

#if F_CPU != 16000000UL && F_CPU != 8000000UL
#error "F_CPU is to be 16000000UL or 8000000UL: Timer1 divides it by 8 and has to count 0.5 or 1 us"
#endif

enum { FATHOM_AVR_TICKS_PER_US = F_CPU / 8000000UL }; /* of Timer1 */

/* For idle.c, in clock.c, which is always linked. */
extern volatile uint8_t fathom_avr_happened; /* an interrupt that the main loop may be waiting for */
/* Of usart0.c; bytes wait while they differ. */
extern volatile uint8_t fathom_avr_rx_in;
extern volatile uint8_t fathom_avr_rx_out;

/* The clock when Timer1 stood at `ticks`, which was less than half its period ago. Interrupts are off. */
uint32_t fathom_avr_stamp_us(uint16_t ticks);

#endif
