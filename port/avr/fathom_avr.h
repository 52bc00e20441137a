/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_AVR_H
#define FATHOM_AVR_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/edges.h"
#include "fathom/engine/modbus.h"
#include "fathom/engine/wait.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief The HAL (hal.h) on an ATmega328P, on bare registers: clock, USART0, pins, edges and idle.
 *
 * The ATmega48, 88 and 168 differ only in memory. The port needs no library but avr-libc. No function waits except
 * fathom_avr_idle(), and none allocates memory. Each peripheral exists once, so the state of this port is static. The
 * section "On the chip" of include/COST.md has the cycles of the interrupts and of a reading.
 *
 * | file            | uses                                   | for                                                    |
 * |-----------------|----------------------------------------|--------------------------------------------------------|
 * | `clock.c`       | Timer1 and its overflow interrupt      | the clock, the source of all times of this port        |
 * | `usart0.c`      | USART0 and its three interrupts        | a UART, with RS-485                                    |
 * | `icp1.c`        | the input capture of Timer1, pin ICP1 (PB0) | edges with the time of the hardware               |
 * | `int0.c`        | INT0, pin PD2                          | edges with the time at which the interrupt ran         |
 * | `idle.c`        | compare match B of Timer1              | sleep until bytes arrive or a time has passed          |
 * | `pin.c`         | the ports                              | triggers, selects, contacts of switches and relays     |
 * | `crc16.c`       | no table: 30 cycles a byte             | replaces src/codec/crc16.c                             |
 * | `crc16_table.c` | 512 bytes of flash: 24 cycles a byte   | replaces `crc16.c`                                     |
 *
 * A program contains only the files whose functions it calls, with their interrupts.
 *
 * @code
 * static uint8_t request[8];
 * static const fathom_avr_usart_config_t config = {.request = request, .request_size = sizeof request,
 *                                                  .line = {9600, FATHOM_PARITY_NONE, 1}};
 * fathom_avr_clock_init();
 * if (!fathom_avr_usart0_init(&config)) return 1;
 * sei();
 * // a line (line.h) uses &fathom_avr_usart0 and &fathom_avr_clock
 * status = fathom_wait(&sensor, &sample, fathom_avr_idle, NULL);
 * @endcode
 *
 * 1. **F_CPU** is the clock of the chip in Hz: 16000000 or 8000000. Timer1 divides it by 8 and counts 0.5 or 1 us. Use
 *    a crystal or a resonator. The internal oscillator of 8 MHz may be off by 10 % before it is calibrated, and so
 *    would all rates and widths be.
 *
 * 2. **Context.** All functions belong to the main loop.
 *
 * 3. **Order.** Call fathom_avr_clock_init() first, then the other init functions, then enable interrupts by `sei()`.
 */

/** @brief Starts Timer1 from 0. The program must not use Timer1 for anything else. Call it before all other functions.
 * */
void fathom_avr_clock_init(void);

/**
 * @brief The clock: microseconds since fathom_avr_clock_init(). It wraps as hal.h describes.
 *
 * The clock is right if interrupts are never disabled for longer than half a period of Timer1: 16 ms at 16 MHz, 32 ms
 * at 8 MHz.
 */
extern const fathom_clock_t fathom_avr_clock;

/** @brief A pin: its PORT register and its bit. */
typedef struct {
    /** @brief The register, such as `&PORTB`. NULL: no pin. */
    volatile uint8_t *port;
    /** @brief One bit, such as `_BV(PORTB1)`. */
    uint8_t mask;
} fathom_avr_pin_t;

/**
 * @brief Makes a pin an output and returns it. The output starts high, which is the idle level of triggers and selects.
 *
 * @param pin  The pin. Must stay valid as long as the result is used.
 * @return The pin for the HAL, by value.
 */
fathom_pin_t fathom_avr_output(const fathom_avr_pin_t *pin);

/**
 * @brief Makes a pin an input and returns it.
 *
 * @param pin      The pin. Must stay valid as long as the result is used.
 * @param pull_up  True to enable the pull-up resistor.
 * @return The pin for the HAL, by value.
 */
fathom_pin_t fathom_avr_input(const fathom_avr_pin_t *pin, bool pull_up);

