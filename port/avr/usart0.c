/* SPDX-License-Identifier: MIT */
/*
 * USART0 with its three interrupts, and the driver enable of an RS-485 transceiver. The receive interrupt fills a ring,
 * the main loop reads it, and two interrupts send the request.
 */
#include "internal/avr_port.h"

/*
 * The ring has the bytes that wait for the main loop, each followed by the UCSR0A with which it arrived. The interrupt
 * is the only writer and the main loop the only reader. The indices fathom_avr_rx_in and fathom_avr_rx_out count by two
 * and are one byte each, so no access reads a half-changed index. One place stays free.
 */
#define RING  (2 * FATHOM_AVR_RX_RING)
#define ERROR (_BV(FE0) | _BV(DOR0) | _BV(UPE0))

static volatile uint8_t ring[RING];
static volatile uint8_t dropped; /* DOR0 if a byte found no place; the next byte in the ring reports it */

static uint8_t *request_memory;
static uint8_t request_size;
static fathom_avr_pin_t driver;
static const uint8_t *volatile next; /* next byte of the request */
static volatile uint8_t left;        /* number of its bytes that UDR0 has not got */
static volatile bool sending;        /* true until its last stop bit has left */
static bool in_break;
static fathom_line_settings_t line; /* the settings that are in force */
static uint16_t character_us;       /* time of a character, rounded up */

fathom_avr_usart_counters_t fathom_avr_usart0_counters;

/*
 * Stores a received byte. This interrupt comes with every byte, so it is written by hand: it takes 58 cycles with the
 * jump to it, and 59 if there is no place; avr-gcc 5.4 needs 77. In C it would be
 *     ring[in] = UDR0, ring[in + 1] = UCSR0A | dropped;      (UCSR0A is read first: ATmega328P, 20.7.3)
 *     after = (in + 2) % RING;
 *     if (after == out) dropped = DOR0; else in = after, dropped = 0;
 */
ISR(USART_RX_vect, ISR_NAKED)
{
    __asm__ volatile(
        "push r24\n\t"
        "in   r24, %[sreg]\n\t"
        "push r24\n\t"
        "push r25\n\t"
        "push r30\n\t"
        "push r31\n\t"
        "lds  r24, %[state]\n\t"
        "lds  r25, %[dropped]\n\t"
        "or   r24, r25\n\t"
        "lds  r25, %[data]\n\t"
        "lds  r30, %[in]\n\t"
        "ldi  r31, 0\n\t"
        "subi r30, lo8(-(%[ring]))\n\t"
        "sbci r31, hi8(-(%[ring]))\n\t"
        "st   Z+, r25\n\t"
        "st   Z, r24\n\t"
        "lds  r24, %[in]\n\t"
        "subi r24, -2\n\t"
        "andi r24, %[mask]\n\t"
        "lds  r25, %[out]\n\t"
        "cp   r24, r25\n\t"
        "breq 2f\n\t"
        "sts  %[in], r24\n\t"
        "ldi  r24, 0\n\t"
        "1:\n\t"
        "sts  %[dropped], r24\n\t"
        "pop  r31\n\t"
        "pop  r30\n\t"
        "pop  r25\n\t"
        "pop  r24\n\t"
        "out  %[sreg], r24\n\t"
        "pop  r24\n\t"
        "reti\n\t"
        "2:\n\t"
        "ldi  r24, %[lost]\n\t"
        "rjmp 1b\n\t"
        :
        : [sreg] "I"(_SFR_IO_ADDR(SREG)), [state] "n"(_SFR_MEM_ADDR(UCSR0A)), [data] "n"(_SFR_MEM_ADDR(UDR0)),
          [ring] "i"(ring), [dropped] "i"(&dropped), [in] "i"(&fathom_avr_rx_in),
          [out] "i"(&fathom_avr_rx_out), [mask] "n"(RING - 1), [lost] "n"(_BV(DOR0)));
}

static void drive(bool on)
{
    volatile uint8_t *port = driver.port;
    if (port != NULL) *port = (uint8_t)(on ? (*port | driver.mask) : (*port & ~driver.mask));
}

/* UDR0 has space for a byte. */
ISR(USART_UDRE_vect)
{
    UDR0 = *next;
    /* If a transmit complete is pending now, this byte came too late and there was a gap. The flag is cleared, so that
     * the driver stays enabled. It is cleared after the store to UDR0, because the byte before may end directly before
     * that store. The error bits of the receiver are written as 0 and stay. */
    UCSR0A = (uint8_t)((UCSR0A & _BV(U2X0)) | _BV(TXC0));
    next++;
    if (--left == 0) UCSR0B &= (uint8_t)~_BV(UDRIE0);
}

/* The last stop bit has left. If the whole request was sent, the driver is disabled. */
ISR(USART_TX_vect)
{
    if (left != 0) return;
    drive(false);
    sending = false;
    fathom_avr_happened = 1;
}

static void count(uint8_t state, uint8_t bit, uint16_t *counter)
{
    if (((state & bit) != 0) && (*counter != UINT16_MAX)) ++*counter;
}

static uint8_t flags_of(uint8_t state)
{
    count(state, _BV(UPE0), &fathom_avr_usart0_counters.parity);
    count(state, _BV(FE0), &fathom_avr_usart0_counters.framing);
    count(state, _BV(DOR0), &fathom_avr_usart0_counters.overruns);
    return (uint8_t)((((state & _BV(UPE0)) != 0) ? FATHOM_RX_PARITY : 0) |
                     (((state & _BV(FE0)) != 0) ? FATHOM_RX_FRAMING : 0) |
                     (((state & _BV(DOR0)) != 0) ? FATHOM_RX_OVERRUN : 0));
}

