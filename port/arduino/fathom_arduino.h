/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_ARDUINO_H
#define FATHOM_ARDUINO_H

#include <Arduino.h>

#include "fathom/fathom.hpp"
#include "fathom/models.h"

/**
 * @file
 * @brief Fathom on an Arduino core, in C++11: a class for each sensor, buses, and the HAL (hal.h) below them.
 *
 * The port uses HardwareSerial, any Stream, micros(), digital pins, and a pin interrupt for pulses.
 * `cmake --build build --target arduino-library` makes the library for Arduino; start with the sketches in its
 * examples/. No function allocates memory. All functions return at once, with two exceptions: a SoftwareSerial blocks
 * while it sends (stream_uart), and so does a serial_uart with a driver-enable pin on a core without Timer0.
 *
 * @code
 * FathomBus bus(Serial1, 2);                    // pin 2: driver enable of an RS-485 transceiver
 * FathomHps167s gate(bus);
 *
 * void setup() { bus.begin(fathom_hps167s_factory_line) && gate.begin(); }
 *
 * void loop()
 * {
 *     if (!gate.available()) return;
 *     if (gate.hasTarget()) use(gate.distanceMm());
 *     else report(gate.resultName());           // such as NO_TARGET, NO_RESPONSE
 * }
 * @endcode
 *
 * 1. **Context.** Call all functions from setup() and loop(). Only functions whose comment says so may be called from
 *    an interrupt.
 *
 * 2. **Objects** are in the caller's memory and may be global: they do nothing before begin(). Do not move or copy them
 *    afterwards. An object with a pin or a serial port must stay valid for ever after begin().
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
 * Each `set` is one digitalWrite(), about 4 us on an AVR.
 *
 * @param pin      Arduino number of the pin.
 * @param is_high  The level at which it starts. High is the idle level of the triggers and selects of an A16 and A05.
 * @return The pin for the HAL, by value. It points to no memory.
 */
fathom_pin_t output(uint8_t pin, bool is_high = true);

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
 * At most 4 objects can be used, because attachInterrupt() passes no argument to its function.
 *
 * On an AVR at 16 MHz a width is off by the steps of micros(), 4 us, and at each edge by an interrupt that runs when
 * the edge comes: 7 us by that of Timer0, 5 us by that of Serial. The interrupt of the pin is the first of those that
 * wait, so there is one such delay: usually 4 us in all, which is 0.7 mm, and at worst 11 us, which is 1.9 mm (8 us
 * were observed). Other delays add to this: about 20 us by another pulse_input, 1 ms by a byte of SoftwareSerial. The
 * capture hardware of Timer1 is more exact (port/avr).
 *
 * On an ESP8266 or ESP32 interrupt functions must be in RAM; fathom_edges_feed() is not.
 */
class pulse_input
{
  public:
    /**
     * @brief Makes a pin an input, discards all edges, and attaches the interrupt of the pin.
     * @param pin  Arduino number of the pin: 2 or 3 on an Uno. If begin() is called again, the same pin.
     * @return False if the pin has no interrupt, or if there are 4 other objects.
     */
    bool begin(uint8_t pin);

    /**
     * @brief Returns the capture for fathom_a16_pwm_init(). Call it after begin().
     * @return The capture, by value. This object must stay valid as long as the capture is used.
     */
    fathom_capture_t capture();

    /** @brief The edges (edges.h). Its counters `lost` and `missed` may be read. */
    fathom_edges_t edges;

  private:
    static const uint8_t slot_count = 4;
    static pulse_input *slots_[slot_count];
    template <uint8_t slot> static void changed() { slots_[slot]->feed(); }

    uint8_t pin_;
    fathom_pin_t level_;

    void feed();
};

/** @brief Constants of pins. */
enum : uint8_t {
    no_pin = 255 /**< No pin. */
};

