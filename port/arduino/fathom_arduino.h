/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_ARDUINO_H
#define FATHOM_ARDUINO_H

#include <Arduino.h>

#include "fathom/fathom.h"

/*
 * The HAL on an Arduino core, in C++11: HardwareSerial, any Stream, micros(), digital pins, and a pin interrupt for
 * the pulse. The library is installed as `cmake --build build --target arduino-library` lays it out; the sketches in
 * its examples/ are where to start.
 *
 * What has been seen: the AVR core 1.8 on an ATmega328P at 16 MHz, simulated to the cycle; for a Mega and a Leonardo it
 * compiles. Not seen on hardware, nor with another core. What else is said of "AVR" here was read in that core's
 * sources.
 *
 * All functions return at once, but for what SoftwareSerial does by itself (below). They belong to setup() and loop();
 * those for interrupts say so. Objects are the caller's, may be global, do nothing before begin(), and may not be
 * moved or copied afterwards.
 *
 * What is compiled in: src/codec/crc16_small.c, the CRC with 16 entries. An AVR keeps const tables in RAM, where 256
 * entries take 512 bytes of 2048; 16 take 32. It takes more time a byte, which none of these baud rates shows.
 */
namespace fathom
{
namespace arduino
{

/*
 * micros(): wraps as hal.h has it. In steps of 4 us on an AVR at 16 MHz and of 8 us at 8 MHz. The AVR core counts
 * wrongly at clocks that do not divide 64 MHz: by 6 % at 20 MHz. It needs an interrupt every 1.024 ms (at 16 MHz):
 * who disables them longer makes it lose time.
 */
extern const fathom_clock_t clock;

/*
 * A pin by its Arduino number, stateless. To be called in setup(), since it sets the pin's mode. An output begins high,
 * as triggers and selects want it. Each set or get is one digitalWrite or digitalRead, 4 us or so on an AVR. Pull-up:
 * for a contact to ground.
 */
fathom_pin_t output(uint8_t pin);
fathom_pin_t input(uint8_t pin, bool pull_up = false);

/*
 * A pin whose high pulses are measured by its interrupt (A16 1), without pulseIn(), which blocks, and which has been
 * seen to lose 1.2 % to the interrupts of Timer0 and Serial. attachInterrupt() gives its function no argument, so
 * each pin has a function of its own, in the sketch:
 *
 *     fathom::arduino::pulse_input echo;
 *     void echo_changed() { echo.changed(); }
 *     ... echo.begin(2);
 *         attachInterrupt(digitalPinToInterrupt(2), echo_changed, CHANGE);
 *         capture = echo.capture();
 *
 * On an AVR at 16 MHz a width is off by the 4 us steps of micros(), and at either edge by another interrupt that runs
 * when it comes: 7 us by Timer0's, 5 by Serial's. Of those that wait the pin's is first, so there is one such delay:
 * 4 us mostly, 0.7 mm, and 11 us, 1.9 mm, at worst (seen: 6). What else there is adds itself: 20 us or so of another
 * pulse_input, 1 ms of a byte of SoftwareSerial. port/avr does better, with the capture hardware of Timer1.
 * Where interrupt functions have to lie in RAM (ESP8266, ESP32), fathom_edges_feed does not.
 */
class pulse_input
{
  public:
    /* Makes the pin an input, and forgets all edges; before attachInterrupt(). */
    void begin(uint8_t pin);

    /* An edge has come: for the interrupt, in mode CHANGE. The time is taken first, then the level. */
    void changed();

    /* For a fathom_a16_pwm_config_t or fathom_pulse_config_t; after begin(). */
    fathom_capture_t capture();

    /* Its counters: `lost`, `missed`; `same_us` may be changed between begin() and attachInterrupt(). */
    fathom_edges_t edges;

