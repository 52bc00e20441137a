// SPDX-License-Identifier: MIT
// What the adapter responses, asked without a line. Reports the source line of each failure (kind 2) and the number of
// checks that held (kind 1), and ends.
#include <fathom_arduino.h>

static uint8_t held;

static void check(bool holds, uint16_t line)
{
    if (holds) {
        held++;
        return;
    }
    GPIOR0 = line >> 8;
    GPIOR0 = line & 0xFF;
    GPIOR1 = 2;
}
#define CHECK(what) check(what, __LINE__)

static const uint8_t many[70] = {0};

// Takes at most `takes` bytes, at once.
class taker : public Stream
{
  public:
    size_t takes = 255;
    uint8_t waiting = 0;
    unsigned long baud = 0;
    void begin(unsigned long rate) { baud = rate; }
    size_t write(uint8_t) override { return takes == 0 ? 0 : (takes--, 1); }
    int available() override { return waiting; }
    int peek() override { return waiting != 0 ? 0x40 + waiting : -1; }
    int read() override { return waiting != 0 ? 0x40 + waiting-- : -1; }
};

static const uint8_t driver_pin = 2;
static fathom::arduino::serial_uart port(Serial, driver_pin);
static taker stream;
static fathom::arduino::stream_uart soft(stream);

static uint32_t now() { return fathom::arduino::clock.now_us(fathom::arduino::clock.ctx); }

// From now on until it says that all has left; 0: it said so at once.
static uint32_t until_sent(const fathom_uart_t &uart)
{
    const uint32_t since = now();
    if (uart.sent(uart.ctx)) return 0;
    while (!uart.sent(uart.ctx)) {
    }
    return now() - since;
}

static void check_write(const fathom_uart_t &uart)
{
    const uint8_t was_c = UCSR0C, was_ubrr = UBRR0L;
    const fathom_line_settings_t same = {19200, FATHOM_PARITY_EVEN, 1};
    const fathom_line_settings_t other = {9600, FATHOM_PARITY_NONE, 1};
    CHECK(digitalRead(driver_pin) == LOW);
    CHECK(uart.write(uart.ctx, many, 64) < 0); // one more than the core's buffer holds
    CHECK(uart.sent(uart.ctx) && digitalRead(driver_pin) == LOW);

    CHECK(uart.write(uart.ctx, many, 8) == 8);
    CHECK(!uart.sent(uart.ctx) && !port.release());
    CHECK(digitalRead(driver_pin) == HIGH);
    CHECK(uart.write(uart.ctx, many, 1) == 0);   // busy
    CHECK(uart.set_line(uart.ctx, &same) == 1);  // they hold
    CHECK(uart.set_line(uart.ctx, &other) == 0); // not before all has left
    CHECK(UCSR0C == was_c && UBRR0L == was_ubrr);
    while (!uart.sent(uart.ctx)) {
    }
    CHECK(digitalRead(driver_pin) == LOW);

    // 63 characters of 11 bits at 19200 baud: 36.094 ms, and 2.5 %, 2 bits and 9 us more: 37.11 ms.
    CHECK(uart.leaves_in_us(uart.ctx) == 0);
    CHECK(uart.write(uart.ctx, many, 63) == 63);
    const uint32_t leaves_in_us = uart.leaves_in_us(uart.ctx);
    CHECK(leaves_in_us > 36800 && leaves_in_us < 37150);
    const uint32_t took_us = until_sent(uart);
    CHECK(took_us >= 37000 && took_us < 37300);
    CHECK(Serial.availableForWrite() == 63);

    // Time alone does not make it true: here the core's interrupt is held back.
    CHECK(uart.write(uart.ctx, many, 8) == 8);
    UCSR0B &= static_cast<uint8_t>(~_BV(UDRIE0));
    delay(10);
    CHECK(!uart.sent(uart.ctx) && digitalRead(driver_pin) == HIGH);
    CHECK(uart.leaves_in_us(uart.ctx) == 0);
    UCSR0B |= _BV(UDRIE0);
    CHECK(until_sent(uart) > 0 && digitalRead(driver_pin) == LOW);
}

static void check_settings(const fathom_uart_t &uart)
{
    const fathom_line_settings_t odd = {57600, FATHOM_PARITY_ODD, 1};
    const fathom_line_settings_t two = {9600, FATHOM_PARITY_NONE, 2};
    const fathom_line_settings_t fast = {115200, FATHOM_PARITY_NONE, 1};
    const fathom_line_settings_t too_fast = {230400, FATHOM_PARITY_NONE, 1}; // 222222 at best: 3.5 % off
    const fathom_line_settings_t no_baud = {0, FATHOM_PARITY_NONE, 1};
    const fathom_line_settings_t no_parity = {9600, 3, 1};
    const fathom_line_settings_t no_stop = {9600, FATHOM_PARITY_NONE, 0};
    // UCSR0C, table 20-8 to 20-11: UPM 11 odd, 10 even; USBS; UCSZ 11
    CHECK(uart.set_line(uart.ctx, &odd) == 1 && UCSR0C == 0x36);
    CHECK(uart.set_line(uart.ctx, &two) == 1 && UCSR0C == 0x0E && UBRR0L == 207);
    CHECK(uart.set_line(uart.ctx, &fast) == 1 && UCSR0C == 0x06 && UBRR0L == 16);
    CHECK(uart.set_line(uart.ctx, &too_fast) < 0 && UCSR0C == 0x06 && UBRR0L == 16);
    CHECK(uart.set_line(uart.ctx, &no_baud) < 0);
    CHECK(uart.set_line(uart.ctx, &no_parity) < 0);
    CHECK(uart.set_line(uart.ctx, &no_stop) < 0);
    CHECK(uart.set_line(uart.ctx, &fast) == 1); // what held still does
    CHECK(uart.set_break == NULL);
    CHECK(!port.begin(too_fast) && UBRR0L == 16);
}