/**
 * @brief A HardwareSerial (Serial, Serial1, ...) that is used for nothing else, not even for printing.
 *
 * One exception: if its line only listens, the sketch may print by it, because TX is free (bus::begin_listening()).
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
 * echo; RX then needs a pull-up resistor. A device responds after a pause of 1.75 ms or more, so DE must be low by then,
 * however long loop() takes. No core does this by itself:
 *
 * - **AVR.** The compare interrupt A of Timer0 runs every 1.024 ms (at 16 MHz) while a request is sent, and clears the
 *   pin at most 1.5 ms after the last stop bit. fathom_poll() clears it earlier if loop() is fast. Timer0 is the clock
 *   of the core; only this interrupt of it is used. A sketch that constructs no port with a driver-enable pin may use
 *   TIMER0_COMPA_vect itself. With one it cannot, unless the library is compiled with the macro
 *   `FATHOM_ARDUINO_NO_TIMER0`; then the next paragraph applies.
 * - **Other cores** have no such timer. `write` waits until the request has left (flush()), and then clears the pin at
 *   once. It takes as long as the request: 4.6 ms for a measurement of an HPS-167S at 19200 baud, and at most 15 ms, for
 *   13 bytes of 11 bits at 9600 baud.
 *
 * With DE, and without it, loop() may take as long as the sensors allow (bus).
 */
class serial_uart
{
  public:
    /**
     * @brief Stores the serial port. Does nothing with it yet.
     * @param serial  The serial port. Must stay valid as long as this object.
     */
    explicit serial_uart(HardwareSerial &serial);

    /**
     * @brief Stores the serial port and the driver-enable pin. Does nothing with them yet.
     *
     * @param serial         The serial port. Must stay valid as long as this object.
     * @param driver_enable  Arduino number of the driver-enable pin. no_pin: there is no transceiver.
     */
    serial_uart(HardwareSerial &serial, uint8_t driver_enable);

    /**
     * @brief Calls begin() of the core and sets the driver-enable pin low. Call it in setup(), before anything is
     * written.
     *
     * @param settings  Baud rate, parity and stop bits. Copied.
     * @return False if these settings cannot be reached. Then nothing changed except the driver-enable pin.
     */
    bool begin(const fathom_line_settings_t &settings);

    /**
     * @brief Returns the UART functions for a fathom_line_parts_t.
     * @return The functions, by value. This object must stay valid as long as they are used.
     */
    fathom_uart_t hal();

    /**
     * @brief Clears the driver-enable pin if the request has left.
     *
     * May be called from an interrupt, whatever loop() does at this moment.
     *
     * @return True if no request is being sent.
     */
    bool release();

  private:
    friend struct driver_enable;
    HardwareSerial &serial_;
    const uint8_t driver_enable_;
    void (*const started_)(serial_uart &); /* called when a request was written; NULL without a pin */
    serial_uart *next_;                    /* of those that an interrupt releases */
    volatile bool leaving_;
    volatile uint32_t
        since_us_; /* An interrupt may call release(), so this is set only while leaving_ is false. */
    volatile uint32_t span_us_;
    int capacity_; /* of the core's buffer when it is empty */
    fathom_line_settings_t line_;

    serial_uart(HardwareSerial &serial, uint8_t driver_enable, void (*started)(serial_uart &));
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
 * - **sent** is true when the time of the frame has passed since `write` was called, with the addition of
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
     * @brief Stores the Stream. Does nothing with it yet.
     * @param stream  The Stream. Must stay valid as long as this object.
     */
    explicit stream_uart(Stream &stream);

    /**
     * @brief Stores the settings. Call it before hal().
     * @param settings  The settings that the sketch passed to begin() of the Stream.
     */
    void begin(const fathom_line_settings_t &settings);

    /**
     * @brief Returns the UART functions for a fathom_line_parts_t.
     * @return The functions, by value. This object must stay valid as long as they are used.
     */
    fathom_uart_t hal();

  private:
    Stream &stream_;
    uint32_t baud_;
    uint8_t bits_; /* of one character */
    bool leaving_;
    uint32_t since_us_;
    uint32_t span_us_;

    static int read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx);
    static int write(void *ctx, const uint8_t *bytes, size_t length);
    static bool sent(void *ctx);
    static uint32_t leaves_in_us(void *ctx);
};

/** @brief The line of a bus, with its parts: the base of bus and stream_bus. */
class bus_line
{
  public:
    /** @brief The line. */
    fathom_line_t line;

    /** @brief The Modbus RTU transport over `line`, for a bus that asks. */
    fathom_modbus_t modbus;

    /** @brief The parts of `line`. A sketch that needs others changes them and calls fathom_line_init() with `&line`. */
    fathom_line_parts_t parts;

  protected:
    /**
     * @brief Makes a line that sends requests of `uart_`.
     * @param settings  The settings of the port.
     * @return False if the settings are not allowed.
     */
    bool ask(const fathom_line_settings_t &settings);

    /**
     * @brief Makes a line that only listens of `uart_`.
     * @return False if the line refuses its parts.
     */
    bool listen();

