/* SPDX-License-Identifier: MIT */
/*
 * ATmega328P at 16 MHz with an HPS-167S on RS-485: a gate that knows whether something stands before it. It reads as
 * often as the sensor measures, 54 times a second, and sleeps in between.
 *
 *   PD1 (TXD), PD0 (RXD)   DI and RO of a transceiver for 5 V, as the MAX485
 *   PD2, Arduino 2         DE and /RE together: no echo. 10 kOhm to ground keep it quiet until this runs
 *   A, B of it             white and green of the sensor, which has a terminating resistor, as from the factory.
 *                          560 Ohm from A to 5 V and from B to ground: else a MAX485 may receive noise on an idle pair
 *   PB0, Arduino 8         LED "near", from the supply: a low pin lights it. A relay board with low inputs does, too
 *   PB1, Arduino 9         LED "far", the same
 *   PB2, Arduino 10        LED "error", the same
 *
 * 19200 8E1, address 1. Near is nearer than 1500 mm, three times in a row, far is farther, five times in a row (or
 * nothing in range). In the first seconds, and while anything is wrong, neither is lit: an old level is no reading.
 */
#include <avr/interrupt.h>
#include <avr/io.h>

#include "fathom/engine/modbus_client.h"
#include "fathom/engine/wait.h"
#include "fathom/processing/debounce.h"
#include "fathom/sensor/hps167s.h"
#include "fathom_avr.h"

#define BAUD 19200ul

enum { CHARACTER_BITS = 11 }; /* 8E1 */

static const fathom_avr_pin_t near_at = {&PORTB, _BV(PB0)};
static const fathom_avr_pin_t far_at = {&PORTB, _BV(PB1)};
static const fathom_avr_pin_t error_at = {&PORTB, _BV(PB2)};

static uint8_t sending[8];
static const fathom_avr_usart_config_t usart = {.request = sending,
                                                .request_size = sizeof sending,
                                                .driver = {&PORTD, _BV(PD2)},
                                                .line = {BAUD, FATHOM_PARITY_EVEN, 1}};

static uint8_t frame[13];
static const fathom_line_parts_t line_parts = {.uart = &fathom_avr_usart0,
                                               .clock = &fathom_avr_clock,
                                               .frame = frame,
                                               .frame_size = sizeof frame,
                                               .echo = FATHOM_LINE_ECHO_OFF,
                                               .marks = fathom_line_marks,
                                               /* With factory settings it sends measurements unasked. */
                                               .senders = &fathom_line_senders,
                                               .silence_us = FATHOM_T3_5_US(BAUD, CHARACTER_BITS)};
static const fathom_debounce_config_t rule = {.threshold_mm = 1500, .near_count = 3, .far_count = 5};

static fathom_pin_t near_led;
static fathom_pin_t far_led;
static fathom_pin_t error_led;
static fathom_line_t line;
static fathom_modbus_t modbus;
static fathom_hps167s_t gate;
static fathom_debounce_t level;

static bool begin(void)
{
    fathom_avr_clock_init();
    near_led = fathom_avr_output(&near_at); /* high, dark */
    far_led = fathom_avr_output(&far_at);
    error_led = fathom_avr_output(&error_at);
    if (!fathom_avr_usart0_init(&usart)) return false;
    sei();
    if (fathom_line_init(&line, &line_parts) != FATHOM_OK) return false;
    modbus = fathom_modbus_client(&line);
    /* One retry: a single hit on the wire is no error yet. */
    const fathom_hps167s_config_t config = {.modbus.retries = 1};
    if (fathom_hps167s_init(&gate, &modbus, &config) != FATHOM_OK) return false;
    fathom_hps167s_power_on(&gate); /* it gets its supply together with this board */
    return fathom_debounce_init(&level, &rule) == FATHOM_OK;
}

static void light(const fathom_pin_t *led, bool is_lit) { led->set(led->ctx, !is_lit); }

int main(void)
{
    if (!begin()) return 1;
    const fathom_sensor_t sensor = fathom_hps167s_sensor(&gate);
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_wait(&sensor, &sample, fathom_avr_idle, NULL);
        const bool is_good =
            status == FATHOM_OK && (sample.kind == FATHOM_TARGET || sample.kind == FATHOM_NO_TARGET);
        if (is_good)
            fathom_debounce_add_sample(&level, &sample);
        else
            fathom_debounce_init(&level, &rule); /* no level, until a new row makes one */
        light(&near_led, level.level == FATHOM_NEAR);
        light(&far_led, level.level == FATHOM_FAR);
        light(&error_led, !is_good && status != FATHOM_ERR_WARMING_UP);
    }
}
