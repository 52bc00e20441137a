/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_STM32F4_H
#define FATHOM_STM32F4_H

#include <stdbool.h>
#include <stdint.h>

#include "../serial/fathom_serial.h"
#include "fathom/engine/edges.h"
#include "fathom/engine/modbus.h"
#include "fathom/engine/wait.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief The HAL (hal.h) on an STM32F405, on bare registers: clock, USARTs, pins, capture and idle.
 *
 * The STM32F407, F415 and F417 are the same. The port needs no vendor library. No function waits except
 * fathom_stm32f4_idle(), and none allocates memory. The capture and a flag of the sleep exist once and are
 * static; all other state is in the caller's memory.
 *
 * | file        | uses                                           | for                                                |
 * |-------------|------------------------------------------------|----------------------------------------------------|
 * | `clock.c`   | TIM2, 32 bits                                  | the clock, the source of all times of this port    |
 * | `usart.c`   | USART1 to 3, UART4, UART5, USART6, interrupts  | UARTs, with RS-485                                 |
 * | `capture.c` | captures 1 and 2 of TIM2, pin TIM2_CH1         | edges with the time of the hardware                |
 * | `idle.c`    | TIM5 and its interrupt                         | sleep until bytes arrive or a time has passed      |
 * | `pin.c`     | the GPIO ports                                 | triggers, selects, contacts of switches and relays |
 *
 * A program contains only the files whose functions it calls. Section numbers are those of RM0090.
 *
 * @code
 * static uint8_t request[8];
 * static fathom_stm32f4_usart_t port;
 * static fathom_uart_t uart;
 * static const fathom_stm32f4_idle_t idle = {&port, 1};
 * const fathom_stm32f4_usart_config_t config = {
 *     .request = request, .request_size = sizeof request, .number = 2, .bus_hz = 42000000,
 *     .line = {9600, FATHOM_PARITY_NONE, 1}, .tx = {'A', 2}, .rx = {'A', 3}};
 * fathom_stm32f4_clock_init(84000000);
 * if (!fathom_stm32f4_usart_init(&port, &config)) return 1;
 * uart = fathom_stm32f4_usart(&port);       // a line (line.h) uses &uart and &fathom_stm32f4_clock
 * status = fathom_wait(&sensor, &sample, fathom_stm32f4_idle, (void *)&idle);
 * @endcode
 *
 * 1. **Clocks.** The init functions set the bits of RCC that these peripherals and pins need. The clock tree belongs to
 *    the application.
 *
 * 2. **Interrupts.** The vectors belong to the application. They call the functions whose names end in `_interrupt`.
 *    The port does not change the priorities of the interrupts, which are 0 after reset. With an RTOS, set the
 *    priorities that its calls from interrupts require.
 *
 * 3. **Context.** All other functions belong to the main loop.
 *
 * 4. **What has run.** On the machine netduinoplus2 of QEMU: the reception of the USART by interrupts, TIM2 as the
 *    clock, and the sleep, whose end QEMU 7.2 delays. The transmission ran with the same code, but QEMU 7.2 raises no
 *    interrupt for it, so the test does.
 *
 * 5. **What has NEVER run** except on the memory of a test in place of the registers, because no available simulator
 *    has it: the capture; all pins, with the driver enable and the break; parity, framing and overrun errors; the line
 *    settings on a wire. Nothing has run on a board.
 */

/** @brief A pin: `{'A', 2}` is PA2. */
typedef struct {
    /** @brief The GPIO port, 'A' to 'I'. 0: no pin. */
    char port;
    /** @brief The number of the pin, 0 to 15. */
    uint8_t number;
} fathom_stm32f4_pin_t;

/**
 * @brief Makes a pin an output and returns it. The output starts high, which is the idle level of triggers and selects.
 *
 * @param pin  The pin. Must stay valid as long as the result is used.
 * @return The pin for the HAL, by value.
 */
fathom_pin_t fathom_stm32f4_output(const fathom_stm32f4_pin_t *pin);

/** @brief The pull resistor of an input. */
typedef enum {
    FATHOM_STM32F4_FLOATS = 0, /**< No resistor. */
    FATHOM_STM32F4_UP = 1,     /**< Pull-up. */
    FATHOM_STM32F4_DOWN = 2    /**< Pull-down. */
} fathom_stm32f4_pull_t;

/**
 * @brief Makes a pin an input and returns it.
 *
 * @param pin   The pin. Must stay valid as long as the result is used.
 * @param pull  The pull resistor.
 * @return The pin for the HAL, by value.
 */
fathom_pin_t fathom_stm32f4_input(const fathom_stm32f4_pin_t *pin, fathom_stm32f4_pull_t pull);

/**
 * @brief Starts TIM2 from 0 as the clock, and sets up TIM5 for the sleep. Call it before all other functions.
 *
 * The program must not set up TIM2 or TIM5 itself.
 *
 * @param timer_hz  Frequency of TIM2 and TIM5 in Hz, a multiple of 1000000: twice PCLK1 if APB1 is divided, else PCLK1
 *                  (7.2).
 */
