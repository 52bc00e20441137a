/* SPDX-License-Identifier: MIT */
#include "inside.h"

#include <avr/sleep.h>

/* In ticks of Timer1: less than a period by what it takes to get to sleep, and more than that. */
#define MOST  65000u
#define LEAST 40u

static volatile uint8_t time_is_up;

ISR(TIMER1_COMPB_vect) { time_is_up = 1; }

static bool is_to_sleep(void)
{
    return fathom_avr_happened == 0 && time_is_up == 0 && fathom_avr_rx_in == fathom_avr_rx_out;
}

void fathom_avr_idle(void *ctx, uint32_t max_us)
{
    (void)ctx;
    const uint16_t ticks =
        max_us < MOST / FATHOM_AVR_TICKS_PER_US ? (uint16_t)(max_us * FATHOM_AVR_TICKS_PER_US) : MOST;
    cli();
    time_is_up = ticks < LEAST; /* a match that is so near might be missed */
    OCR1B = (uint16_t)(TCNT1 + ticks);
    TIFR1 = _BV(OCF1B);
    TIMSK1 |= _BV(OCIE1B);
    SMCR = _BV(SE); /* idle mode: the timers and the USART go on */
    while (is_to_sleep()) {
        sei(); /* the instruction after it is carried out before any interrupt, so none is slept through */
        sleep_cpu();
        cli();
    }
    SMCR = 0;
    TIMSK1 &= (uint8_t)~_BV(OCIE1B);
    fathom_avr_happened = 0;
    sei();
}
