// SPDX-License-Identifier: MIT
// An A05 that sends by itself (UART automatic), its TX to pin 10. The distances of its four probes are printed at
// 115200 baud.
//
// An Uno has one hardware serial, which prints, so the sensor is read by SoftwareSerial; at 9600 baud, and while
// nothing is written to it, that loses nothing. A board with Serial1 uses that: the sensor's TX to its RX.
#include <fathom_arduino.h>

#if defined(ARDUINO_ARCH_AVR) && !defined(HAVE_HWSERIAL1)
#include <SoftwareSerial.h>
static SoftwareSerial soft_serial(10, 11); // RX, TX
static fathom::arduino::stream_uart port(soft_serial, 9600);
static bool begin_port()
{
    soft_serial.begin(9600);
    return true;
}
#else
static fathom::arduino::serial_uart port(Serial1);
static bool begin_port() { return port.begin(9600); }
#endif

static fathom_uart_t uart;
static uint8_t frame[16];
static fathom_line_parts_t line_parts;
static fathom_line_t line;
static fathom_a05_auto_t bumper;
static fathom_sensor_t sensor;

// Stops with a message: a setup that failed is an error in this sketch.
static void stop(const __FlashStringHelper *why)
{
    Serial.println(why);
    for (;;) {
    }
}

void setup()
{
    Serial.begin(115200);
    if (!begin_port()) stop(F("this port cannot do 9600 8N1"));
    uart = port.hal();

    line_parts.uart = &uart;
    line_parts.clock = &fathom::arduino::clock;
    line_parts.frame = frame;
    line_parts.frame_size = sizeof frame;
    if (fathom_line_init_listening(&line, &line_parts) != FATHOM_OK) stop(F("wrong config of the line"));

    if (fathom_a05_auto_init(&bumper, &line, NULL) != FATHOM_OK) stop(F("wrong config of the sensor"));
    sensor = fathom_a05_auto_sensor(&bumper);
}

void loop()
{
    fathom_sample_t sample;
    const fathom_status_t status = fathom_poll(&sensor, &sample);
    if (status == FATHOM_OK) {
        Serial.print(sample.probe);
        Serial.print(F(": "));
        if (sample.kind == FATHOM_TARGET)
            Serial.println(sample.distance_mm);
        else
            Serial.println(F("nothing in range"));
    } else if (status < 0) {
        Serial.print(F("error ")); // -7: silent for 2 s; -4: bytes for 2 s, but no frame
        Serial.println(status);
    }
    // Other work goes here: fathom_poll never waits. Within 60 ms, or the core's buffer is full and bytes are lost.
}
