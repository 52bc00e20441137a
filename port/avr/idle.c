/* SPDX-License-Identifier: MIT */
/* The sleep of the main loop, in idle mode. Compare match B of Timer1 ends it when the time has passed. */
#include "internal/avr_port.h"

#include <avr/sleep.h>

/* Limits of a sleep in ticks of Timer1. MOST is less than a period by more than the time that falling asleep takes;
 * LEAST is more than that time. */
#define MOST  65000u
#define LEAST 40u

static volatile uint8_t time_is_up;

ISR(TIMER1_COMPB_vect) { time_is_up = 1; }

static bool is_to_sleep(bool bytes_wake)
{
    return (fathom_avr_happened == 0) && (time_is_up == 0) &&
           (!bytes_wake || (fathom_avr_rx_in == fathom_avr_rx_out));
}

/* Sleeps. Returns true if nothing but the time, or bytes if `bytes_wake`, has ended the sleep. */
static bool doze(uint32_t max_us, bool bytes_wake)
{
    const uint16_t ticks =
        (max_us < (MOST / FATHOM_AVR_TICKS_PER_US)) ? (uint16_t)(max_us * FATHOM_AVR_TICKS_PER_US) : MOST;
    cli();
    time_is_up = ticks < LEAST; /* A match that is this near might be missed. */
    OCR1B = (uint16_t)(TCNT1 + ticks);
    TIFR1 = _BV(OCF1B);
    TIMSK1 |= _BV(OCIE1B);
    SMCR = _BV(SE); /* In idle mode the timers and the USART continue. */
    while (is_to_sleep(bytes_wake)) {
        sei(); /* The next instruction runs before any interrupt, so no interrupt is missed. */
        sleep_cpu();
        cli();
    }
    SMCR = 0;
    TIMSK1 &= (uint8_t)~_BV(OCIE1B);
    const bool has_happened = fathom_avr_happened != 0;
    fathom_avr_happened = 0;
    sei();
    return !has_happened;
}

void fathom_avr_idle(void *ctx, uint32_t max_us)
{
    const uint16_t *const gather_us = ctx;
    if ((gather_us != NULL) && (*gather_us != 0)) {
        const uint32_t first_us = (*gather_us < max_us) ? *gather_us : max_us;
        if (!doze(first_us, false)) return;
        max_us -= first_us;
    }
    (void)doze(max_us, true);
}
