/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_ARDUINO_H
#define FATHOM_ARDUINO_H

#include <Arduino.h>

#include "fathom/fathom.h"

/**
 * @file
 * @brief The HAL (hal.h) on an Arduino core, in C++11: serial ports, the clock, pins and pulses.
 *
 * The port uses HardwareSerial, any Stream, micros(), digital pins, and a pin interrupt for pulses.
 * `cmake --build build --target arduino-library` makes the library for Arduino; start with the sketches in its
 * examples/. All functions return at once, except that a SoftwareSerial blocks while it sends (stream_uart). None
 * allocates memory.
 *
 * @code
 * fathom::arduino::serial_uart bus(Serial1, 2);            // pin 2: driver enable of an RS-485 transceiver
 * fathom_uart_t uart;
 *
 * void setup()
 * {
 *     if (!bus.begin(9600)) return;
 *     uart = bus.hal();                                    // a line (line.h) uses &uart and &fathom::arduino::clock
 * }
 * @endcode
 *
 * 1. **Context.** Call all functions from setup() and loop(). Only functions whose comment says so may be called from
 *    an interrupt.
 *
 * 2. **Objects** are in the caller's memory and may be global: they do nothing before begin(). Do not move or copy them
 *    afterwards.
 *
 * 3. **CRC.** The library contains src/codec/crc16_small.c, the CRC with a table of 16 entries. An AVR keeps constant
 *    tables in RAM: 16 entries take 32 bytes, and 256 entries would take 512 of 2048 bytes. The smaller table needs
 *    more time for each byte, which no baud rate here shows.
 *
 * 4. **What has run.** The AVR core 1.8 on an ATmega328P at 16 MHz, on a simulator that is exact to the cycle. For a
 *    Mega and a Leonardo the code compiles. It has not run on hardware, nor with another core. Other statements about
 *    "AVR" are from the sources of that core.
 */
namespace fathom
{
namespace arduino
{

/**
 * @brief The clock: micros(). It wraps as hal.h describes.
 *
 * An AVR counts in steps of 4 us at 16 MHz and of 8 us at 8 MHz. The AVR core counts wrongly at clocks that do not
 * divide 64 MHz: by 6 % at 20 MHz. It needs an interrupt every 1.024 ms (at 16 MHz). If interrupts are disabled for
 * longer, the clock loses time.
 */
extern const fathom_clock_t clock;

/**
 * @brief Makes a pin an output and returns it. Call it in setup().
 *
 * The output starts high, which is the idle level of triggers and selects. Each `set` is one digitalWrite(), about 4 us
 * on an AVR.
 *
 * @param pin  Arduino number of the pin.
 * @return The pin for the HAL, by value. It points to no memory.
 */
fathom_pin_t output(uint8_t pin);

/**
 * @brief Makes a pin an input and returns it. Call it in setup().
 *
 * Each `get` is one digitalRead(), about 4 us on an AVR.
 *
 * @param pin      Arduino number of the pin.
 * @param pull_up  True to enable the pull-up resistor, for a contact to ground.
 * @return The pin for the HAL, by value. It points to no memory.
 */
fathom_pin_t input(uint8_t pin, bool pull_up = false);

/**
 * @brief A pin whose high pulses are measured by its interrupt (A16 1).
 *
 * It replaces pulseIn(), which blocks, and which lost 1.2 % to the interrupts of Timer0 and Serial in a measurement.
 * attachInterrupt() passes no argument to its function, so the sketch has a function for each pin:
 *
 * @code
 * fathom::arduino::pulse_input echo;
 * void echo_changed() { echo.changed(); }
 * // in setup():
 * echo.begin(2);
 * attachInterrupt(digitalPinToInterrupt(2), echo_changed, CHANGE);
 * capture = echo.capture();
 * @endcode
 *
 * On an AVR at 16 MHz a width is off by the steps of micros(), 4 us, and at each edge by an interrupt that runs when
 * the edge comes: 7 us by that of Timer0, 5 us by that of Serial. The interrupt of the pin is the first of those that
 * wait, so there is one such delay: usually 4 us in all, which is 0.7 mm, and at worst 11 us, which is 1.9 mm (6 us
 * were observed). Other delays add to this: about 20 us by another pulse_input, 1 ms by a byte of SoftwareSerial. The
 * capture hardware of Timer1 is more exact (port/avr).
 *
 * On an ESP8266 or ESP32 interrupt functions must be in RAM; fathom_edges_feed() is not.
 */
class pulse_input
{
  public:
    /**
     * @brief Makes a pin an input and discards all edges. Call it before attachInterrupt().
     * @param pin  Arduino number of the pin.
     */
    void begin(uint8_t pin);

