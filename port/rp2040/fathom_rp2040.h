/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_RP2040_H
#define FATHOM_RP2040_H

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
 * @brief The HAL (hal.h) on an RP2040, on bare registers: clock, UARTs, pins, edges and idle.
 *
 * The port needs no SDK and no C library. All state is in the caller's memory. No function waits except
 * fathom_rp2040_idle(), and none allocates memory. The section "On the chip" of include/COST.md has the cycles of the
 * interrupts and of a reading.
 *
 * | file           | uses                                        | for                                                |
 * |----------------|---------------------------------------------|----------------------------------------------------|
 * | `clock.c`      | the low word of TIMER                       | the clock                                          |
 * | `uart.c`       | UART0, UART1, an alarm for each transceiver | UARTs, with RS-485                                 |
 * | `uart_setup.c` | the registers of a UART                     | a reception of your own, for example by DMA        |
 * | `pin.c`        | SIO                                         | triggers, selects, contacts of switches and relays |
 * | `edges.c`      | the interrupt of IO_BANK0 on both edges     | pulses                                             |
 * | `idle.c`       | an alarm                                    | sleep until an interrupt or a given time           |
 *
 * A program contains only the files whose functions it calls.
 *
 * @code
 * static uint8_t request[8];
 * static fathom_rp2040_idle_t idle = {.alarm = 0};
 * static fathom_rp2040_uart_t port;
 * static fathom_uart_t uart;
 * const fathom_rp2040_uart_config_t config = {
 *     .wiring = {.clk_peri_hz = 125000000, .number = 1, .tx = 4, .rx = 5}, .line = {19200, FATHOM_PARITY_EVEN, 1},
 *     .request = request, .request_size = sizeof request, .idle = &idle};
 * fathom_rp2040_clock_init(12000000);
 * fathom_rp2040_idle_init(&idle);
 * if (!fathom_rp2040_uart_init(&port, &config)) return 1;
 * uart = fathom_rp2040_uart(&port);         // a line (line.h) uses &uart and &fathom_rp2040_clock
 * status = fathom_wait(&sensor, &sample, fathom_rp2040_idle, &idle);
 * @endcode
 *
 * 1. **Start-up.** The start-up code (boot2, clocks, VTOR; that of the SDK will do) has started clk_ref and clk_peri.
 *
 * 2. **Interrupts.** The vectors belong to the application. They call the functions whose names end in `_interrupt` or
 *    `_alarm`. The init functions enable the interrupts in the NVIC. If one is missing, the linker does not say so, and
 *    the program waits for ever. With the maker's SDK, before the init functions:
 *
 *        static void on_uart1(void) { fathom_rp2040_uart_interrupt(&bus.port); }
 *        static void on_alarm0(void) { fathom_rp2040_uart_alarm(&bus.port); }
 *        static void on_alarm1(void) { fathom_rp2040_idle_alarm(&bus.idle); }
 *
 *        irq_set_exclusive_handler(UART1_IRQ, on_uart1);
 *        irq_set_exclusive_handler(TIMER_IRQ_0, on_alarm0);
 *        irq_set_exclusive_handler(TIMER_IRQ_1, on_alarm1);
 *
 *    The SDK itself uses alarm 3 for its time (PICO_TIME_DEFAULT_ALARM_POOL_HARDWARE_ALARM_NUM).
 *
 * 3. **Context.** All other functions belong to the main loop. Use one core, core 0, for all of them.
 *
 * 4. **What has run.** Everything has run on a simulator of the RP2040 with a model of the PL011 that was written from
 *    its manual (FIFOs, levels, time-out, BUSY, errors, divider). Nothing has run on hardware: pads, levels and the
 *    access times of the flash were not observed.
 */

/** @brief Limits of the chip. */
enum {
    FATHOM_RP2040_GPIOS = 30, /**< Number of GPIOs. */
    FATHOM_RP2040_ALARMS = 4  /**< Number of alarms of TIMER. */
};

/* ---- clock ---- */