  private:
    uint8_t pin_;
    fathom_pin_t level_;
};

/* No pin. */
enum : uint8_t { no_pin = 255 };

/*
 * A HardwareSerial (Serial, Serial1, ...) that is used for nothing else, also not for printing.
 *
 * read       what the core has kept: 63 bytes on an AVR with 1 KiB of RAM or more, 65 ms at 9600 baud, 36 ms at
 *            19200 8E1, 5.5 ms at 115200; what comes then is lost. The core tells nothing of single bytes: no flags.
 *            Those with wrong parity it drops, so that their frame is too short.
 * write      takes what fits into the core's buffer, all or nothing (0). Of more than the empty buffer holds it says
 *            < 0, which the line makes FATHOM_ERR_PORT: 63 bytes on an AVR, 15 on small ones. The longest request to
 *            any of the sensors has 13. On a core whose availableForWrite() tells nothing, it says < 0 always, and
 *            what sends by itself can be read.
 * sent       by time, since the core's flush() blocks: the buffer is empty, and so much time has passed since write as
 *            the frame takes, with 2.5 % more (the clock of the UART) and 2 bits. So it turns true late by that: by
 *            0.33 ms for 8 characters at 19200 8E1. It can be early if interrupts were off for longer while
 *            the frame left; in a frame of ours nothing but SoftwareSerial does that.
 * leaves_in_us  the rest of that time.
 * set_line   begin() of the core, without end(), which blocks and throws away what was received. < 0 on an AVR where
 *            no divider comes within 2.5 %: 230400 at 16 MHz, 115200 at 8 MHz. Other cores are believed.
 * set_break  NULL: cores have nothing for that. Triggers and selects take a pin, output().
 *
 * RS-485: the driver-enable pin (DE, with /RE if there is to be no echo; then RX wants a pull-up) is high while a
 * request leaves. It is raised in write, and dropped by the first call of read, sent, set_line or release() after
 * `sent` is true; fathom_poll makes one each time while a request leaves. No interrupt of the core does it, so a slow
 * loop drops it late by its own period, and a device that answers meanwhile collides with it: the response is lost.
 * How long the loop may take at most: what the device waits before its response, less the lateness of `sent`:
 *     HPS-167S at 19200    1.6 ms (it keeps t3.5, 2.0 ms)          at 115200    1.6 ms
 *     A05 55 AA            60 ms (65 ms or more, A05 2(3))         A16, A05 Modbus: 3.4 ms (t3.5 at 9600)
 * If it takes longer: release() from a timer interrupt every millisecond, or a transceiver that switches by itself.
 * On an AVR the interrupt is Timer0's, which the core leaves free:
 *
 *     ISR(TIMER0_COMPA_vect) { bus.release(); }
 *     ... OCR0A = 0x80;
 *         TIMSK0 |= _BV(OCIE0A);
 */
class serial_uart
{
  public:
    explicit serial_uart(HardwareSerial &serial, uint8_t driver_enable = no_pin);

    /* begin() of the core, in setup() and before anything is written; sets the driver-enable pin low. false: these
     * settings cannot be reached; nothing but that pin has changed. */
    bool begin(uint32_t baud, fathom_parity_t parity = FATHOM_PARITY_NONE, uint8_t stop_bits = 1);

    /* For a fathom_line_parts_t. */
    fathom_uart_t hal();

    /* Drops driver-enable if it is time. true: nothing is leaving. Also for an interrupt, whatever the loop is doing
     * then; 10 us or so on an AVR while a request leaves, 1 us else. */
    bool release();

  private:
    HardwareSerial &serial_;
    const uint8_t driver_enable_;
    volatile bool leaving_;
    volatile uint32_t since_us_; /* release() may be an interrupt's: set while leaving_ is false */
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

/*
 * Any Stream whose begin() the sketch has called: SoftwareSerial, the USB serial of a board. It has no set_line, no
 * set_break and no driver-enable.
 *
 * write      gives the Stream all at once, and takes as long as that does. SoftwareSerial sends bit by bit: a
 *            request of 8 bytes at 9600 baud blocks for 8.3 ms, in which nothing is received. < 0 if the Stream took
 *            less than all.
 * sent       when the time of the frame at `baud` has passed since write began, as above; leaves_in_us too.
 *
 * SoftwareSerial on an AVR keeps 63 bytes, has no parity (so no HPS-167S), hears one instance at a time, and keeps
 * interrupts off while a byte comes in: up to 57600 baud, and no pulse_input beside it. A sensor that sends by itself
 * at 9600 is what it is good for.
 */
class stream_uart
{
  public:
    /* bits: of a character with its start, parity and stop bits; 10 for 8N1. */
    stream_uart(Stream &stream, uint32_t baud, uint8_t bits = 10);

    /* For a fathom_line_parts_t. */
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