static int usart_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    (void)ctx;
    size_t count = 0;
    uint8_t out = fathom_avr_rx_out;
    while ((count != capacity) && (out != fathom_avr_rx_in)) {
        const uint8_t state = ring[out + 1] & ERROR;
        if ((state != 0) && (count != 0)) break; /* The next call returns it. */
        bytes[count] = ring[out];
        count++;
        out = (uint8_t)(out + 2) & (RING - 1);
        if (state == 0) continue;
        rx->flags |= flags_of(state);
        break;
    }
    fathom_avr_rx_out = out;
    return (int)count;
}

static int usart_write(void *ctx, const uint8_t *bytes, size_t length)
{
    (void)ctx;
    if ((length - 1) >= request_size) return -1; /* 0 wraps, so it is refused too. */
    if (sending || in_break) return 0;
    for (size_t i = 0; i != length; i++) request_memory[i] = bytes[i];
    next = request_memory;
    left = (uint8_t)length;
    sending = true;
    const uint8_t sreg = SREG;
    cli();
    drive(true);
    UCSR0B |= _BV(UDRIE0);
    SREG = sreg;
    return (int)length;
}

static bool usart_sent(void *ctx)
{
    (void)ctx;
    return !sending;
}

/* UDR0 and the shift register hold two more bytes, from the end of `write` on. */
static uint32_t usart_leaves_in_us(void *ctx)
{
    (void)ctx;
    if (!sending) return 0;
    return (uint32_t)(left + 2u) * character_us;
}

static uint32_t difference(uint32_t a, uint32_t b)
{
    if (a > b) return a - b;
    return b - a;
}

/* Returns UBRR0 + 1 with U2X0 set. Returns 0 if the rate cannot be reached within 2.5 %, or if the hardware does not
 * have these settings. */
static uint16_t divisor_of(const fathom_line_settings_t *settings)
{
    const uint32_t eighth = F_CPU / 8;
    const uint32_t baud = settings->baud;
    if ((baud == 0) || (baud > eighth) || (settings->parity > FATHOM_PARITY_ODD) ||
        (settings->stop_bits < 1) || (settings->stop_bits > 2))
        return 0;
    const uint32_t divisor = (eighth + (baud / 2)) / baud;
    if (divisor > 4096) return 0;
    const uint32_t product = divisor * baud;
    const uint32_t off = difference(product, eighth);
    return ((off * 40) > product) ? 0 : (uint16_t)divisor; /* compares F_CPU / 8 / divisor with baud */
}

static void set(const fathom_line_settings_t *settings, uint16_t divisor)
{
    /* Without U2X0 the receiver samples each bit twice as often, so U2X0 is set only for an odd divisor. */
    const bool twice = (divisor % 2) != 0;
    UBRR0 = (uint16_t)((twice ? divisor : (divisor / 2)) - 1);
    UCSR0A = twice ? _BV(U2X0) : 0;
    UCSR0C = (uint8_t)(_BV(UCSZ01) | _BV(UCSZ00) | ((settings->stop_bits == 2) ? _BV(USBS0) : 0) |
                       ((settings->parity == FATHOM_PARITY_NONE)   ? 0
                        : (settings->parity == FATHOM_PARITY_EVEN) ? _BV(UPM01)
                                                                   : (_BV(UPM01) | _BV(UPM00))));
    line = *settings;
    const uint8_t bits = fathom_character_bits(&line);
    character_us = (uint16_t)(((bits * 1000000u) + line.baud - 1) / line.baud);
}

static int usart_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    (void)ctx;
    if ((settings->baud == line.baud) && (settings->parity == line.parity) &&
        (settings->stop_bits == line.stop_bits))
        return 1;
    const uint16_t divisor = divisor_of(settings);
    if (divisor == 0) return -1;
    if (sending) return 0;
    set(settings, divisor);
    return 1;
}

static int usart_set_break(void *ctx, bool on)
{
    (void)ctx;
    if (sending) return 0;
    const uint8_t sreg = SREG;
    cli();
    drive(on);
    if (on) {
        PORTD &= (uint8_t)~_BV(PORTD1);
        DDRD |= _BV(DDD1);
        UCSR0B &= (uint8_t)~_BV(TXEN0);
    } else {
        UCSR0B |= _BV(TXEN0);
        PORTD |= _BV(PORTD1);
    }
    SREG = sreg;
    in_break = on;
    return 1;
}

const fathom_uart_t fathom_avr_usart0 = {
    .read = usart_read,
    .write = usart_write,
    .sent = usart_sent,
    .set_line = usart_set_line,
    .set_break = usart_set_break,
    .leaves_in_us = usart_leaves_in_us,
};

bool fathom_avr_usart0_init(const fathom_avr_usart_config_t *config)
{
    const uint16_t divisor = divisor_of(&config->line);
    if ((config->request == NULL) || (config->request_size == 0) || (divisor == 0)) return false;
    UCSR0B = 0;
    request_memory = config->request;
    request_size = config->request_size;
    driver = config->driver;
    set(&config->line, divisor);
    if (driver.port != NULL) {
        drive(false);
        driver.port[-1] |= driver.mask; /* DDRx stands before PORTx */
    }
    left = 0;
    sending = in_break = false;
    dropped = 0;
    fathom_avr_rx_out = fathom_avr_rx_in = 0;
    PORTD |= _BV(
        PORTD0); /* RXD gets a pull-up, because a transceiver with its receiver disabled does not drive it. */
    UCSR0B = _BV(RXCIE0) | _BV(TXCIE0) | _BV(RXEN0) | _BV(TXEN0);
    return true;
}
