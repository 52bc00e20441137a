/* SPDX-License-Identifier: MIT */
/*
 * Edges of pin ICP1 (PB0) by the input capture of Timer1. The hardware stores the time of each edge; the interrupt
 * feeds it to edges.h.
 */
#include "internal/avr_port.h"

static fathom_edges_t *captured;

/* Selects the other edge. The change may set the flag (ATmega328P, 16.6.3), so the flag is cleared afterwards. */
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
    /* The pin may have changed back before the other edge was selected. Nothing was captured then. The time of that
     * edge is known within the length of this interrupt. Without this edge, the next one would be mistaken for it. */
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
    captured = edges; /* A pointer is stored in two halves. */
    TCCR1B |= _BV(ICNC1) | _BV(ICES1);
    if ((PINB & _BV(PINB0)) != 0)
        TCCR1B &= (uint8_t)~_BV(ICES1); /* The pin is in a pulse. Its end is captured and does not count. */
    TIFR1 = _BV(ICF1);
    TIMSK1 |= _BV(ICIE1);
    SREG = sreg;
}