    /**
     * @brief Makes the bus one that drivers refuse.
     * @return False.
     */
    bool refuse();

    /** @brief The UART of the line. */
    fathom_uart_t uart_;

  private:
    uint8_t frame_[32]; /* the longest frame of any sensor is the details of an HPS-167S, 27 bytes */
    fathom_line_settings_t settings_; /* with which the bus was begun */

    void name_parts();
};

/**
 * @brief A HardwareSerial with a line on it: all that the sensors of one serial port need.
 *
 * The line is made of parts (line.h) for a transceiver of unknown kind and sensors with factory settings: it finds out
 * whether there is an echo, names `senders`, and keeps fathom_silence_us() before a request. Several sensors may share
 * a bus, and a sketch may have several buses.
 *
 * **Wiring of an RS-485 transceiver.**
 *
 * | pin of the transceiver | goes to                                                                             |
 * |------------------------|-------------------------------------------------------------------------------------|
 * | DI                     | TX of the board.                                                                    |
 * | RO                     | RX of the board, with 10 kOhm to the supply of the transceiver: while a request is  |
 * |                        | sent, RO is not driven. Many modules have this resistor.                            |
 * | DE and /RE             | The driver-enable pin, with 10 kOhm to ground: while the board is in reset, the pin |
 * |                        | is not driven, and the transceiver must not send.                                   |
 * | A and B                | The pair of the sensors, with a common ground.                                      |
 *
 * An Uno receives its programs by pin 0 (RX). Disconnect RO from pin 0 while you upload a sketch.
 *
 * **Period of loop().** With a driver-enable pin, and without it, loop() may take:
 *
 * | sensor                                                    | longest period of loop()           |
 * |-----------------------------------------------------------|------------------------------------|
 * | any that is asked, also an HPS-167S with factory settings | 50 ms; a reading takes 3 periods   |
 * | A16 and A05 with automatic output, 9600 baud              | 60 ms: the core keeps 63 bytes     |
 *
 * An HPS-167S may send by itself with factory settings. The 50 ms are true then too, with more time for each reading:
 * a loop() of 20 ms got 10 readings a second, and one of 50 ms got 5.
 */
class bus : public bus_line
{
  public:
    /**
     * @brief Stores the serial port. Does nothing with it yet.
     * @param serial  The serial port (Serial, Serial1, ...). Nothing else may use it, except as begin_listening() says.
     */
    explicit bus(HardwareSerial &serial) : port(serial) {}

    /**
     * @brief Stores the serial port and the driver-enable pin. Does nothing with them yet.
     *
     * @param serial         The serial port. Nothing else may use it, except as begin_listening() says.
     * @param driver_enable  Arduino number of the driver-enable pin of an RS-485 transceiver (serial_uart).
     */
    bus(HardwareSerial &serial, uint8_t driver_enable) : port(serial, driver_enable) {}

    /**
     * @brief Begins the port and makes a line of it, for sensors that are asked. Call it in setup().
     * @param settings  The settings with which the sensors leave the factory (factory_line.h), or those that were set.
     * @return False if the port cannot reach the settings. Then each driver refuses this bus.
     */
    bool begin(const fathom_line_settings_t &settings);

    /**
     * @brief Begins the port and makes a line of it that only listens, for sensors that send by themselves.
     *
     * The sketch links nothing that sends. It may print by the serial port, since TX is free.
     *
     * @param settings  As for begin().
     * @return As begin().
     */
    bool begin_listening(const fathom_line_settings_t &settings);

    /** @brief The port. */
    serial_uart port;
};

/**
 * @brief The same as bus for a SoftwareSerial, the USB serial of a board, or any other Stream with begin(baud).
 *
 * It has 8 data bits, no parity, 1 stop bit, and no driver enable (stream_uart).
 */
class stream_bus : public bus_line
{
  public:
    /**
     * @brief Stores the serial port. Does nothing with it yet.
     * @param serial  The serial port, a Stream with begin(baud). Must stay valid as long as this object.
     */
    template <class Serial>
    explicit stream_bus(Serial &serial) : port(serial), serial_(serial), begin_(begin_of<Serial>)
    {
    }

    /**
     * @brief Begins the serial port and makes a line of it, for sensors that are asked. Call it in setup().
     * @param settings  As for bus::begin().
     * @return False if the settings have a parity or 2 stop bits. Then each driver refuses this bus.
     */
    bool begin(const fathom_line_settings_t &settings);

