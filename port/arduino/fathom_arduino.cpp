/* SPDX-License-Identifier: MIT */
/*
 * The HAL on the functions of an Arduino core: clock, pins, pulses, HardwareSerial and Stream; and the buses. The end of
 * a request is computed from the time, because flush() of a core blocks.
 */
#include "fathom_arduino.h"

#include "fathom/engine/modbus_client.h"
#include "fathom/engine/silence.h"

namespace fathom
{
namespace arduino
{

namespace
{

uint32_t read_micros(void *) { return micros(); }

/* `ctx` is the number of the pin, not an address. */
void *ctx_of(uint8_t pin) { return reinterpret_cast<void *>(static_cast<uintptr_t>(pin)); }
uint8_t pin_of(void *ctx) { return static_cast<uint8_t>(reinterpret_cast<uintptr_t>(ctx)); }

void set_pin(void *ctx, bool high) { digitalWrite(pin_of(ctx), high ? HIGH : LOW); }
bool get_pin(void *ctx) { return digitalRead(pin_of(ctx)) == HIGH; }

int read_from(Stream &stream, uint8_t *bytes, size_t capacity)
{
    size_t count = 0;
    for (int byte; count < capacity && (byte = stream.read()) >= 0; count++)
        bytes[count] = static_cast<uint8_t>(byte);
    return static_cast<int>(count);
}

/* How long `length` characters may take to leave: 2.5 % for a slow baud generator, one bit until it has its next
 * tick, one for the interrupts between the bytes, and two steps of an AVR's micros(). 255 characters of 12 bits at
 * 1 us a bit still fit 32 bits. */
uint32_t span_us_of(size_t length, uint8_t bits, uint32_t baud)
{
    const uint32_t frame_bits = static_cast<uint32_t>(length) * bits;
    return (frame_bits + (frame_bits + 39) / 40 + 2) * 1000000ul / baud + 9;
}

uint32_t unsent_us(uint32_t since_us, uint32_t span_us)
{
    const uint32_t passed_us = fathom_elapsed_us(static_cast<uint32_t>(micros()), since_us);
    return passed_us < span_us ? span_us - passed_us : 0;
}

bool can_reach(uint32_t baud)
{
    if (baud == 0) return false;
#if defined(UBRRH) || defined(UBRR0H) || defined(UBRR1H)
    /* A classic AVR divides F_CPU / 8 by a whole number, 1..4096. */
    const uint32_t eighth = F_CPU / 8;
    const uint32_t divider = (eighth + baud / 2) / baud;
    if (divider == 0 || divider > 4096) return false;
    const uint32_t real = eighth / divider;
    return (real > baud ? real - baud : baud - real) <= baud / 40;
#else
    return true;
#endif
}

} // namespace

extern const fathom_clock_t clock = {read_micros, NULL};

fathom_pin_t output(uint8_t pin, bool is_high)
{
    /* The level is set first, so that the pin of an AVR has no other one. Some cores ignore a level before the
     * mode, so it is set again. */
    digitalWrite(pin, is_high ? HIGH : LOW);
    pinMode(pin, OUTPUT);
    digitalWrite(pin, is_high ? HIGH : LOW);
    const fathom_pin_t made = {set_pin, NULL, ctx_of(pin)};
    return made;
}

fathom_pin_t input(uint8_t pin, bool pull_up)
{
    pinMode(pin, pull_up ? INPUT_PULLUP : INPUT);
    const fathom_pin_t made = {NULL, get_pin, ctx_of(pin)};
    return made;
}

pulse_input *pulse_input::slots_[slot_count];

bool pulse_input::begin(uint8_t pin)
{
    static void (*const functions[slot_count])() = {changed<0>, changed<1>, changed<2>, changed<3>};
    uint8_t slot = 0;
    while (slot != slot_count && slots_[slot] != NULL && slots_[slot] != this) slot++;
    if (slot == slot_count) return false;
#ifdef NOT_AN_INTERRUPT
    if (digitalPinToInterrupt(pin) == NOT_AN_INTERRUPT) return false;
#endif
    pin_ = pin;
    level_ = input(pin);
    fathom_edges_init(&edges, &level_);
    slots_[slot] = this;
    attachInterrupt(static_cast<uint8_t>(digitalPinToInterrupt(pin)), functions[slot], CHANGE);
    return true;
}

void pulse_input::feed()
{
    const uint32_t time_us = micros();
    fathom_edges_feed(&edges, digitalRead(pin_) == HIGH, time_us);
}

fathom_capture_t pulse_input::capture() { return fathom_edges_capture(&edges); }

serial_uart::serial_uart(HardwareSerial &serial) : serial_uart(serial, no_pin, NULL) {}

serial_uart::serial_uart(HardwareSerial &serial, uint8_t driver_enable, void (*started)(serial_uart &))
    : serial_(serial), driver_enable_(driver_enable), started_(started), next_(NULL), leaving_(false),
      since_us_(0), span_us_(0), capacity_(0), line_()
{
}

bool serial_uart::begin(const fathom_line_settings_t &settings)
{
    if (driver_enable_ != no_pin) {
        digitalWrite(driver_enable_, LOW);
        pinMode(driver_enable_, OUTPUT);
    }
    if (!set(settings)) return false;
    leaving_ = false;
    capacity_ = serial_.availableForWrite();
    return true;
}

fathom_uart_t serial_uart::hal()
{
    const fathom_uart_t made = {read, write, sent, set_line, NULL, leaves_in_us, this};
    return made;
}

bool serial_uart::set(const fathom_line_settings_t &line)
{
    if (!can_reach(line.baud)) return false;
    /* The constants have another type in each core, so there is no table of them. */
    switch (line.parity << 4 | line.stop_bits) {
    case FATHOM_PARITY_NONE << 4 | 1:
        serial_.begin(line.baud, SERIAL_8N1);
        break;
    case FATHOM_PARITY_NONE << 4 | 2:
        serial_.begin(line.baud, SERIAL_8N2);
        break;
    case FATHOM_PARITY_EVEN << 4 | 1:
        serial_.begin(line.baud, SERIAL_8E1);
        break;
    case FATHOM_PARITY_EVEN << 4 | 2:
        serial_.begin(line.baud, SERIAL_8E2);
        break;
    case FATHOM_PARITY_ODD << 4 | 1:
        serial_.begin(line.baud, SERIAL_8O1);
        break;
    case FATHOM_PARITY_ODD << 4 | 2:
        serial_.begin(line.baud, SERIAL_8O2);
        break;
    default:
        return false;
    }
    line_ = line;
    return true;
}

bool serial_uart::release()
{
    if (!leaving_) return true;
    if (unsent_us(since_us_, span_us_) != 0 || serial_.availableForWrite() < capacity_) return false;
    if (driver_enable_ != no_pin) digitalWrite(driver_enable_, LOW);
    leaving_ = false;
    return true;
}

int serial_uart::read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *)
{
    serial_uart &self = *static_cast<serial_uart *>(ctx);
    self.release();
    return read_from(self.serial_, bytes, capacity);
}

int serial_uart::write(void *ctx, const uint8_t *bytes, size_t length)
{
    serial_uart &self = *static_cast<serial_uart *>(ctx);
    if (static_cast<int>(length) > self.capacity_) return -1;
    if (!self.release() || self.serial_.availableForWrite() < static_cast<int>(length)) return 0;
    self.span_us_ = span_us_of(length, fathom_character_bits(&self.line_), self.line_.baud);
    if (self.driver_enable_ != no_pin) digitalWrite(self.driver_enable_, HIGH);
    const int taken = static_cast<int>(self.serial_.write(bytes, length));
    self.since_us_ =
        micros(); /* The time is read after write(), because the first byte may begin that late. */
    self.leaving_ = true;
    if (self.started_ != NULL) self.started_(self);
    return taken;
}

bool serial_uart::sent(void *ctx) { return static_cast<serial_uart *>(ctx)->release(); }

uint32_t serial_uart::leaves_in_us(void *ctx)
{
    const serial_uart &self = *static_cast<serial_uart *>(ctx);
    return self.leaving_ ? unsent_us(self.since_us_, self.span_us_) : 0;
}

int serial_uart::set_line(void *ctx, const fathom_line_settings_t *settings)
{
    serial_uart &self = *static_cast<serial_uart *>(ctx);
    if (settings->baud == self.line_.baud && settings->parity == self.line_.parity &&
        settings->stop_bits == self.line_.stop_bits)
        return 1;
    if (!self.release()) return 0;
    return self.set(*settings) ? 1 : -1;
}

stream_uart::stream_uart(Stream &stream)
    : stream_(stream), baud_(9600), bits_(10), leaving_(false), since_us_(0), span_us_(0)
{
}

void stream_uart::begin(const fathom_line_settings_t &settings)
{
    baud_ = settings.baud;
    bits_ = fathom_character_bits(&settings);
}

fathom_uart_t stream_uart::hal()
{
    const fathom_uart_t made = {read, write, sent, NULL, NULL, leaves_in_us, this};
    return made;
}

int stream_uart::read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *)
{
    return read_from(static_cast<stream_uart *>(ctx)->stream_, bytes, capacity);
}

