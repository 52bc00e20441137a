/* SPDX-License-Identifier: MIT */
/*
 * Edges of pin ICP1 (PB0) by the input capture of Timer1. The hardware stores the time of each edge; the interrupt
 * feeds it to edges.h.
 */
#include "internal/avr_port.h"

static fathom_edges_t *captured;

/* The other edge next. A change of the edge may set the flag (ATmega328P, 16.6.3). */
static void turn(void)
{
    TCCR1B ^= _BV(ICES1);
    TIFR1 = _BV(ICF1);
}

ISR(TIMER1_CAPT_vect)
{
    const uint16_t ticks = ICR1;
    const bool rose = (TCCR1B & _BV(ICES1)) != 0;
    turn();
    fathom_edges_feed(captured, rose, fathom_avr_stamp_us(ticks));
    /* The pin may have changed back before the edge was turned. Nothing was captured then, and the time of that edge
     * is known to the length of this interrupt; without it the next one would be taken for it. */
    const bool high = (PINB & _BV(PINB0)) != 0;
    if ((high != rose) && ((TIFR1 & _BV(ICF1)) == 0)) {
        turn();
        fathom_edges_feed(captured, high, fathom_avr_stamp_us(TCNT1));
    }
    fathom_avr_happened = 1;
}

void fathom_avr_icp1_init(fathom_edges_t *edges)
{
    DDRB &= (uint8_t)~_BV(DDB0);
    const uint8_t sreg = SREG;
    cli();
    captured = edges; /* a pointer is stored in halves */
    TCCR1B |= _BV(ICNC1) | _BV(ICES1);
    if ((PINB & _BV(PINB0)) != 0)
        TCCR1B &= (uint8_t)~_BV(ICES1); /* in a pulse: its end, which counts for nothing */
    TIFR1 = _BV(ICF1);
    TIMSK1 |= _BV(ICIE1);
    SREG = sreg;
}