/**
 * @brief Starts TIMER and its ticks of 1 us. Call it before all other functions.
 *
 * @param ref_hz  Frequency of clk_ref in Hz, a multiple of 1000000 up to 511000000: 12000000 with the usual crystal. 0:
 *                the ticks run already, as they do after the start-up of the SDK.
 */
void fathom_rp2040_clock_init(uint32_t ref_hz);

/** @brief The clock in microseconds. It wraps as hal.h describes. While a debugger halts a core, the clock stands still
 * (DBGPAUSE of TIMER). */
extern const fathom_clock_t fathom_rp2040_clock;

/* ---- idle ---- */

/** @brief State of the sleep, in the caller's memory. For fathom_wait() (wait.h), or for a main loop that has nothing
 * to do. */
typedef struct {
    /** @brief Number of an alarm that is used for nothing else, 0 to 3. Set it before fathom_rp2040_idle_init(). */
    uint8_t alarm;

    /** @brief True if something has happened since fathom_rp2040_idle() returned. UARTs and edges set it; other
     * interrupts of the program may set it. */
    volatile bool has_news;
} fathom_rp2040_idle_t;

/** @brief Enables the alarm of `idle`. */
void fathom_rp2040_idle_init(fathom_rp2040_idle_t *idle);

/**
 * @brief Sleeps (WFI) until an interrupt comes or `max_us` has passed. Returns at once if `has_news` is true.
 *
 * An interrupt after the last check of `has_news` ends the sleep too: the check and the WFI run with PRIMASK set, and a
 * pending interrupt ends WFI even then. Interrupts are enabled when the function returns.
 *
 * @param ctx     A fathom_rp2040_idle_t.
 * @param max_us  Longest sleep in microseconds. Values above 2^31 - 1 count as 2^31 - 1. FATHOM_NO_DEADLINE: until an
 *                interrupt.
 */
void fathom_rp2040_idle(void *ctx, uint32_t max_us);

/** @brief Call it from the interrupt TIMER_IRQ_n of the alarm of `idle`. */
void fathom_rp2040_idle_alarm(fathom_rp2040_idle_t *idle);

/* ---- pins ---- */

/**
 * @brief Makes a GPIO an output and returns it. The output starts without a glitch.
 *
 * @param gpio  Number of the GPIO, 0 to 29. The call ends any other function of it.
 * @param high  The first level. True is the idle level of triggers and selects.
 * @return The pin for the HAL, by value. It points to no memory.
 */
fathom_pin_t fathom_rp2040_output(unsigned gpio, bool high);

/**
 * @brief Makes a GPIO an input and returns it.
 *
 * @param gpio     Number of the GPIO, 0 to 29. The call ends any other function of it.
 * @param pull_up  True: with the pull-up resistor. False: without any pull resistor.
 * @return The pin for the HAL, by value. It points to no memory.
 */
fathom_pin_t fathom_rp2040_input(unsigned gpio, bool pull_up);

/* ---- UARTs ---- */

/** @brief Pins and clock of a UART. */
typedef struct {
    /** @brief Frequency of clk_peri in Hz, at most 1 GHz. 125000000 after the start-up of the SDK. */
    uint32_t clk_peri_hz;
    /** @brief 0 for UART0, 1 for UART1. */
    uint8_t number;
    /** @brief GPIO of TX. UART0: 0, 12, 16 or 28. UART1: 4, 8, 20 or 24. */
    uint8_t tx;
    /** @brief GPIO of RX. UART0: 1, 13, 17 or 29. UART1: 5, 9, 21 or 25. It gets the pull-up resistor. */
    uint8_t rx;
    /** @brief True if there is an RS-485 transceiver. If false, `driver` and `alarm` are not used. */
    bool has_driver;
    /** @brief GPIO of the driver enable (DE), high while bytes are sent. Connect /RE to it too if there should be no
     * echo. */
    uint8_t driver;
    /** @brief Number of an alarm that is used for nothing else, 0 to 3. It ends the driver enable. A bus also uses the
     * next one, (`alarm` + 1) % 4, for its sleep. */
    uint8_t alarm;
} fathom_rp2040_wiring_t;

