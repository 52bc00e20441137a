// SPDX-License-Identifier: MIT
// An A16 with PWM output: its RX to pin 7, its TX to pin 2, which has an interrupt on every board. Distances are
// printed at 115200 baud.
#include <fathom_arduino.h>

static const uint8_t trigger_pin = 7;
static const uint8_t echo_pin = 2;

// They outlive setup(), since the driver keeps pointers to them.
static fathom::arduino::pulse_input echo;
static fathom_pin_t trigger;
static fathom_capture_t capture;
static fathom_a16_pwm_t tank;
static fathom_sensor_t sensor;

static void echo_changed() { echo.changed(); }

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
    trigger = fathom::arduino::output(trigger_pin);
    echo.begin(echo_pin);
    attachInterrupt(digitalPinToInterrupt(echo_pin), echo_changed, CHANGE);
    capture = echo.capture();

    const fathom_output_t output = fathom_output_pin(&trigger);
    if (fathom_a16_pwm_init(&tank, &capture, &fathom::arduino::clock, &output, NULL) != FATHOM_OK)
        stop(F("wrong config of the sensor"));
    sensor = fathom_a16_pwm_sensor(&tank);
}

void loop()
{
    fathom_sample_t sample;
    const fathom_status_t status = fathom_poll(&sensor, &sample);
    if (status == FATHOM_OK && sample.kind == FATHOM_TARGET) {
        Serial.print(sample.distance_mm);
        Serial.print(F(" mm, "));
        Serial.print(sample.raw);
        Serial.println(F(" us"));
    } else if (status == FATHOM_OK && sample.kind == FATHOM_NO_TARGET) {
        Serial.println(F("nothing in range"));
    } else if (status == FATHOM_OK && sample.kind == FATHOM_FAULT) {
        Serial.println(F("stuck line"));
    } else if (status == FATHOM_OK) {
        Serial.println(F("unknown")); // only pulses below the range
    } else if (status < 0) {
        Serial.print(F("error ")); // -3 is "no response"; status.h has them all
        Serial.println(status);
    }
    // Other work goes here: fathom_poll never waits.
}