/** @brief Constants of USART0. */
enum {
    /** @brief Size of the receive ring: one more than the number of bytes that can wait for the main loop.
     *
     * 64 bytes take 5.5 ms at 115200 baud. The size must be a power of two, at most 128. Each byte takes two bytes of
     * RAM, and the indices are single bytes. */
    FATHOM_AVR_RX_RING = 64
};

/** @brief Configuration of USART0. Copied by fathom_avr_usart0_init(). */
typedef struct {
    /** @brief Buffer for a copy of the longest request, which stays there while it is sent. 8 bytes suffice for all
     * reads and single writes. Must stay valid as long as the port is used. */
    uint8_t *request;

    /** @brief Size of `request` in bytes, 1 to 255. */
    uint8_t request_size;

    /** @brief Driver enable (DE) of an RS-485 transceiver, high while bytes are sent. Connect /RE to it too if there
     * should be no echo. If its `port` is NULL, there is no transceiver. */
    fathom_avr_pin_t driver;

    /** @brief The first line settings. */
    fathom_line_settings_t line;
} fathom_avr_usart_config_t;

/** @brief Receive errors since the start of the program. Each counter stops at 65535. The caller may set them to 0. */
typedef struct {
    /** @brief Bytes with wrong parity. */
    uint16_t parity;
    /** @brief Bytes without a stop bit: breaks, noise, or another baud rate. */
    uint16_t framing;
    /** @brief Bytes before which others were lost, because the interrupt came too late or the ring was full. */
    uint16_t overruns;
} fathom_avr_usart_counters_t;

/**
 * @brief The UART functions (hal.h) of USART0. Use them after fathom_avr_usart0_init().
 *
 * - **read** reports FATHOM_RX_PARITY, FATHOM_RX_FRAMING and FATHOM_RX_OVERRUN for single bytes: a read ends before and
 *   after such a byte. It never reports FATHOM_RX_TIMED or FATHOM_RX_SILENCE, because they would cost time in each
 *   receive interrupt, and the main loop can measure the same.
 * - **write** accepts 1 to `request_size` bytes, and returns a negative number for any other count. The first byte
 *   leaves at once. `driver` is high from before the first byte until the last stop bit has left; the transmit-complete
 *   interrupt ends it.
 * - **sent** is exact.
 * - **leaves_in_us** counts bytes. It is at most two characters too long.
 * - **set_line** accepts rates within 2.5 %: up to 115200 baud at 16 MHz (off by 2.1 %), but not 230400; at 8 MHz not
 *   115200 either. It returns a negative number for others.
 * - **set_break** disables the transmitter and drives TXD (PD1) low. `driver` is high meanwhile.
 *
 * A receive interrupt takes at most 60 cycles, and 4 more of entry (include/COST.md).
 */
extern const fathom_uart_t fathom_avr_usart0;

/** @brief The receive errors of USART0. */
extern fathom_avr_usart_counters_t fathom_avr_usart0_counters;

/**
 * @brief Initialises USART0, its pins and its interrupts.
 *
 * RXD gets its pull-up resistor.
 *
 * @param config  The configuration, read only during the call; `request` must stay valid as long as the port is used.
 * @return False if the line settings cannot be reached, or if there is no buffer for a request. Then nothing changed.
 */
bool fathom_avr_usart0_init(const fathom_avr_usart_config_t *config);

/**
 * @brief Feeds edges of pin ICP1 (PB0) with the time of the hardware.
 *
 * The time is exact to one tick of Timer1, whatever else runs. The noise canceller is on, which makes both edges 4
 * cycles late. Pulses and pauses that are shorter than the capture interrupt can be missed; edges.h then returns no
 * pulse rather than a wrong one. This capture and fathom_avr_int0_init() may be used at the same time, each with its
 * own edges.
 *
 * @param edges  Initialised edges (edges.h; fathom_avr_input() makes a pin for them). Must stay valid.
 */
void fathom_avr_icp1_init(fathom_edges_t *edges);

/**
 * @brief Feeds edges of pin INT0 (PD2) with the time at which the interrupt ran.
 *
 * An edge is late by the time for which interrupts were disabled: at most the longest of the other interrupts, if
 * several are used.
 *
 * @param edges  Initialised edges (edges.h; fathom_avr_input() makes a pin for them). Must stay valid.
 */