/** @brief Configuration of a UART. Copied by fathom_rp2040_uart_init(). */
typedef struct {
    /** @brief Pins and clock. */
    fathom_rp2040_wiring_t wiring;
    /** @brief The first line settings. */
    fathom_line_settings_t line;
    /** @brief Buffer for a copy of the longest request, which stays there while it is sent. 8 bytes suffice for all
     * reads and single writes. Must stay valid as long as the port is used. */
    uint8_t *request;
    /** @brief Size of `request` in bytes, 1 to 255. */
    uint8_t request_size;
    /** @brief The sleep that ends when bytes were received and, with a transceiver, when a request has left. NULL:
     * none. Must stay valid as long as the port is used. */
    fathom_rp2040_idle_t *idle;
} fathom_rp2040_uart_config_t;

/** @brief Constants of a UART. */
enum {
    /** @brief Number of bytes that can wait for the main loop: 5.5 ms at 115200 baud.
     *
     * 32 more bytes can wait in the hardware. The size must be a power of two below 256, because the indices are single
     * bytes that wrap. */
    FATHOM_RP2040_RX_RING = 64
};

/** @brief A UART, in the caller's memory. */
typedef struct {
    /** @brief Bytes with wrong parity since fathom_rp2040_uart_init(). Stops at 65535. The caller may set it to 0. */
    uint16_t parity;
    /** @brief Bytes without a stop bit: breaks, noise, or another baud rate. Counts like `parity`. */
    uint16_t framing;
    /** @brief Bytes before which others were lost, because ring and FIFO were full. Counts like `parity`. */
    uint16_t overruns;

    /* private */
    fathom_rp2040_uart_config_t config;
    fathom_line_settings_t line;                   /* the settings that are in force */
    volatile uint16_t ring[FATHOM_RP2040_RX_RING]; /* a byte, and above it the error bits of DR */
    volatile uint8_t written;                      /* count of bytes written to the ring; wraps */
    volatile uint8_t taken;                        /* count of bytes taken from the ring; wraps */
    /* If is_silent: the receive time-out came after silent_at bytes, the last of which ended at silent_us. */
    uint8_t silent_at;
    uint32_t silent_us;
    bool is_silent;
    uint32_t end_us;         /* when the request will have left, and one bit later */
    volatile uint8_t length; /* of the request */
    volatile uint8_t given;  /* count of its bytes that the hardware has */
    volatile bool is_break;
} fathom_rp2040_uart_t;

/**
 * @brief Resets and initialises a UART. Enables UARTn_IRQ and, with a transceiver, the interrupt of the alarm.
 *
 * @param uart    The UART, with any content. Must stay valid as long as it is used.
 * @param config  The configuration, read only during the call; what it points to must stay valid.
 * @return False if the UART must not be used, for one of these reasons: the line settings cannot be reached; a pin does
 *         not belong to this UART; there is no buffer for a request; the UART does not leave reset, because it has no
 *         clock.
 */
bool fathom_rp2040_uart_init(fathom_rp2040_uart_t *uart, const fathom_rp2040_uart_config_t *config);

