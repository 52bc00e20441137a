/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_RP2040_H
#define FATHOM_RP2040_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/edges.h"
#include "fathom/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The HAL on an RP2040, on bare registers: no SDK, no C library. All state is the caller's, nothing is static, and
 * what is not called is not linked:
 *
 *   clock.c       TIMER's low word                              the clock
 *   uart.c        UART0, UART1, an alarm for each that drives   fathom_uart_t, with RS-485
 *   uart_setup.c  their registers alone                         for a reception of your own, DMA for instance
 *   pin.c         SIO                                           triggers, selects, switch and relay contacts
 *   edges.c       IO_BANK0's interrupt on both edges            pulses
 *   idle.c        an alarm                                      sleep until something comes or time is up
 *
 * Expected of the start-up code (boot2, clocks, VTOR: the maker's brings them): clk_ref and clk_peri run. Interrupt
 * vectors are the application's, and call the functions here that end in _interrupt or _alarm; the begin functions
 * enable them in the NVIC. All other functions belong to the main loop. All of it on one core, core 0.
 *
 * What of this ran: everything, on a simulator of the RP2040 with a model of the PL011 written from its manual (FIFOs,
 * levels, time-out, BUSY, errors, divider). Not seen on hardware, so nor are pads, levels and the times of flash.
 */

enum { FATHOM_RP2040_GPIOS = 30, FATHOM_RP2040_ALARMS = 4 };

/* ---- clock ---- */

/*
 * Starts TIMER and its ticks of 1 us. ref_hz: clk_ref, whole MHz up to 511 (12000000 from the usual crystal); 0: the
 * ticks run already, as they do after the start-up of the maker's SDK. Called before all the others.
 */
void fathom_rp2040_clock_init(uint32_t ref_hz);

/* us; wraps as hal.h has it. One load. It stands still while a debugger halts a core (TIMER's DBGPAUSE). */
extern const fathom_clock_t fathom_rp2040_clock;

/* ---- idle ---- */

/* For fathom_wait, or a main loop that has nothing to do. */
typedef struct {
    uint8_t alarm; /* 0..3, used for nothing else. The caller's to set, before begin */
    /* Something has come since idle returned last. UARTs and edges set it; other interrupts may. */
    volatile bool has_news;
} fathom_rp2040_idle_t;

void fathom_rp2040_idle_init(fathom_rp2040_idle_t *idle);

/*
 * ctx: a fathom_rp2040_idle_t. Sleeps (WFI) until an interrupt comes or max_us have passed, at most 2^31 - 1, and
 * returns; at once if there is news. FATHOM_NO_DEADLINE: until an interrupt. What comes after the last look at has_news
 * ends the sleep too: the look and the WFI happen with PRIMASK set, under which WFI wakes all the same.
 * Interrupts are enabled afterwards.
 */
void fathom_rp2040_idle(void *ctx, uint32_t max_us);

/* For TIMER_IRQ_n of its alarm. */
void fathom_rp2040_idle_alarm(fathom_rp2040_idle_t *idle);

/* ---- pins ---- */

/*
 * gpio: 0..29. An output begins high or low without a glitch; an input has the pull-up, or no pull at all. What is
 * returned needs no memory. It takes the pin over from any other function.
 */
fathom_pin_t fathom_rp2040_output(unsigned gpio, bool high);
fathom_pin_t fathom_rp2040_input(unsigned gpio, bool pull_up);

/* ---- UARTs ---- */

/* Where a UART is, which never changes. */
typedef struct {
    uint32_t clk_peri_hz; /* up to 1 GHz; 125000000 after the SDK's start-up */
    uint8_t number;       /* UART0 or UART1 */
    uint8_t tx;           /* GPIO; UART0: 0, 12, 16, 28. UART1: 4, 8, 20, 24 */
    uint8_t rx;           /* GPIO; UART0: 1, 13, 17, 29. UART1: 5, 9, 21, 25. It gets the pull-up */
    bool has_driver;      /* there is an RS-485 transceiver: */
    uint8_t driver;       /* GPIO of its DE (with /RE, if there is to be no echo), high while bytes leave */
    uint8_t alarm;        /* 0..3, used for nothing else, for the end of that */
} fathom_rp2040_wiring_t;

/** @brief Copied by fathom_rp2040_uart_init(). `request` and `idle` must stay valid as long as the port is used. */
typedef struct {
    fathom_rp2040_wiring_t wiring;
    fathom_line_settings_t line; /* to begin with */
    uint8_t *request;            /* the longest request is kept here while it leaves */
    uint8_t request_size;        /* 1..255; 8 for all reads and single writes */
    fathom_rp2040_idle_t *idle;  /* woken by news; NULL: none */
} fathom_rp2040_uart_config_t;

enum {
    /* Bytes that wait for the main loop, 5.5 ms of them at 115200 baud; 32 more wait in the hardware. A power of two
     * below 256, so that indices are single bytes and wrap by themselves. */
    FATHOM_RP2040_RX_RING = 64
};

typedef struct {
    /* Since init; each stops at 65535, and the caller may set them to 0. */
    uint16_t parity;   /* bytes with wrong parity */
    uint16_t framing;  /* bytes without a stop bit: breaks, noise, another rate */
    uint16_t overruns; /* bytes before which others were lost: ring and FIFO were full */

    /* private */
    fathom_rp2040_uart_config_t config;
    fathom_line_settings_t line;
    volatile uint16_t ring[FATHOM_RP2040_RX_RING]; /* a byte, and above it DR's error bits */
    volatile uint8_t written;                      /* to the ring, so far; wraps */
    volatile uint8_t taken;                        /* from the ring, so far; wraps */
    uint8_t silent_at;  /* with is_silent: after so many bytes the receive time-out came */
    uint32_t silent_us; /* and this is when the last of them had ended */
    bool is_silent;
    uint32_t end_us;         /* of the last request: its length, and a bit */
    volatile uint8_t length; /* of the request */
    volatile uint8_t given;  /* of it, to the hardware */
    volatile bool is_break;
} fathom_rp2040_uart_t;

/*
 * Resets the UART and makes it ready; enables UARTn_IRQ and, with a driver, the alarm's. false: these line settings
 * cannot be reached, a pin is not one of this UART's, there is no memory for a request, or the UART does not leave
 * reset, since it has no clock. Then it is not to be used.
 */
bool fathom_rp2040_uart_init(fathom_rp2040_uart_t *uart, const fathom_rp2040_uart_config_t *config);

/*
 * The HAL's view of it. Errors are reported byte by byte: a read ends before and after such a byte. No
 * FATHOM_RX_SILENCE.
 * read        looks into the hardware's FIFO too, so that a loop that polls sees each byte when it has come. A program
 *             that sleeps is woken by every fourth, and by the last one 32 bits later (1.7 ms at 19200 baud): the
 *             receive time-out. That byte's time is reported, FATHOM_RX_TIMED, so that the silence before the next
 *             request is no longer for it; late by what else interrupts, and by as long as the ring was full.
 * write       takes up to request_size bytes; of more it returns < 0. The first byte begins at once; an interrupt keeps
 *             the FIFO filled, if the request is longer than its 32 bytes. The driver is high from before that until
 *             BUSY has ended. PL011 has no interrupt for that end, so the alarm is set to when it is due and looks;
 *             if it is not over, it looks again a bit later. So the driver stays one bit longer at most, and what
 *             other interrupts take: no device here responses sooner than that.
 * sent        is exact: BUSY.
 * leaves_in_us  is by the clock, and a bit too long at most.
 * set_line    within 2.5 %, from clk_peri / 1048560 to clk_peri / 16 baud. A byte that is coming in just then is
 *             garbage; the hardware is stopped meanwhile.
 * set_break   LCR_H.BRK; the driver is high as long. The PL011 asks for two characters of it at least.
 */
fathom_uart_t fathom_rp2040_uart(fathom_rp2040_uart_t *uart);

/* For UARTn_IRQ. It moves at most 32 bytes each way. */
void fathom_rp2040_uart_interrupt(fathom_rp2040_uart_t *uart);

/* For TIMER_IRQ_n of its alarm, where there is a driver. */
void fathom_rp2040_uart_alarm(fathom_rp2040_uart_t *uart);

/*
 * The registers alone, for a reception of your own: pins, FIFOs at their lowest levels (4 bytes), the UART enabled with
 * all its interrupts masked, the driver low. false: as above.
 */
bool fathom_rp2040_uart_setup(const fathom_rp2040_wiring_t *wiring, const fathom_line_settings_t *line);

/* Other line settings for it; nothing may be leaving. false: cannot be reached, and nothing has changed. */
bool fathom_rp2040_uart_set_line(const fathom_rp2040_wiring_t *wiring, const fathom_line_settings_t *line);

/* How many bits a character has with these settings: 10 for 8N1, 11 for 8E1. */
unsigned fathom_rp2040_uart_bits(const fathom_line_settings_t *line);

/* ---- pulses ---- */

typedef struct {
    fathom_edges_t *edges;
    fathom_rp2040_idle_t *idle; /* woken by news; NULL: none */
    uint8_t gpio;
} fathom_rp2040_edges_t;

/*
 * Feeds `edges` from both edges of a pin (made by fathom_rp2040_input, edges initialised with it or without). All three
 * outlive the use. Enables IO_IRQ_BANK0.
 */
void fathom_rp2040_edges_init(fathom_rp2040_edges_t *pin, fathom_edges_t *edges, unsigned gpio,
                              fathom_rp2040_idle_t *idle);

/*
 * For IO_IRQ_BANK0, once for each pin. The time of an edge is that of the interrupt, so an edge is late by whatever
 * runs with interrupts off or at the same priority. Give IO_IRQ_BANK0 a priority above the others (NVIC_IPR), and
 * widths are right within 1 us at any clk_sys above 50 MHz.
 * If both edges wait when it runs, only the level that the pin has now is fed: if that is the level before, an edge
 * was missed and edges.h gives no width for it; if not, it was a pulse or a pause shorter than the delay.
 */
void fathom_rp2040_edges_interrupt(fathom_rp2040_edges_t *pin);

#ifdef __cplusplus
}
#endif

#endif