    /** @brief Stores an edge: first its time, then the level. Call it from the interrupt of the pin, in mode CHANGE. */
    void changed();

    /**
     * @brief Returns the capture for fathom_a16_pwm_init(). Call it after begin().
     * @return The capture, by value. This object must stay valid as long as the capture is used.
     */
    fathom_capture_t capture();

    /** @brief The edges (edges.h). Its counters `lost` and `missed` may be read. `same_us` may be changed between
     * begin() and attachInterrupt(). */
    fathom_edges_t edges;

  private:
    uint8_t pin_;
    fathom_pin_t level_;
};

/** @brief Constants of pins. */
enum : uint8_t {
    no_pin = 255 /**< No pin. */
};

/**
 * @brief A HardwareSerial (Serial, Serial1, ...) that is used for nothing else, not even for printing.
 *
 * - **read** returns the bytes that the core has kept. An AVR with 1 KiB of RAM or more keeps 63 bytes: 65 ms at 9600
 *   baud, 36 ms at 19200 8E1, 5.5 ms at 115200. Later bytes are lost. The core reports nothing about single bytes, so
 *   no flag is set. The core drops bytes with wrong parity; their frame is then too short.
 * - **write** accepts all bytes, or returns 0 if the buffer of the core has no space for all of them. It returns a
 *   negative number for more bytes than the empty buffer holds, 63 on an AVR and 15 on small ones; the line reports
 *   that as FATHOM_ERR_PORT. The longest request to any of the sensors has 13 bytes. If availableForWrite() of a core
 *   reports nothing, `write` always fails; a sensor with automatic output can still be read.
 * - **sent** uses the time, because flush() of the core blocks. It is true when the buffer is empty and the time of the
 *   frame has passed since `write`, plus 2.5 % (for the clock of the UART) and 2 bits. It is late by this addition:
 *   0.33 ms for 8 characters at 19200 8E1. It can be early if interrupts were disabled for longer while the frame was
 *   sent; during a frame of this library only SoftwareSerial does that.
 * - **leaves_in_us** returns the rest of that time.
 * - **set_line** calls begin() of the core without end(), which blocks and discards received bytes. On an AVR it
 *   returns a negative number if no divider is within 2.5 %: 230400 baud at 16 MHz, 115200 at 8 MHz. For other cores it
 *   assumes that the rate can be reached.
 * - **set_break** is NULL, because cores have no function for it. Use a pin, output(), for triggers and selects.
 *
 * **RS-485.** The driver-enable pin (DE) is high while a request is sent. Connect /RE to it too if there should be no
 * echo; RX then needs a pull-up resistor. `write` sets the pin. The first call of `read`, `sent`, `set_line` or
 * release() after the time of `sent` clears the pin; fathom_poll() makes such a call each time while a request is sent.
 * No interrupt of the core does this. A slow loop therefore clears the pin late by its own period, and the response of
 * a device that responds meanwhile is lost. The period of loop() must be shorter than the pause of the device before
 * its response, less the delay of `sent`:
 *
 * | sensor                    | longest period of loop()                          |
 * |---------------------------|---------------------------------------------------|
 * | HPS-167S at 19200 baud    | 1.6 ms (the sensor keeps t3.5, 2.0 ms)            |
 * | HPS-167S at 115200 baud   | 1.6 ms                                            |
 * | A05, `55 AA`              | 60 ms (the sensor waits 65 ms or more, A05 2(3))  |
 * | A16 and A05, Modbus       | 3.4 ms (t3.5 at 9600 baud)                        |
 *
 * If loop() takes longer, call release() from a timer interrupt every millisecond, or use a transceiver that switches
 * by itself. An AVR has an interrupt of Timer0 for this, which the core does not use:
 *
 * @code
 * ISR(TIMER0_COMPA_vect) { bus.release(); }
 * // in setup():
 * OCR0A = 0x80;
 * TIMSK0 |= _BV(OCIE0A);
 * @endcode
 */
class serial_uart
{
  public:
    /**
     * @brief Names the serial port. Does nothing with it yet.
     *
     * @param serial         The serial port. Must stay valid as long as this object.
     * @param driver_enable  Arduino number of the driver-enable pin. no_pin: there is no transceiver.
     */
    explicit serial_uart(HardwareSerial &serial, uint8_t driver_enable = no_pin);

