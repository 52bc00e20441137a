// SPDX-License-Identifier: MIT
// An HPS-167S behind an RS-485 transceiver: DI to TX, RO to RX, which has 10 kOhm to the supply as well, since RO
// floats while bytes leave; DE and /RE together to pin 2, A and B to white and green. The transceiver has the board's
// own voltage, 5 V or 3.3 V. 19200 8E1, as it comes from the factory. The LED is lit while something is nearer than 1
// m, and blinks while the sensor does not answer.
//
// On a board with a second hardware serial (Mega, Leonardo, Zero) the sensor has Serial1, and Serial prints. An Uno has
// one, and the sensor takes it: so there is nothing to print to, and while the board is programmed the transceiver has
// to be off pin 0. SoftwareSerial as a printer is no way out: it keeps interrupts off while it sends a byte, for longer
// than the sensor's bytes last, and some of those would be lost.
#include <fathom_arduino.h>

#if defined(ARDUINO_ARCH_AVR) && !defined(HAVE_HWSERIAL1)
#define BUS Serial
#else
#define BUS      Serial1
#define PRINT_TO Serial
#endif

static const uint8_t driver_enable_pin = 2;
static const uint16_t near_mm = 1000;

static fathom::arduino::serial_uart port(BUS, driver_enable_pin);
static fathom_uart_t uart;
static uint8_t frame[32];
static fathom_line_parts_t line_parts;
static fathom_line_t line;
static fathom_modbus_t modbus;
static fathom_hps167s_t gate;

// Stops with a message: a setup that failed is an error in this sketch. The LED stays on.
static void stop(const __FlashStringHelper *why)
{
    digitalWrite(LED_BUILTIN, HIGH);
#ifdef PRINT_TO
    PRINT_TO.println(why);
#else
    (void)why;
#endif
    for (;;) {
    }
}

void setup()
{
#ifdef PRINT_TO
    PRINT_TO.begin(115200);
#endif
    pinMode(LED_BUILTIN, OUTPUT);
    if (!port.begin(19200, FATHOM_PARITY_EVEN)) stop(F("this port cannot do 19200 8E1"));
    uart = port.hal();

    line_parts.uart = &uart;
    line_parts.clock = &fathom::arduino::clock;
    line_parts.frame = frame;
    line_parts.frame_size = sizeof frame;
    line_parts.silence_us = FATHOM_T3_5_US(19200, 11); // 8E1: 11 bits a character
    line_parts.echo = FATHOM_LINE_ECHO_OFF;    // FATHOM_LINE_ECHO_ON where the transceiver hears itself
    line_parts.senders = &fathom_line_senders; // with factory settings the sensor sends measurements unasked
    if (fathom_line_init(&line, &line_parts) != FATHOM_OK) stop(F("wrong config of the line"));
    modbus = fathom_modbus_client(&line);

    if (fathom_hps167s_init(&gate, &modbus, NULL) != FATHOM_OK) stop(F("wrong config of the sensor"));
}

void loop()
{
    fathom_sample_t sample;
    const fathom_status_t status = fathom_hps167s_poll(&gate, &sample);
    if (status == FATHOM_OK) {
        digitalWrite(LED_BUILTIN, sample.kind == FATHOM_TARGET && sample.distance_mm < near_mm ? HIGH : LOW);
#ifdef PRINT_TO
        PRINT_TO.println(sample.kind == FATHOM_TARGET ? static_cast<long>(sample.distance_mm) : -1L);
#endif
    } else if (status < 0) {
        digitalWrite(LED_BUILTIN, digitalRead(LED_BUILTIN) == HIGH ? LOW : HIGH);
#ifdef PRINT_TO
        PRINT_TO.print(F("error ")); // -3 is "no response"; status.h has them all
        PRINT_TO.println(static_cast<long>(status));
#endif
    }
    // Other work goes here, of 1.6 ms a round at most: the loop drops driver-enable (fathom_arduino.h).
}
