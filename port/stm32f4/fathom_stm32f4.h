/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_STM32F4_H
#define FATHOM_STM32F4_H

#include <stdbool.h>
#include <stdint.h>

#include "../serial/fathom_serial.h"
#include "fathom/engine/edges.h"
#include "fathom/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The HAL on an STM32F405 (F407, F415 and F417 are the same), on bare registers. What is used is linked, and nothing
 * else:
 *
 *   clock.c    TIM2, 32 bits                           the clock, from which all the times here are taken
 *   usart.c    USART1..3, 6, UART4, 5 and their interrupts   fathom_uart_t, with RS-485
 *   capture.c  TIM2's capture 1 and 2, pin TIM2_CH1    edges with the time of the hardware
 *   idle.c     TIM5 and its interrupt                  sleep until bytes come or time is up
 *   pin.c                                              triggers, selects, switch and relay contacts
 *
 * What has run, on QEMU's netduinoplus2, where the tests run it: the USART's reception by interrupts, its transmission
 * by the same code (QEMU 7.2 raises no interrupt for it, so that the test has to), TIM2 as the clock, the sleep (whose
 * end QEMU 7.2 delays).
 * What has NEVER run but on a test's memory in place of the registers, since no simulator here has it: the capture, all
 * pins and with them the driver-enable and the break, parity, framing and overrun errors, and the line settings on a
 * wire. Not seen on a board.
 *
 * Registers and sections: RM0090. The bits in RCC that these peripherals and pins need are set by the begin functions;
 * the clocks themselves are the application's. All functions but the interrupts belong to the main loop. The priorities
 * of the interrupts stay what they are, 0 after reset; under an RTOS set them to what its calls from interrupts want.
 */

/* A pin: {'A', 2} is PA2. */
typedef struct {
    char port;      /* 'A'..'I'; 0: there is none */
    uint8_t number; /* 0..15 */
} fathom_stm32f4_pin_t;

/* `pin` outlives what is returned. An output begins high, as triggers and selects want it. */
fathom_pin_t fathom_stm32f4_output(const fathom_stm32f4_pin_t *pin);
typedef enum {
    FATHOM_STM32F4_FLOATS = 0,
    FATHOM_STM32F4_UP = 1,
    FATHOM_STM32F4_DOWN = 2
} fathom_stm32f4_pull_t;
fathom_pin_t fathom_stm32f4_input(const fathom_stm32f4_pin_t *pin, fathom_stm32f4_pull_t pull);

/* TIM2 counts us from here on, from 0, and the program does not set it up. It wraps at 2^32 by itself. timer_hz: what
 * TIM2 and TIM5 are clocked with, a whole number of MHz; twice PCLK1 where APB1 is divided, else PCLK1 (RM0090 7.2).
 * Called before all the others. */
void fathom_stm32f4_clock_init(uint32_t timer_hz);
extern const fathom_clock_t fathom_stm32f4_clock;

/* Read by begin, but for the pins, which outlive the use of the UART. */
typedef struct {
    /* memory for the longest request; outlives the use of the UART. 8 bytes for all reads and single writes */
    uint8_t *request;
    uint8_t request_size;        /* 1..255 */
    uint8_t number;              /* 1..6: USART1..3, UART4, UART5, USART6 */
    uint32_t bus_hz;             /* PCLK2 for 1 and 6, PCLK1 for the others */
    fathom_line_settings_t line; /* to begin with */
    fathom_stm32f4_pin_t tx;     /* the datasheet's table of alternate functions has the choice */
    fathom_stm32f4_pin_t rx;     /* with pull-up */
    /* DE of an RS-485 transceiver (with /RE, if there is to be no echo), high while bytes leave; port 0: none */
    fathom_stm32f4_pin_t driver;
} fathom_stm32f4_usart_config_t;

/* The port's; `serial` has counters that the caller may read. */
typedef struct {
    fathom_serial_t serial;
    volatile uint32_t *registers;
    uint32_t bus_hz;
    fathom_line_settings_t line;
    fathom_stm32f4_pin_t tx;
    fathom_stm32f4_pin_t driver;
    /* bytes of which the three samples of a bit differed (NE); taken for good. Stops at 65535, and the caller may
     * set it to 0 */
    volatile uint16_t noise;
    bool is_break;
} fathom_stm32f4_usart_t;

/*
 * Makes it ready, with its pins, and enables its interrupt in the NVIC. false, and nothing has changed: no such
 * number, these settings cannot be reached, no memory for a request, tx or rx is no pin.
 */
bool fathom_stm32f4_usart_init(fathom_stm32f4_usart_t *usart, const fathom_stm32f4_usart_config_t *config);

/* For the interrupt of this USART: 37, 38, 39, 52, 53, 71 for 1..6. */
void fathom_stm32f4_usart_interrupt(fathom_stm32f4_usart_t *usart);

/*
 * By value; it points to `usart`. FATHOM_RX_PARITY, _FRAMING and _OVERRUN are reported byte by byte; a read ends before
 * and after such a byte. No FATHOM_RX_TIMED, no FATHOM_RX_SILENCE.
 *             While bytes leave, a parity error may be missed (errata ES0182: a write to DR can clear it).
 * write       takes 1 to request_size bytes; of none or more it returns < 0. It drives `driver` from before the first
 *             start bit until the last stop bit has left (TC), and lets it go in the interrupt.
 * sent        is exact.
 * leaves_in_us  counts bytes, and is two characters too long at most.
 * set_line    within 2.5 %: bus_hz / 65535 to bus_hz / 16 baud. 8E1 and 8O1 are words of 9 bits here (M and PCE).
 * set_break   TX becomes an output that is low, since SBK sends one character of break and no more; `driver` is high
 *             as long. Meanwhile write returns 0.
 */
fathom_uart_t fathom_stm32f4_usart(fathom_stm32f4_usart_t *usart);

/*
 * Edges for a pulse, fed to `edges`, which has been initialised, with the time of the hardware: TIM2 keeps the
 * counter of the clock at the rise in CCR1 and at the fall in CCR2, whatever else runs. 1 us. A pulse is lost, and
 * none is wrong, where the next one of the same direction comes before the interrupt has run.
 * pin: one of TIM2_CH1: PA0, PA5 or PA15; false: it is none of them. There is one capture: a second begin replaces it.
 * NEVER RUN but on memory: no simulator here has TIM2's captures.
 */
bool fathom_stm32f4_capture_init(const fathom_stm32f4_pin_t *pin, fathom_edges_t *edges);

/* For interrupt 28, TIM2's, which capture_begin enables. */
void fathom_stm32f4_tim2_interrupt(void);

/* Which USARTs end a sleep. The caller's, and outlives the sleep. */
typedef struct {
    const fathom_stm32f4_usart_t *usarts;
    uint8_t count;
} fathom_stm32f4_idle_t;

/*
 * For fathom_wait, or a main loop that has nothing to do: sleeps (WFI) until an interrupt has run or max_us have
 * passed, and returns; at once if a byte waits, or if since the last sleep an edge was fed or a request has left. What
 * comes while it goes to sleep wakes it. ctx: a fathom_stm32f4_idle_t. Interrupts are enabled afterwards.
 */
void fathom_stm32f4_idle(void *ctx, uint32_t max_us);

/* For interrupt 50, TIM5's, which idle enables. */
void fathom_stm32f4_tim5_interrupt(void);

#ifdef __cplusplus
}
#endif

#endif