    /**
     * @brief Calls begin() of the core and sets the driver-enable pin low. Call it in setup(), before anything is
     * written.
     *
     * @param baud       Baud rate.
     * @param parity     Parity.
     * @param stop_bits  1 or 2.
     * @return False if these settings cannot be reached. Then nothing changed except the driver-enable pin.
     */
    bool begin(uint32_t baud, fathom_parity_t parity = FATHOM_PARITY_NONE, uint8_t stop_bits = 1);

    /**
     * @brief Returns the UART functions for a fathom_line_parts_t.
     * @return The functions, by value. This object must stay valid as long as they are used.
     */
    fathom_uart_t hal();

    /**
     * @brief Clears the driver-enable pin if the request has left.
     *
     * May be called from an interrupt, whatever loop() does at this moment. On an AVR it takes about 10 us while a
     * request is sent, else 1 us.
     *
     * @return True if no request is being sent.
     */
    bool release();

  private:
    HardwareSerial &serial_;
    const uint8_t driver_enable_;
    volatile bool leaving_;
    volatile uint32_t
        since_us_; /* An interrupt may call release(), so this is set only while leaving_ is false. */
    volatile uint32_t span_us_;
    int capacity_; /* of the core's buffer when it is empty */
    fathom_line_settings_t line_;

    bool set(const fathom_line_settings_t &line);
    static int read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx);
    static int write(void *ctx, const uint8_t *bytes, size_t length);
    static bool sent(void *ctx);
    static uint32_t leaves_in_us(void *ctx);
    static int set_line(void *ctx, const fathom_line_settings_t *settings);
};

/**
 * @brief Any Stream whose begin() the sketch has called: SoftwareSerial, or the USB serial of a board.
 *
 * It has no `set_line`, no `set_break` and no driver enable.
 *
 * - **write** passes all bytes to the Stream, and takes as long as the Stream does. SoftwareSerial sends bit by bit: a
 *   request of 8 bytes at 9600 baud blocks for 8.3 ms, during which nothing is received. `write` returns a negative
 *   number if the Stream accepted fewer bytes.
 * - **sent** is true when the time of the frame at `baud` has passed since `write` was called, with the addition of
 *   serial_uart.
 * - **leaves_in_us** returns the rest of that time.
 *
 * SoftwareSerial on an AVR keeps 63 bytes, receives with one instance at a time, and disables interrupts while a byte
 * arrives. It works up to 57600 baud, and not together with a pulse_input. It has no parity, so it cannot read an
 * HPS-167S. It suits a sensor with automatic output at 9600 baud.
 */
class stream_uart
{
  public:
    /**
     * @brief Names the Stream. Does nothing with it yet.
     *
     * @param stream  The Stream. Must stay valid as long as this object.
     * @param baud    Its baud rate.
     * @param bits    Bits of one character with start, parity and stop bits; 10 for 8N1.
     */
    stream_uart(Stream &stream, uint32_t baud, uint8_t bits = 10);

    /**
     * @brief Returns the UART functions for a fathom_line_parts_t.
     * @return The functions, by value. This object must stay valid as long as they are used.
     */
    fathom_uart_t hal();

  private:
    Stream &stream_;
    const uint32_t baud_;
    const uint8_t bits_;
    bool leaving_;
    uint32_t since_us_;
    uint32_t span_us_;

    static int read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx);
    static int write(void *ctx, const uint8_t *bytes, size_t length);
    static bool sent(void *ctx);
    static uint32_t leaves_in_us(void *ctx);
};

} // namespace arduino
} // namespace fathom

#endif