    /**
     * @brief Begins the serial port and makes a line of it that only listens, for sensors that send by themselves.
     * @param settings  As for begin().
     * @return As begin().
     */
    bool begin_listening(const fathom_line_settings_t &settings);

    /** @brief The port. */
    stream_uart port;

  private:
    Stream &serial_;
    void (*begin_)(Stream &serial, uint32_t baud);

    template <class Serial> static void begin_of(Stream &serial, uint32_t baud)
    {
        static_cast<Serial &>(serial).begin(static_cast<long>(baud));
    }
    bool begin_port(const fathom_line_settings_t &settings);
};

/** @brief A pin that triggers a module. */
class trigger_pin
{
  public:
    /**
     * @brief Stores the number of the pin.
     * @param pin  Arduino number of the pin to the module's RX or trigger input.
     */
    explicit trigger_pin(uint8_t pin) : number_(pin) {}

    /**
     * @brief Makes the pin an output with the level at which the module rests.
     * @param model  The model: it decides whether the trigger is a low or a high pulse. NULL: an A16.
     * @return The trigger for the driver. It is valid as long as this object.
     */
    fathom_output_t begin(const fathom_model_facts_t *model);

  private:
    uint8_t number_;
    fathom_pin_t pin_;
};

/** @brief fathom::a16_controlled whose trigger is a pin, or a byte if the model requires one. */
class a16_controlled : public fathom::a16_controlled
{
  public:
    /**
     * @brief Stores the bus and the number of the pin.
     * @param bus          The bus, which only listens.
     * @param trigger_pin  Arduino number of the pin to the module's RX. Not used if the model starts by a byte: then
     *                     the TX of the bus is connected to it.
     */
    template <class Bus>
    a16_controlled(Bus &bus, uint8_t trigger_pin) : fathom::a16_controlled(bus), pin_(trigger_pin)
    {
        byte_.line = &bus.line;
    }

    /**
     * @brief Makes the pin an output and initialises the driver, as fathom_a16_controlled_init().
     * @param config  The configuration, read only during the call. NULL: the defaults.
     * @return As fathom_a16_controlled_init().
     */
    fathom_status_t begin(const fathom_a16_controlled_config_t *config = nullptr)
    {
        const fathom_model_facts_t *const model = config != nullptr ? config->model : nullptr;
        if (model == nullptr || model->start != FATHOM_STARTS_BYTE)
            return fathom::a16_controlled::begin(pin_.begin(model), config);
        byte_.byte = model->trigger_byte;
        return fathom::a16_controlled::begin(fathom_output_line_byte(&byte_), config);
    }

  private:
    trigger_pin pin_;
    fathom_line_byte_t byte_;
};

/** @brief fathom::a16_pwm with its pins. */
class a16_pwm : public fathom::a16_pwm
{
  public:
    /**
     * @brief Stores the numbers of the pins.
     * @param pulse_pin    Arduino number of the pin to the module's TX: one with an interrupt (pulse_input).
     * @param trigger_pin  Arduino number of the pin to the module's RX.
     */
    a16_pwm(uint8_t pulse_pin, uint8_t trigger_pin) : pulse_pin_(pulse_pin), trigger_(trigger_pin) {}

    /**
     * @brief Sets up the pins and the interrupt, and initialises the driver, as fathom_a16_pwm_init().
     * @param config  The configuration, read only during the call. NULL: the defaults.
     * @return As fathom_a16_pwm_init(). FATHOM_ERR_UNSUPPORTED: pulse_input::begin() failed.
     */
    fathom_status_t begin(const fathom_a16_pwm_config_t *config = nullptr);

    /** @brief The pulses. */
    pulse_input pulses;

  private:
    uint8_t pulse_pin_;
    trigger_pin trigger_;
    fathom_capture_t capture_;
};

/** @brief fathom::a16_switch with its pin, an input without a pull-up. */
class a16_switch : public fathom::a16_switch
{
  public:
    /**
     * @brief Stores the number of the pin.
     * @param pin  Arduino number of the pin to the module's TX.
     */
    explicit a16_switch(uint8_t pin) : pin_(pin) {}

    /**
     * @brief Makes the pin an input and initialises the driver, as fathom_a16_switch_init().
     * @param config  The configuration, read only during the call. NULL: the defaults.
     * @return As fathom_a16_switch_init().
     */
    fathom_status_t begin(const fathom_a16_switch_config_t *config = nullptr)
    {
        level_ = input(pin_);
        return fathom::a16_switch::begin(level_, clock, config);
    }

