/* SPDX-License-Identifier: MIT */
/* board_print() at PB2, 9600 8N1. The line has the only UART of the chip, so software makes the bits. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/pgmspace.h>
#include <util/delay.h>

#include "../../avr/text.h"
#include "board.h"

/* Start bit, 8 bits, stop bit. An interrupt within a bit would stretch it. */
static void put(uint8_t byte)
{
    const uint8_t flags = SREG;
    cli();
    for (uint16_t bits = (uint16_t)byte << 1 | 0x200; bits != 0; bits >>= 1) {
        if (bits & 1)
            PORTB |= _BV(PB2);
        else
            PORTB &= (uint8_t)~_BV(PB2);
        _delay_us(103.5);
    }
    SREG = flags;
}

void board_print(fathom_status_t status, const fathom_sample_t *sample)
{
    text_t text = {0};
    if (status == FATHOM_OK)
        text_sample(&text, sample);
    else
        text_error(&text, status);
    text_say(&text, PSTR("\r\n"));
    PORTB |= _BV(PB2);
    DDRB |= _BV(PB2);
    for (uint8_t i = 0; i != text.length; i++) put(text.bytes[i]);
}