void fathom_stm32f4_clock_init(uint32_t timer_hz);

/** @brief The clock: microseconds since fathom_stm32f4_clock_init(). It wraps as hal.h describes. */
extern const fathom_clock_t fathom_stm32f4_clock;

/** @brief Configuration of a USART. Read only by fathom_stm32f4_usart_init(). */
typedef struct {
    /** @brief Buffer for a copy of the longest request, which stays there while it is sent. 8 bytes suffice for all
     * reads and single writes. Must stay valid as long as the port is used. */
    uint8_t *request;
    /** @brief Size of `request` in bytes, 1 to 255. */
    uint8_t request_size;
    /** @brief The number of the USART, 1 to 6: USART1 to USART3, UART4, UART5, USART6. */
    uint8_t number;
    /** @brief Frequency of its bus in Hz: PCLK2 for 1 and 6, PCLK1 for the others. */
    uint32_t bus_hz;
    /** @brief The first line settings. */
    fathom_line_settings_t line;
    /** @brief TX. The table of alternate functions in the datasheet has the possible pins. */
    fathom_stm32f4_pin_t tx;
    /** @brief RX, from the same table. It gets the pull-up resistor. */
    fathom_stm32f4_pin_t rx;
    /** @brief Driver enable (DE) of an RS-485 transceiver, high while bytes are sent. Connect /RE to it too if there
     * should be no echo. If its `port` is 0, there is no transceiver. */
    fathom_stm32f4_pin_t driver;
} fathom_stm32f4_usart_config_t;

/** @brief A USART, in the caller's memory. The caller may read the counters of `serial`, and `noise`. */
typedef struct {
    /** @brief Ring, request and error counters (fathom_serial.h). */
    fathom_serial_t serial;
    /** @brief Private: the registers. */
    volatile uint32_t *registers;
    /** @brief Private: frequency of the bus in Hz. */
    uint32_t bus_hz;
    /** @brief Private: the settings that are in force. */
    fathom_line_settings_t line;
    /** @brief Private: TX. */
    fathom_stm32f4_pin_t tx;
    /** @brief Private: the driver enable. */
    fathom_stm32f4_pin_t driver;
    /** @brief Bytes in which the three samples of a bit differed (NE). They are accepted as good. Stops at 65535. The
     * caller may set it to 0. */
    volatile uint16_t noise;

    /* private */
    bool is_break;
} fathom_stm32f4_usart_t;

/**
 * @brief Initialises a USART and its pins, and enables its interrupt in the NVIC.
 *
 * @param usart   The USART, with any content. Must stay valid as long as it is used.
 * @param config  The configuration, read only during the call; `request` must stay valid as long as the port is used.
 * @return False if there is no such number, the line settings cannot be reached, there is no buffer for a request, or
 *         `tx` or `rx` is no pin. Then nothing changed.
 */
bool fathom_stm32f4_usart_init(fathom_stm32f4_usart_t *usart, const fathom_stm32f4_usart_config_t *config);

/** @brief Call it from the interrupt of this USART: number 37, 38, 39, 52, 53 and 71 for USART 1 to 6. */
void fathom_stm32f4_usart_interrupt(fathom_stm32f4_usart_t *usart);

/**
 * @brief Returns the UART functions (hal.h) of a USART.
 *
 * - **read** reports FATHOM_RX_PARITY, FATHOM_RX_FRAMING and FATHOM_RX_OVERRUN for single bytes: a read ends before and
 *   after such a byte. It never reports FATHOM_RX_TIMED or FATHOM_RX_SILENCE. While bytes are sent, a parity error may
 *   be missed, because a write to DR can clear it (errata ES0182).
 * - **write** accepts 1 to `request_size` bytes, and returns a negative number for any other count. `driver` is high
 *   from before the first start bit until the last stop bit has left (TC); the interrupt ends it.
 * - **sent** is exact.
 * - **leaves_in_us** counts bytes. It is at most two characters too long.
 * - **set_line** accepts rates within 2.5 %, from bus_hz / 65535 to bus_hz / 16 baud. 8E1 and 8O1 are words of 9 bits
 *   here (M and PCE).
 * - **set_break** makes TX an output that is low, because SBK sends only one character of break. `driver` is high
 *   meanwhile, and `write` returns 0.
 *
 * @param usart  The USART. It must stay valid as long as the functions are used.
 * @return The functions, by value. A line needs them in memory that stays valid.
 */
fathom_uart_t fathom_stm32f4_usart(fathom_stm32f4_usart_t *usart);

/**
 * @brief Feeds edges with the time of the hardware, in steps of 1 us. NEVER RUN except on memory (rule 5).
 *
 * TIM2 stores the clock at a rise in CCR1 and at a fall in CCR2, whatever else runs. If the next edge of the same
 * direction comes before the interrupt has run, the pulse is lost; no width is wrong. There is one capture: a second
 * call replaces the first.
 *
 * @param pin    A pin of TIM2_CH1: PA0, PA5 or PA15. Used only during the call.
 * @param edges  Initialised edges (edges.h). Must stay valid as long as edges are fed.
 * @return False if `pin` is no pin of TIM2_CH1. Then nothing changed.
 */
