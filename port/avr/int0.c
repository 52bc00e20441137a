/* SPDX-License-Identifier: MIT */
/* Edges of pin INT0 (PD2) by its interrupt. The time of an edge is the time at which the interrupt runs. */
#include "internal/avr_port.h"

static fathom_edges_t *volatile seen; /* volatile: it is stored before the interrupt is enabled */

ISR(INT0_vect)
{
    const uint16_t ticks = TCNT1; /* The time is read first. */
    fathom_edges_feed(seen, (PIND & _BV(PIND2)) != 0, fathom_avr_stamp_us(ticks));
    fathom_avr_happened = 1;
}

void fathom_avr_int0_init(fathom_edges_t *edges)
{
    EIMSK &= (uint8_t)~_BV(INT0); /* A pointer is stored in two halves. */
    seen = edges;
    DDRD &= (uint8_t)~_BV(DDD2);
    EICRA = (uint8_t)((EICRA & ~(_BV(ISC01) | _BV(ISC00))) | _BV(ISC00)); /* both edges */
    EIFR = _BV(INTF0);
    EIMSK |= _BV(INT0);
}