  private:
    uint8_t pin_;
    fathom_pin_t level_;
};

/** @brief fathom::a05_relay with its pin, an input with a pull-up. The contact goes to ground. */
class a05_relay : public fathom::a05_relay
{
  public:
    /**
     * @brief Stores the number of the pin.
     * @param pin  Arduino number of the pin to the contact.
     */
    explicit a05_relay(uint8_t pin) : pin_(pin) {}

    /**
     * @brief Makes the pin an input with a pull-up and initialises the driver, as fathom_a05_relay_init().
     * @param config  The configuration, read only during the call. NULL: the defaults.
     * @return As fathom_a05_relay_init().
     */
    fathom_status_t begin(const fathom_a05_relay_config_t *config = nullptr)
    {
        level_ = input(pin_, true);
        return fathom::a05_relay::begin(level_, clock, config);
    }

  private:
    uint8_t pin_;
    fathom_pin_t level_;
};

/**
 * @brief A sensor whose functions have names as the Arduino API has them. The other functions of it remain.
 *
 * These functions of the class below (fathom.hpp) are also of use in a sketch:
 *
 * | function            | returns                                                                                |
 * |---------------------|----------------------------------------------------------------------------------------|
 * | `probe()`           | the probe of the newest reading, 1 to 4; 0 if there is none                            |
 * | `sample()`          | the newest reading, with `raw`, `magnitude`, `ambient` and others (sample.h)           |
 * | `is(FATHOM_FAULT)`  | true if the newest result is a reading of this kind                                    |
 * | `status()`          | the newest result as a number, such as FATHOM_ERR_NO_RESPONSE                          |
 * | `end()`             | nothing; it cancels what is in progress. A class with only pins does not have it       |
 * | `driver`            | no function: the driver of C, for all functions of its header                          |
 *
 * Do not use `advice()` on an AVR: its sentences need 1.7 KB of RAM.
 *
 * **No old value.** After an error there is no distance until the next reading. With the defaults the first error after
 * the newest reading comes after this time, if available() is called in each loop(). The headers of the drivers have
 * the times of the other modes.
 *
 * | sensor                                        | an unplugged sensor is an error after                     |
 * |-----------------------------------------------|-----------------------------------------------------------|
 * | HPS-167S                                      | 0.5 s without a response: NO_RESPONSE (`timeout_us`)      |
 * | A16, A05 and HPS-167S that send by themselves | 2 s without a byte: STALE (`stale_us`)                    |
 *
 * A switch or relay cannot show a cut wire. Between two readings the newest one remains: ageMs() has its age.
 */
template <class Sensor> class named : public Sensor
{
  public:
    using Sensor::Sensor;

    /**
     * @brief Initialises the driver with the defaults.
     * @return False after an error, which statusName() has until the first available().
     */
    bool begin() { return Sensor::begin() == FATHOM_OK; }

    /**
     * @brief Initialises the driver with a configuration.
     *
     * @code
     * fathom_hps167s_config_t config = {};   // all defaults
     * config.modbus.period_us = 167000;      // from one request to the next; 0 selects 18519
     * if (!gate.begin(config)) report(gate.statusName());
     * @endcode
     *
     * The sensor of this example measures 6 to 54 times a second. With 167000 us, 6 requests a second, each reading is
     * a new measurement. Assign the members: avr-gcc 5.4 does not compile `{.modbus = ...}`.
     *
     * @param config  The configuration of the driver, read only during the call.
     * @return False after an error, which statusName() has until the first available().
     */
    template <class Config> bool begin(const Config &config) { return Sensor::begin(&config) == FATHOM_OK; }

    /**
     * @brief Initialises the driver of an A16 or A05 for a relative, with the other defaults.
     * @param model  A row of models.h, such as fathom_model_a02yyuw. Must stay valid.
     * @return False after an error, which statusName() has until the first available().
     */
    bool begin(const fathom_model_facts_t &model)
    {
        typename Sensor::config_t config = {};
        config.model = &model;
        return begin(config);
    }

    /**
     * @brief Polls the sensor. Call it in each loop().
     * @return True if there is a new reading or error. After a begin() that failed: true, with the error ARGUMENT.
     */
    bool available() { return Sensor::poll() != FATHOM_PENDING; }

    /**
     * @brief Returns true if the newest result is a distance.
     *
     * An object nearer than the range is no target: an HPS-167S reports 1 to 79 mm as FATHOM_UNKNOWN. So false does not
     * prove that nothing is there.
     */
    bool hasTarget() const { return Sensor::has_target(); }

    /** @brief Returns true if the newest result is an error. NO_TARGET and every other reading are no error. */
    bool isError() const { return Sensor::is_error(); }

    /** @brief Returns the distance in millimetres. 0 unless hasTarget(), also for an object nearer than the range. */
    uint16_t distanceMm() const { return Sensor::distance_mm(); }

    /**
     * @brief Returns the time since the newest reading, from its `time_us`, in milliseconds.
     *
     * It wraps after 71.6 minutes without available(). 4294967 (71.6 minutes) if the newest result is no reading.
     */
    uint32_t ageMs() const { return Sensor::age_us(static_cast<uint32_t>(micros())) / 1000; }

    /** @brief Returns the newest result as a name: the kind of a reading, such as "NO_TARGET", or an error. */
    const char *resultName() const { return Sensor::result_name(); }

    /** @brief Returns the newest status as a name: "OK", "PENDING", or an error such as "NO_RESPONSE". */
    const char *statusName() const { return Sensor::status_name(); }
};