/**
 * @brief Returns the UART functions (hal.h) of a UART.
 *
 * - **read** reads the FIFO of the hardware too, so a loop that polls gets each byte when it arrives. A sleeping
 *   program wakes after every fourth byte, and 32 bits after the last byte (1.7 ms at 19200 baud), when the receive
 *   time-out comes. `read` reports the time of that last byte (FATHOM_RX_TIMED), so the silence before the next request
 *   does not become longer. The time is late by other interrupts, and by the time for which the ring was full. A read
 *   ends before and after a byte with FATHOM_RX_PARITY, FATHOM_RX_FRAMING or FATHOM_RX_OVERRUN. It never reports
 *   FATHOM_RX_SILENCE.
 * - **write** accepts 1 to `request_size` bytes, and returns a negative number for any other count. The first byte
 *   leaves at once. If the request is longer than the FIFO of 32 bytes, an interrupt fills it. The driver enable is
 *   high from before the first byte until BUSY has ended. The PL011 has no interrupt for that end, so the alarm comes
 *   when the end is due, and again one bit later while BUSY lasts. The driver enable is therefore high at most one bit
 *   longer, plus the time of other interrupts. No sensor of this library responds sooner than that.
 * - **sent** is exact (BUSY).
 * - **leaves_in_us** uses the clock. It is at most one bit too long.
 * - **set_line** accepts rates within 2.5 %, from clk_peri / 1048560 to clk_peri / 16 baud. The hardware stops during
 *   the change, so a byte that is arriving becomes garbage.
 * - **set_break** sets LCR_H.BRK. The driver enable is high meanwhile. The PL011 requires a break of at least two
 *   characters.
 *
 * @param uart  The UART. It must stay valid as long as the functions are used.
 * @return The functions, by value. A line needs them in memory that stays valid.
 */
fathom_uart_t fathom_rp2040_uart(fathom_rp2040_uart_t *uart);

/** @brief Call it from the interrupt UARTn_IRQ. It moves at most 32 bytes in each direction. */
void fathom_rp2040_uart_interrupt(fathom_rp2040_uart_t *uart);

/** @brief Call it from the interrupt TIMER_IRQ_n of the alarm of this UART, if there is a transceiver. */
void fathom_rp2040_uart_alarm(fathom_rp2040_uart_t *uart);

/**
 * @brief Sets up only the registers of a UART, for a reception of your own.
 *
 * The pins are set, the FIFOs have their lowest levels (4 bytes), the UART is enabled, all its interrupts are masked,
 * and the driver enable is low.
 *
 * @param wiring  Pins and clock. Used only during the call.
 * @param line    Line settings. Used only during the call.
 * @return False if the line settings cannot be reached, a pin does not belong to this UART, or the UART has no clock.
 */
bool fathom_rp2040_uart_setup(const fathom_rp2040_wiring_t *wiring, const fathom_line_settings_t *line);

/**
 * @brief Changes the line settings in the registers of a UART. Nothing may be leaving.
 *
 * @param wiring  Clock and number of the UART. Used only during the call.
 * @param line    Line settings. Used only during the call.
 * @return False if the line settings cannot be reached. Then nothing changed.
 */
bool fathom_rp2040_uart_set_line(const fathom_rp2040_wiring_t *wiring, const fathom_line_settings_t *line);

/* ---- pulses ---- */

/** @brief A pin whose edges are fed to a fathom_edges_t, in the caller's memory. All members are private. */
typedef struct {
    /* private */
    fathom_edges_t *edges;
    fathom_rp2040_idle_t *idle; /* NULL: none */
    uint8_t gpio;
} fathom_rp2040_edges_t;

/**
 * @brief Feeds both edges of a GPIO to `edges`. Enables IO_IRQ_BANK0.
 *
 * @param pin    The pin, with any content. Must stay valid as long as edges are fed.
 * @param edges  Initialised edges (edges.h), with a pin or without. Must stay valid as long as edges are fed.
 * @param gpio   Number of the GPIO, which fathom_rp2040_input() has made an input.
 * @param idle   The sleep that ends when an edge was fed; NULL: none. Must stay valid as long as edges are fed.
 */
void fathom_rp2040_edges_init(fathom_rp2040_edges_t *pin, fathom_edges_t *edges, unsigned gpio,
                              fathom_rp2040_idle_t *idle);

/**
 * @brief Call it from the interrupt IO_IRQ_BANK0, once for each pin.
 *
 * The time of an edge is that of the interrupt: an edge is late by the time of the code that runs with interrupts
 * disabled or at the same priority. Give IO_IRQ_BANK0 a priority above the others (NVIC_IPR); then widths are right
 * within 1 us at any clk_sys above 50 MHz.
 *
 * If both edges wait when the function runs, it feeds only the present level of the pin. If that is the level before,
 * an edge was missed, and edges.h returns no width for it. If the level is another one, it was a pulse or a pause
 * shorter than the delay.
 */