static void check_stream(const fathom_uart_t &uart)
{
    uint8_t bytes[4] = {0};
    fathom_rx_t rx = {};
    CHECK(uart.read(uart.ctx, bytes, 4, &rx) == 0);
    stream.waiting = 3;
    CHECK(uart.read(uart.ctx, bytes, 2, &rx) == 2 && bytes[0] == 0x43 && bytes[1] == 0x42 && bytes[2] == 0);
    CHECK(uart.read(uart.ctx, bytes, 4, &rx) == 1 && bytes[0] == 0x41 && rx.flags == 0);

    CHECK(uart.sent(uart.ctx));
    CHECK(uart.write(uart.ctx, many, 8) == 8);
    CHECK(uart.write(uart.ctx, many, 8) == 0);
    // 8 characters of 10 bits at 9600 baud: 8.333 ms, and 2.5 %, 2 bits and 9 us more: 8.76 ms
    CHECK(uart.leaves_in_us(uart.ctx) > 8600 && uart.leaves_in_us(uart.ctx) < 8770);
    const uint32_t took_us = until_sent(uart);
    CHECK(took_us >= 8650 && took_us < 8850);
    stream.takes = 3;
    CHECK(uart.write(uart.ctx, many, 8) < 0);
    CHECK(uart.set_line == NULL && uart.set_break == NULL);
}

static void check_pins()
{
    const fathom_pin_t out = fathom::arduino::output(7);
    CHECK((DDRD & 0x80) != 0 && (PORTD & 0x80) != 0 && out.get == NULL);
    out.set(out.ctx, false);
    CHECK((PORTD & 0x80) == 0);
    out.set(out.ctx, true);
    CHECK((PORTD & 0x80) != 0);

    const fathom_pin_t in = fathom::arduino::input(8);
    CHECK((DDRB & 0x01) == 0 && (PORTB & 0x01) == 0 && in.set == NULL);
    CHECK(!in.get(in.ctx));
    const fathom_pin_t pulled = fathom::arduino::input(8, true);
    CHECK((DDRB & 0x01) == 0 && (PORTB & 0x01) != 0);
    CHECK(pulled.get(pulled.ctx));
}

// No call of the loop: the interrupt of Timer0 releases each port that has sent, whatever others there are.
static fathom::arduino::serial_uart second(Serial, 3);
static fathom::arduino::serial_uart third(Serial, 4);

static void check_release(fathom::arduino::serial_uart &port_, uint8_t pin)
{
    const fathom_uart_t uart = port_.hal();
    OCR0A = 0;
    CHECK(port_.begin(fathom_hps167s_factory_line) && digitalRead(pin) == LOW);
    CHECK(uart.write(uart.ctx, many, 8) == 8 && digitalRead(pin) == HIGH);
    CHECK(OCR0A == 0x80 && (TIMSK0 & _BV(OCIE0A)) != 0);
    delay(4); // 8 characters take 4.6 ms
    CHECK(digitalRead(pin) == HIGH);
    delay(3);
    CHECK(digitalRead(pin) == LOW && (TIMSK0 & _BV(OCIE0A)) == 0);
}

static void check_analog_write()
{
    const fathom_uart_t uart = second.hal();
    analogWrite(6, 10); // OC0A
    CHECK(uart.write(uart.ctx, many, 1) == 1 && OCR0A == 10);
    delay(3);
    CHECK(digitalRead(3) == LOW && OCR0A == 10);
}

static fathom::arduino::stream_bus soft_bus(stream);
static fathom::hps167s gate(soft_bus);
static fathom::a16_auto tank(soft_bus);

static void check_buses()
{
    CHECK(!soft_bus.begin(fathom_hps167s_factory_line)); // even parity
    CHECK(gate.begin() == FATHOM_ERR_ARGUMENT);
    CHECK(soft_bus.begin(fathom_a16_factory_line) && stream.baud == 9600);
    CHECK(gate.begin() == FATHOM_OK);
    gate.end();
    CHECK(soft_bus.begin_listening(fathom_a16_factory_line));
    CHECK(tank.begin() == FATHOM_OK && tank.poll() == FATHOM_PENDING);
    CHECK(gate.begin() == FATHOM_ERR_ARGUMENT); // it cannot ask
    const fathom_line_settings_t too_fast = {230400, FATHOM_PARITY_NONE, 1};
    static fathom::arduino::bus bus(Serial);
    CHECK(!bus.begin(too_fast) && bus.modbus.line == NULL);
}

static void check_pulses()
{
    static FathomA16Pwm none(5, 7); // no interrupt
    CHECK(!none.begin() && none.status() == FATHOM_ERR_UNSUPPORTED);
    static fathom::arduino::pulse_input inputs[5];
    for (uint8_t i = 0; i < 4; i++) CHECK(inputs[i].begin(2));
    CHECK(!inputs[4].begin(3));
    CHECK(inputs[0].begin(2)); // again
    detachInterrupt(digitalPinToInterrupt(2));
}

void setup()
{
    const fathom_uart_t uart = port.hal();
    CHECK(uart.write(uart.ctx, many, 1) < 0); // before begin()
    CHECK(port.begin(fathom_hps167s_factory_line));
    check_write(uart);
    check_settings(uart);
    soft.begin(fathom_a16_factory_line);
    check_stream(soft.hal());
    check_pins();
    check_release(second, 3);
    check_release(third, 4);
    check_release(second, 3);
    check_analog_write();
    check_buses();
    check_pulses();
    GPIOR0 = held;
    GPIOR1 = 1;
    GPIOR2 = 0;
}

void loop() {}
