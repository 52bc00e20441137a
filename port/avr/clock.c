/* SPDX-License-Identifier: MIT */
/*
 * The clock: Timer1 counts ticks, and its overflow interrupt counts periods. This file also has the flags that idle.c
 * reads, because the clock is always linked.
 */
#include "internal/avr_port.h"

#define PERIOD_US (65536UL / FATHOM_AVR_TICKS_PER_US)

volatile uint8_t fathom_avr_happened;
volatile uint8_t fathom_avr_rx_in;
volatile uint8_t fathom_avr_rx_out;

static volatile uint32_t periods_us; /* The clock when Timer1 was last 0. */

ISR(TIMER1_OVF_vect) { periods_us += PERIOD_US; }

void fathom_avr_clock_init(void)
{
    TCCR1A = 0; /* Timer1 counts to 65535 and drives no pin. */
    TCCR1B = _BV(CS11);
    TCNT1 = 0;
    TIFR1 = _BV(TOV1);
    TIMSK1 |= _BV(TOIE1);
}

uint32_t fathom_avr_stamp_us(uint16_t ticks)
{
    uint32_t us = periods_us;
    /* If an overflow waits for its interrupt, it came before a small count and after a large one. */
    if (((TIFR1 & _BV(TOV1)) != 0) && (ticks < 0x8000)) us += PERIOD_US;
    return us + (ticks / FATHOM_AVR_TICKS_PER_US);
}

static uint32_t now_us(void *ctx)
{
    (void)ctx;
    const uint8_t sreg = SREG;
    cli(); /* TCNT1 is read in two halves by a register that interrupts use too. */
    const uint32_t us = fathom_avr_stamp_us(TCNT1);
    SREG = sreg;
    return us;
}

const fathom_clock_t fathom_avr_clock = {now_us, NULL};
