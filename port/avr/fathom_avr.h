/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_AVR_H
#define FATHOM_AVR_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/edges.h"
#include "fathom/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The HAL on an ATmega328P (48, 88 and 168 are the same but for memory), on bare registers. What is used is linked,
 * with its interrupts, and nothing else:
 *
 *   clock.c   Timer1 and its overflow interrupt           the clock, from which all the times here are taken
 *   usart0.c  USART0 and its three interrupts             fathom_uart_t, with RS-485
 *   icp1.c    Timer1's input capture, pin ICP1 (PB0)      edges with the time of the hardware
 *   int0.c    INT0 (PD2)                                  edges with the time at which the interrupt ran
 *   idle.c    Timer1's compare match B                    sleep until bytes come or time is up
 *   pin.c                                                 triggers, selects, switch and relay contacts
 *   crc16.c                                               for src/codec/crc16.c: without a table, 30 cycles a byte
 *   crc16_table.c                                         instead of that: 512 bytes of flash, 24 cycles a byte
 *
 * F_CPU is the chip's clock in Hz: 16000000 or 8000000, so that Timer1 divides it by 8 and counts 0.5 or 1 us. Of a
 * crystal or resonator: the 8 MHz inside may be off by 10 % before it is calibrated, and so would all
 * rates and widths be.
 * All functions belong to the main loop. The caller enables interrupts, sei(), after the begin functions.
 *
 * Each of these peripherals exists once, so the state of this port is static: RAM as the linker shows it, and no
 * more than one of each.
 */

/* Timer1 runs from here on, from 0; the program uses it for nothing else. Called before all the others. */
void fathom_avr_clock_init(void);

/* us since then; wraps as hal.h has it. Right as long as interrupts are never off for longer than half a period of
 * Timer1: 16 ms at 16 MHz, 32 ms at 8 MHz. */
extern const fathom_clock_t fathom_avr_clock;

/* A pin: the PORT register and the bit. */
typedef struct {
    volatile uint8_t *port; /* &PORTB; NULL: there is none */
    uint8_t mask;           /* one bit */
} fathom_avr_pin_t;

/* `pin` outlives what is returned. An output begins high, as triggers and selects want it; an input has the pull-up
 * or not. */
fathom_pin_t fathom_avr_output(const fathom_avr_pin_t *pin);
fathom_pin_t fathom_avr_input(const fathom_avr_pin_t *pin, bool pull_up);

enum {
    /* Bytes that wait for the main loop, less one: 5.5 ms of them at 115200 baud. A power of two, 128 at most: two
     * bytes each, and their indices are single bytes. */
    FATHOM_AVR_RX_RING = 64
};

typedef struct {
    /* memory for the longest request, which is kept there while it leaves; 8 bytes for all reads and single writes */
    uint8_t *request;
    uint8_t request_size; /* 1..255 */
    /* DE of an RS-485 transceiver (with /RE, if there is to be no echo), high while bytes leave; port NULL: none */
    fathom_avr_pin_t driver;
    fathom_line_settings_t line; /* to begin with */
} fathom_avr_usart_config_t;

/* Since begin; each stops at 65535, and the caller may set them to 0. */
typedef struct {
    uint16_t parity;  /* bytes with wrong parity */
    uint16_t framing; /* bytes without a stop bit: breaks, noise, another rate */
    /* bytes before which others were lost: the interrupt came too late, or the ring was full */
    uint16_t overruns;
} fathom_avr_usart_counters_t;

/*
 * USART0. FATHOM_RX_PARITY, _FRAMING and _OVERRUN are reported byte by byte; a read ends before and after such a byte.
 * No FATHOM_RX_TIMED, no FATHOM_RX_SILENCE: they would cost in each receive interrupt what the main loop sees as well.
 * write       takes 1 to request_size bytes; of none or more it returns < 0. It begins with the first byte at once, and
 *             drives `driver` from before that until the last stop bit has left (transmit complete), in the interrupt.
 * sent        is exact.
 * leaves_in_us  counts bytes, and is two characters too long at most.
 * set_line    within 2.5 %: at 16 MHz up to 115200 baud (off by 2.1 %), no 230400; at 8 MHz no 115200 either; < 0
 *             beyond.
 * set_break   the transmitter lets go of TXD (PD1), which is driven low; `driver` is high as long.
 * Cost: a receive interrupt of at most 60 cycles, see include/COST.md.
 */
extern const fathom_uart_t fathom_avr_usart0;
extern fathom_avr_usart_counters_t fathom_avr_usart0_counters;

/**
 * @brief Initialises USART0, its pins and its interrupts. Copies `config`; `request` must stay valid as long as the port
 * is used.
 * @return False if these line settings cannot be reached, or if there is no memory for a request. Then nothing changed.
 */
bool fathom_avr_usart0_init(const fathom_avr_usart_config_t *config);

/*
 * Edges for a pulse, each fed to `edges`, which has been initialised (a pin for it: fathom_avr_input). Both may be
 * used at once, each with its own.
 *
 * icp1: the time is the hardware's, to a tick of Timer1, whatever else runs. Pulses and pauses shorter than the
 * capture interrupt can be missed: edges.h then gives none rather than a wrong one. Noise canceler on: 4 cycles
 * late at both ends.
 * int0: the time is that of the interrupt, so an edge is late by what else runs with interrupts off: the longest of
 * the other interrupts, if several are in use.
 */
void fathom_avr_icp1_init(fathom_edges_t *edges);
void fathom_avr_int0_init(fathom_edges_t *edges);

/*
 * For fathom_wait, or a main loop that has nothing to do: sleeps (idle mode) until a byte has been received or an
 * edge fed, a request has left, or max_us have passed, and returns; at once if a byte waits already. At most one
 * period of Timer1, 32 ms at 16 MHz, in one call. Interrupts are enabled afterwards.
 * ctx: NULL, or a const uint16_t, us: for so long bytes do not wake it, so that the main loop finds several at once.
 * 1000 halves what an HPS-167S at 115200 baud takes of the processor, and a response is known up to so much later. Not
 * more than FATHOM_AVR_RX_RING bytes take to come.
 */
void fathom_avr_idle(void *ctx, uint32_t max_us);

#ifdef __cplusplus
}
#endif

#endif