bool fathom_stm32f4_capture_init(const fathom_stm32f4_pin_t *pin, fathom_edges_t *edges);

/** @brief Call it from interrupt 28 (TIM2), which fathom_stm32f4_capture_init() enables. */
void fathom_stm32f4_tim2_interrupt(void);

/** @brief The USARTs that end a sleep. Must stay valid as long as the program sleeps with it. */
typedef struct {
    /** @brief Array of `count` USARTs. */
    const fathom_stm32f4_usart_t *usarts;
    /** @brief Number of USARTs. */
    uint8_t count;
} fathom_stm32f4_idle_t;

/**
 * @brief Sleeps (WFI) until an interrupt has run or `max_us` has passed.
 *
 * This is an idle hook for fathom_wait() (wait.h), or for a main loop that has nothing to do. It returns at once if a
 * byte waits, or if an edge was fed or a request has left since the last sleep. What happens directly before the sleep
 * ends it too. Interrupts are enabled when the function returns, unless `max_us` is 0: then the function does nothing.
 *
 * @param ctx     A fathom_stm32f4_idle_t.
 * @param max_us  Longest sleep in microseconds.
 */
void fathom_stm32f4_idle(void *ctx, uint32_t max_us);

/** @brief Call it from interrupt 50 (TIM5), which fathom_stm32f4_idle() enables. */
void fathom_stm32f4_tim5_interrupt(void);

/* ---- a bus ---- */

/**
 * @brief A USART with a line on it, in the caller's memory: all that a driver needs.
 *
 * Pass `modbus` to the drivers that send Modbus requests, and `line` to those that listen or use the protocol `55 AA`.
 * Several drivers may share the bus. The line is made of parts (line.h) for a transceiver of unknown kind: it finds out
 * whether there is an echo, names `senders`, uses the error flags of the UART, and keeps fathom_silence_us() before a
 * request. A program that needs other parts changes `parts` and calls fathom_line_init() with `&line` and `&parts`, before
 * it initialises a driver.
 *
 * The interrupt of the USART calls fathom_stm32f4_usart_interrupt(&bus.port), and interrupt 50 (TIM5) calls
 * fathom_stm32f4_tim5_interrupt().
 *
 * Do not move or copy a bus, because its members point to each other.
 */
typedef struct {
    /** @brief The line, initialised. */
    fathom_line_t line;
    /** @brief The Modbus RTU transport over `line`; not set by fathom_stm32f4_bus_init_listening(). */
    fathom_modbus_t modbus;
    /** @brief The parts of `line`. */
    fathom_line_parts_t parts;
    /** @brief The USART, for its interrupt. */
    fathom_stm32f4_usart_t port;
    /* private */
    fathom_uart_t uart;
    fathom_line_settings_t settings; /* with which the bus was initialised */
    uint8_t frame[32];   /* the longest frame of any sensor is the details of an HPS-167S, 27 bytes */
    uint8_t request[16]; /* the longest request is that of the reconnect time of an HPS-167S, 13 bytes */
} fathom_stm32f4_bus_t;

/**
 * @brief Initialises the UART and makes a line of it, for sensors that are asked.
 *
 * Call fathom_stm32f4_clock_init() before.
 *
 * @param bus       The bus, with any content. Must stay valid as long as its drivers.
 * @param wiring    Number, bus and pins of the USART. `line`, `request` and `request_size` are not used. Copied.
 * @param settings  The settings with which the sensors leave the factory (factory_line.h), or those that were set.
 *                  Copied.
 * @return False if the wiring is not possible, or if the settings cannot be reached or are slower than 9600 baud. Do not
 *         use the bus then.
 */
bool fathom_stm32f4_bus_init(fathom_stm32f4_bus_t *bus, const fathom_stm32f4_usart_config_t *wiring,
                             const fathom_line_settings_t *settings);

/**
 * @brief Initialises the UART and makes a line of it that only listens, for sensors that send by themselves.
 *
 * The program links nothing that sends. All else is as for fathom_stm32f4_bus_init().
 *
 * @param bus       The bus.
 * @param wiring    The wiring.
 * @param settings  The settings.
 * @return As fathom_stm32f4_bus_init().
 */
bool fathom_stm32f4_bus_init_listening(fathom_stm32f4_bus_t *bus, const fathom_stm32f4_usart_config_t *wiring,
                                       const fathom_line_settings_t *settings);

/**
 * @brief Waits for the next reading or error of a sensor, as fathom_wait(). Sleeps while it waits (fathom_stm32f4_idle()).
 *
 * The driver's header states the longest wait.
 *
 * @param bus     The bus of the sensor.
 * @param sensor  The sensor, such as the result of fathom_hps167s_sensor().
 * @param sample  Written with FATHOM_OK only.
 * @return Any result of fathom_poll() but FATHOM_PENDING.
 */
fathom_status_t fathom_stm32f4_bus_read(fathom_stm32f4_bus_t *bus, fathom_sensor_t sensor,
                                        fathom_sample_t *sample);

#ifdef __cplusplus
}
#endif

#endif