int stream_uart::write(void *ctx, const uint8_t *bytes, size_t length)
{
    stream_uart &self = *static_cast<stream_uart *>(ctx);
    if (!sent(ctx)) return 0;
    self.span_us_ = span_us_of(length, self.bits_, self.baud_);
    self.since_us_ = micros();
    self.leaving_ = true;
    return self.stream_.write(bytes, length) == length ? static_cast<int>(length) : -1;
}

bool stream_uart::sent(void *ctx)
{
    stream_uart &self = *static_cast<stream_uart *>(ctx);
    if (self.leaving_ && unsent_us(self.since_us_, self.span_us_) == 0) self.leaving_ = false;
    return !self.leaving_;
}

uint32_t stream_uart::leaves_in_us(void *ctx)
{
    const stream_uart &self = *static_cast<stream_uart *>(ctx);
    return self.leaving_ ? unsent_us(self.since_us_, self.span_us_) : 0;
}

void bus_line::name_parts()
{
    parts = fathom_line_parts_t();
    parts.uart = &uart_;
    parts.clock = &clock;
    parts.frame = frame_;
    parts.frame_size = sizeof frame_;
    modbus = fathom_modbus_t();
}

bool bus_line::ask(const fathom_line_settings_t &settings)
{
    name_parts();
    settings_ = settings;
    if (uart_.set_line != nullptr) parts.line_settings = &settings_;
    parts.silence_us = fathom_silence_us(&settings);
    parts.find_echo = fathom_line_find_echo;
    parts.senders = &fathom_line_senders;
    if (fathom_line_init(&line, &parts) != FATHOM_OK) return refuse();
    modbus = fathom_modbus_client(&line);
    return true;
}

