/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_AVR_USART_H
#define FATHOM_TEST_AVR_USART_H

#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"

/*
 * USART0 of the ATmega328P by its datasheet (section 20), in the place of simavr 1.6's own, which times every
 * character with a parity bit, has no second transmit buffer (so data register empty comes a character too late, and
 * transmit complete after every byte), a receive buffer of 64 bytes instead of 2, and never a parity error or an
 * overrun. Of simavr's the interrupts are used, and nothing else.
 *
 * Asynchronous, 8 data bits. Not modelled: the transmitter's wait for its bit clock (up to one bit) before a byte
 * that begins from idle; the half bit by which receive complete comes before the end of the stop bit; 9 bits, the
 * synchronous modes, the multi-processor mode.
 */
typedef struct {
    uint8_t byte;
    uint8_t state; /* FE0, DOR0 and UPE0, as UCSR0A shows them while the byte is next to be read */
} usart_frame_t;

enum { USART_BUFFER = 3 }; /* two in the receive buffer, one in the shift register until the next byte */

typedef struct {
    /* What the owner wants to know; set after usart_begin. Called in simulated time. */
    void (*byte_begins)(uint8_t byte, uint64_t begin_cycle, uint64_t end_cycle);
    void (*configured)(void); /* rate, parity, stop bits, or who has the pins */

    avr_t *avr;
    avr_uart_t *simavr; /* for its interrupts */

    /* transmitter */
    bool shifting; /* `shift` is on the wire */
    bool buffered; /* `buffer` waits in UDR0: data register not empty */
    uint8_t shift, buffer;
    uint64_t begin_cycle; /* of `shift` */
    uint64_t end_cycle;

    /* receiver */
    usart_frame_t frames[USART_BUFFER];
    uint8_t waiting;
    bool lost;         /* before the next frame */
    uint32_t overruns; /* frames lost because none was read in time */
} usart_t;

/* After avr_init. false: this simavr has no such USART. */
bool usart_begin(usart_t *usart, avr_t *avr);

/* A character has come whole; flags: FATHOM_RX_PARITY (means nothing where no parity is checked), FATHOM_RX_FRAMING,
 * FATHOM_RX_OVERRUN (one was lost before it). */
void usart_arrive(usart_t *usart, uint8_t byte, uint8_t flags);

/* The character that leaves ends now, whenever it began; false: none leaves. */
bool usart_hurry(usart_t *usart);

/* As the registers have it: the rate that they really make, to the nearest bit per second. */
fathom_line_settings_t usart_settings(const usart_t *usart);

uint32_t usart_character_cycles(const usart_t *usart);

/* Does the transmitter drive TXD (PD1)? */
bool usart_has_txd(const usart_t *usart);

/* Interrupts that follow a level are looked at again; after the return from one. */
void usart_refresh(usart_t *usart);

#endif