void fathom_rp2040_edges_interrupt(fathom_rp2040_edges_t *pin);

/* ---- a bus ---- */

/**
 * @brief A UART with a line on it, in the caller's memory: all that a driver needs.
 *
 * Pass `modbus` to the drivers that send Modbus requests, and `line` to those that listen or use the protocol `55 AA`.
 * Several drivers may share the bus. The line is made of parts (line.h) for a transceiver of unknown kind: it finds out
 * whether there is an echo, names `senders`, uses the error flags of the UART, and keeps fathom_silence_us() before a
 * request. A program that needs other parts changes `parts` and calls fathom_line_init() with `&line` and `&parts`, before
 * it initialises a driver.
 *
 * The interrupts call the functions of the members: UARTn_IRQ calls fathom_rp2040_uart_interrupt(&bus.port), the alarm of
 * `wiring` calls fathom_rp2040_uart_alarm(&bus.port) if there is a transceiver, and the next alarm, (`alarm` + 1) % 4, calls
 * fathom_rp2040_idle_alarm(&bus.idle).
 *
 * Do not move or copy a bus, because its members point to each other.
 */
typedef struct {
    /** @brief The line, initialised. */
    fathom_line_t line;
    /** @brief The Modbus RTU transport over `line`; not set by fathom_rp2040_bus_init_listening(). */
    fathom_modbus_t modbus;
    /** @brief The parts of `line`. */
    fathom_line_parts_t parts;
    /** @brief The UART, for its interrupts. */
    fathom_rp2040_uart_t port;
    /** @brief The sleep of fathom_rp2040_bus_read(), for its alarm. */
    fathom_rp2040_idle_t idle;
    /* private */
    fathom_uart_t uart;
    fathom_line_settings_t settings; /* with which the bus was initialised */
    uint8_t frame[32];   /* the longest frame of any sensor is the details of an HPS-167S, 27 bytes */
    uint8_t request[16]; /* the longest request is that of the reconnect time of an HPS-167S, 13 bytes */
} fathom_rp2040_bus_t;

/**
 * @brief Initialises the UART and makes a line of it, for sensors that are asked.
 *
 * Call fathom_rp2040_clock_init() before.
 *
 * @param bus       The bus, with any content. Must stay valid as long as its drivers.
 * @param wiring    Pins, clock and alarm of the UART. Copied.
 * @param settings  The settings with which the sensors leave the factory (factory_line.h), or those that were set.
 *                  Copied.
 * @return False if the wiring is not possible, or if the settings cannot be reached or are slower than 9600 baud. Do not
 *         use the bus then.
 */
bool fathom_rp2040_bus_init(fathom_rp2040_bus_t *bus, const fathom_rp2040_wiring_t *wiring,
                            const fathom_line_settings_t *settings);

/**
 * @brief Initialises the UART and makes a line of it that only listens, for sensors that send by themselves.
 *
 * The program links nothing that sends. All else is as for fathom_rp2040_bus_init().
 *
 * @param bus       The bus.
 * @param wiring    The wiring.
 * @param settings  The settings.
 * @return As fathom_rp2040_bus_init().
 */
bool fathom_rp2040_bus_init_listening(fathom_rp2040_bus_t *bus, const fathom_rp2040_wiring_t *wiring,
                                      const fathom_line_settings_t *settings);

/**
 * @brief Waits for the next reading or error of a sensor, as fathom_wait(). Sleeps while it waits (fathom_rp2040_idle()).
 *
 * The driver's header states the longest wait.
 *
 * @param bus     The bus of the sensor.
 * @param sensor  The sensor, such as the result of fathom_hps167s_sensor().
 * @param sample  Written with FATHOM_OK only.
 * @return Any result of fathom_poll() but FATHOM_PENDING.
 */
fathom_status_t fathom_rp2040_bus_read(fathom_rp2040_bus_t *bus, fathom_sensor_t sensor,
                                       fathom_sample_t *sample);

#ifdef __cplusplus
}
#endif

#endif
