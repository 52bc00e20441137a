/* SPDX-License-Identifier: MIT */
/* What the bench itself is tested with (../test_avr_bench.c): instructions whose cycles the instruction set manual
 * has. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

void forty_cycles(void);
void three_pushes(void);

/* 36 + ret 4 */
__attribute__((naked, noinline)) void forty_cycles(void)
{
    __asm__ volatile(".rept 36\n\tnop\n\t.endr\n\tret");
}

/* push 2 three times, rcall 3 + 40, pop 2 three times, ret 4: 59; stack 2 + 3 + 2 */
__attribute__((naked, noinline)) void three_pushes(void)
{
    __asm__ volatile(
        "push r0\n\tpush r0\n\tpush r0\n\trcall forty_cycles\n\tpop r0\n\tpop r0\n\tpop r0\n\tret");
}

/* jmp 3, 11 nops, reti 4: 18 */
ISR(INT0_vect, ISR_NAKED) { __asm__ volatile(".rept 11\n\tnop\n\t.endr\n\treti"); }

/* Begins by letting others in: jmp 3, sei 1, 40 nops, reti 4: 48 */
ISR(INT1_vect, ISR_NAKED) { __asm__ volatile("sei\n\t.rept 40\n\tnop\n\t.endr\n\treti"); }

/* Leaves the byte where it is for 3 rounds: receive complete stands as long as it does. */
static volatile uint8_t rounds;
ISR(USART_RX_vect)
{
    if (++rounds < 3) return;
    GPIOR0 = UCSR0A;
    GPIOR0 = UDR0;
    GPIOR1 = 'r';
}

static void send(uint8_t byte)
{
    while ((UCSR0A & _BV(UDRE0)) == 0) continue;
    UDR0 = byte;
    GPIOR1 = 'd';
}

int main(void)
{
    EICRA = _BV(ISC00) | _BV(ISC10);
    EIMSK = _BV(INT0) | _BV(INT1);
    DDRB = _BV(PORTB1);
    PORTB = _BV(PORTB1) | _BV(PORTB0);
    UBRR0 = 103;
    UCSR0B = _BV(TXEN0) | _BV(RXEN0);
    sei();
    GPIOR1 = '1';
    for (uint8_t i = 0; i < 5; i++) {
        forty_cycles();
        three_pushes();
    }
    GPIOR1 = '2';
    __asm__ volatile(".rept 400\n\tnop\n\t.endr");

    send(0x41); /* into the shift register */
    send(0x42); /* into UDR0, at once */
    send(0x43); /* when the first is out */
    while ((UCSR0A & _BV(TXC0)) == 0) continue;
    GPIOR1 = 't';

    GPIOR1 = '3'; /* bytes come here that are not read */
    while ((PIND & _BV(PIND4)) == 0) continue;
    while ((UCSR0A & _BV(RXC0)) != 0) {
        GPIOR0 = UCSR0A;
        GPIOR0 = UDR0;
    }
    GPIOR1 = 'b';
    UCSR0B |= _BV(RXCIE0);

    /* A pulse of 2 ms, then the levels of B0 and D2 whenever one changes. */
    PORTB &= (uint8_t)~_BV(PORTB1);
    for (uint16_t i = 0; i < 8000; i++) __asm__ volatile("nop");
    PORTB |= _BV(PORTB1);
    uint8_t was = 0xFF;
    while ((PIND & _BV(PIND4)) != 0) {
        const uint8_t is = (uint8_t)((PINB & _BV(PINB0)) | (PIND & _BV(PIND2)));
        if (is == was) continue;
        GPIOR0 = is;
        GPIOR1 = 'p';
        was = is;
    }
    SMCR = _BV(SE);
    sleep_cpu();
    GPIOR2 = 7;
    for (;;) {
    }
}