/** @brief The same as named for a switch or a relay. */
template <class Sensor> class named_contact : public named<Sensor>
{
  public:
    using named<Sensor>::named;

    /** @brief Returns true if the newest result is that something is near. */
    bool isNear() const { return Sensor::is(FATHOM_NEAR); }

    /** @brief Returns true if the newest result is that nothing is near. False after an error, as isNear(). */
    bool isFar() const { return Sensor::is(FATHOM_FAR); }
};

/** @brief A bus whose functions have names as the Arduino API has them. The other functions of it remain. */
template <class Bus> class named_bus : public Bus
{
  public:
    using Bus::Bus;

    /**
     * @brief As begin_listening().
     * @param settings  As for begin_listening().
     * @return As begin_listening().
     */
    bool beginListening(const fathom_line_settings_t &settings) { return Bus::begin_listening(settings); }
};

} // namespace arduino
} // namespace fathom

/** @brief A HardwareSerial with a line on it. */
typedef fathom::arduino::named_bus<fathom::arduino::bus> FathomBus;
/** @brief A SoftwareSerial or any other Stream with a line on it. */
typedef fathom::arduino::named_bus<fathom::arduino::stream_bus> FathomStreamBus;

/** @brief HPS-167S, Modbus RTU: `FathomHps167s gate(bus)`. */
typedef fathom::arduino::named<fathom::hps167s> FathomHps167s;
/** @brief HPS-167S that sends by itself: `FathomHps167sAuto gate(bus)`, with bus.beginListening(). */
typedef fathom::arduino::named<fathom::hps167s_auto> FathomHps167sAuto;
/** @brief A16, automatic output on UART or RS232: `FathomA16Auto tank(bus)`. */
typedef fathom::arduino::named<fathom::a16_auto> FathomA16Auto;
/** @brief A16, UART controlled: `FathomA16Controlled tank(bus, trigger_pin)`. */
typedef fathom::arduino::named<fathom::arduino::a16_controlled> FathomA16Controlled;
/** @brief A16, pulse width: `FathomA16Pwm tank(pulse_pin, trigger_pin)`. */
typedef fathom::arduino::named<fathom::arduino::a16_pwm> FathomA16Pwm;
/** @brief A16, Modbus RTU: `FathomA16Modbus tank(bus)`. */
typedef fathom::arduino::named<fathom::a16_modbus> FathomA16Modbus;
/** @brief A16, switch output: `FathomA16Switch door(pin)`. */
typedef fathom::arduino::named_contact<fathom::arduino::a16_switch> FathomA16Switch;
/** @brief A05, automatic output: `FathomA05Auto bumper(bus)`. */
typedef fathom::arduino::named<fathom::a05_auto> FathomA05Auto;
/** @brief A05, protocol `55 AA`: `FathomA05Dyp bumper(bus)`. */
typedef fathom::arduino::named<fathom::a05_dyp> FathomA05Dyp;
/** @brief A05, Modbus RTU: `FathomA05Modbus bumper(bus)`. */
typedef fathom::arduino::named<fathom::a05_modbus> FathomA05Modbus;
/** @brief A05, relay output: `FathomA05Relay door(pin)`. */
typedef fathom::arduino::named_contact<fathom::arduino::a05_relay> FathomA05Relay;

#endif