void fathom_avr_int0_init(fathom_edges_t *edges);

/**
 * @brief Sleeps in idle mode until a byte was received, an edge was fed, a request has left, or `max_us` has passed.
 *
 * This is an idle hook for fathom_wait() (wait.h), or for a main loop that has nothing to do. If a byte waits already,
 * the function returns at once. One call sleeps at most one period of Timer1, 32 ms at 16 MHz. Interrupts are enabled
 * when it returns.
 *
 * @param ctx     NULL, or a `const uint16_t` in microseconds: bytes do not end the sleep during this time, so that the
 *                main loop reads several at once, up to that much later. 1000 reduces the processor time for an
 *                HPS-167S at 115200 baud from 10.5 % to 6.0 %. Choose at most the time in which FATHOM_AVR_RX_RING - 1
 *                bytes arrive.
 * @param max_us  Longest sleep in microseconds.
 */
void fathom_avr_idle(void *ctx, uint32_t max_us);

/**
 * @brief USART0 with a line on it, in the caller's memory: all that a driver needs. There is one, as there is one USART.
 *
 * Pass `modbus` to the drivers that send Modbus requests, and `line` to those that listen or use the protocol `55 AA`.
 * Several drivers may share the bus. The line is made of parts (line.h) for a transceiver of unknown kind: it finds out
 * whether there is an echo, names `senders`, uses the error flags of the USART, and keeps fathom_silence_us() before a
 * request. A program that needs other parts changes `parts` and calls fathom_line_init() with `&line` and `&parts`, before
 * it initialises a driver.
 *
 * Do not move or copy a bus, because its members point to each other.
 */
typedef struct {
    /** @brief The line, initialised. */
    fathom_line_t line;
    /** @brief The Modbus RTU transport over `line`; not set by fathom_avr_bus_init_listening(). */
    fathom_modbus_t modbus;
    /** @brief The parts of `line`. */
    fathom_line_parts_t parts;
    /* private */
    fathom_line_settings_t settings; /* with which the bus was initialised */
    uint8_t frame[32];   /* the longest frame of any sensor is the details of an HPS-167S, 27 bytes */
    uint8_t request[16]; /* the longest request is that of the reconnect time of an HPS-167S, 13 bytes */
} fathom_avr_bus_t;

/**
 * @brief Initialises USART0 and makes a line of it, for sensors that are asked. Call fathom_avr_clock_init() before, and
 * `sei()` after it.
 *
 * @param bus       The bus, with any content. Must stay valid as long as its drivers.
 * @param driver    Driver enable (DE) of an RS-485 transceiver, as in fathom_avr_usart_config_t. NULL: none. Copied.
 * @param settings  The settings with which the sensors leave the factory (factory_line.h), or those that were set.
 *                  Copied.
 * @return False if the settings cannot be reached, or are slower than 9600 baud. Do not use the bus then.
 */
bool fathom_avr_bus_init(fathom_avr_bus_t *bus, const fathom_avr_pin_t *driver,
                         const fathom_line_settings_t *settings);

/**
 * @brief Initialises USART0 and makes a line of it that only listens, for sensors that send by themselves.
 *
 * The program links nothing that sends. It may print by `fathom_avr_usart0.write`, since TX is free: 1 to 16 bytes at
 * once.
 *
 * @param bus       As for fathom_avr_bus_init().
 * @param settings  As for fathom_avr_bus_init().
 * @return As fathom_avr_bus_init().
 */
bool fathom_avr_bus_init_listening(fathom_avr_bus_t *bus, const fathom_line_settings_t *settings);

/**
 * @brief Waits for the next reading or error of a sensor, as fathom_wait(). Sleeps while it waits (fathom_avr_idle()).
 *
 * The driver's header states the longest wait.
 *
 * @param sensor  The sensor, such as the result of fathom_hps167s_sensor().
 * @param sample  Written with FATHOM_OK only.
 * @return Any result of fathom_poll() but FATHOM_PENDING.
 */
fathom_status_t fathom_avr_bus_read(fathom_sensor_t sensor, fathom_sample_t *sample);

#ifdef __cplusplus
}
#endif

#endif