bool bus_line::listen()
{
    name_parts();
    return fathom_line_init_listening(&line, &parts) == FATHOM_OK || refuse();
}

bool bus_line::refuse()
{
    line = fathom_line_t();
    modbus = fathom_modbus_t();
    return false;
}

bool bus::begin(const fathom_line_settings_t &settings)
{
    uart_ = port.hal();
    return port.begin(settings) ? ask(settings) : refuse();
}

bool bus::begin_listening(const fathom_line_settings_t &settings)
{
    uart_ = port.hal();
    return port.begin(settings) ? listen() : refuse();
}

bool stream_bus::begin_port(const fathom_line_settings_t &settings)
{
    if (settings.parity != FATHOM_PARITY_NONE || settings.stop_bits != 1) return false;
    begin_(serial_, settings.baud);
    port.begin(settings);
    uart_ = port.hal();
    return true;
}

bool stream_bus::begin(const fathom_line_settings_t &settings)
{
    return begin_port(settings) ? ask(settings) : refuse();
}

bool stream_bus::begin_listening(const fathom_line_settings_t &settings)
{
    return begin_port(settings) ? listen() : refuse();
}

fathom_output_t trigger_pin::begin(const fathom_model_facts_t *model)
{
    if (model != nullptr && model->start == FATHOM_STARTS_ALONE) return fathom_output_none();
    const bool is_high_pulse = model != nullptr && model->start == FATHOM_STARTS_HIGH_PULSE;
    pin_ = output(number_, !is_high_pulse);
    return is_high_pulse ? fathom_output_inverted_pin(&pin_) : fathom_output_pin(&pin_);
}

fathom_status_t a16_pwm::begin(const fathom_a16_pwm_config_t *config)
{
    if (!pulses.begin(pulse_pin_)) {
        driver = fathom_a16_pwm_t(); /* which every poll() refuses */
        return begun(FATHOM_ERR_UNSUPPORTED);
    }
    capture_ = pulses.capture();
    return fathom::a16_pwm::begin(capture_, clock,
                                  trigger_.begin(config != nullptr ? config->model : nullptr), config);
}

} // namespace arduino
} // namespace fathom
