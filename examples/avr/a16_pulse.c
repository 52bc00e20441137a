/* SPDX-License-Identifier: MIT */
/*
 * ATmega328P at 16 MHz with an A16 of PWM output. Prints each reading, four and a half a second, and sleeps in between.
 *
 *   A16 pin 3 (RX)   PB1, Arduino 9: the trigger. It takes 5 V
 *   A16 pin 4 (TX)   ICP1 = PB0, Arduino 8: the pulse, high for the time of flight. Its 3 V are a high level for an
 *                    ATmega at 5 V, which wants 0.6 VCC, by a hair: with other chips or long wires use a buffer
 *   PD1 (TXD)        text, 115200 8N1: "1234 mm", "nothing in range", "error -3: no response"
 *
 * The width is taken by Timer1's input capture, to half a microsecond whatever else runs: 0.09 mm.
 */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/pgmspace.h>

#include "fathom/engine/edges.h"
#include "fathom/engine/wait.h"
#include "fathom/sensor/a16_pwm.h"
#include "fathom_avr.h"
#include "text.h"

static const fathom_avr_pin_t trigger_at = {&PORTB, _BV(PB1)};
static const fathom_avr_pin_t pulse_at = {&PORTB, _BV(PB0)};

static uint8_t sending[TEXT_SIZE];
static const fathom_avr_usart_config_t usart = {
    .request = sending, .request_size = sizeof sending, .line = {115200, FATHOM_PARITY_NONE, 1}};

static fathom_pin_t trigger;
static fathom_pin_t pulse;
static fathom_edges_t edges;
static fathom_capture_t capture;
static fathom_a16_pwm_t tank;

static bool begin(void)
{
    fathom_avr_clock_init();
    trigger = fathom_avr_output(&trigger_at);
    pulse = fathom_avr_input(&pulse_at, false);
    fathom_edges_init(&edges, &pulse);
    capture = fathom_edges_capture(&edges);
    fathom_avr_icp1_init(&edges);
    const bool is_ready = fathom_avr_usart0_init(&usart);
    sei();
    const fathom_output_t output = fathom_output_pin(&trigger);
    return is_ready && fathom_a16_pwm_init(&tank, &capture, &fathom_avr_clock, &output, NULL) == FATHOM_OK;
}

/* Nothing is sent to it; but a byte of noise that is not read would keep it awake. */
static void forget_what_came(void)
{
    uint8_t byte;
    fathom_rx_t rx = {0, 0};
    while (fathom_avr_usart0.read(fathom_avr_usart0.ctx, &byte, 1, &rx) > 0) {
    }
}

static void idle(void *ctx, uint32_t max_us)
{
    forget_what_came();
    fathom_avr_idle(ctx, max_us);
}

int main(void)
{
    if (!begin()) return 1;
    const fathom_sensor_t sensor = fathom_a16_pwm_sensor(&tank);
    text_t text = {0};
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_wait(&sensor, &sample, idle, NULL);
        if (status == FATHOM_OK)
            text_sample(&text, &sample);
        else
            text_error(&text, status);
        text_say(&text, PSTR("\r\n"));
        text_send(&text, &fathom_avr_usart0); /* a line is out in 3 ms, a cycle is 221 ms: it is never busy */
    }
}
