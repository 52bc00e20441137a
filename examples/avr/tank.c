/* SPDX-License-Identifier: MIT */
/*
 * ATmega328P at 16 MHz, with an A16 that sends by itself, over a tank. RXD gets its TX.
 *
 *   PB5, Arduino 13   high while the volume is above 4500 litres
 *   PB4, Arduino 12   high while the level is unknown: from the start until 5 readings, and after 2 s without any
 */
#include <avr/interrupt.h>

#include "fathom/fathom.h"
#include "fathom_avr.h"

static const fathom_avr_pin_t full_at = {&PORTB, _BV(PB5)}, error_at = {&PORTB, _BV(PB4)}; /* Uno: 13, 12 */
static uint8_t sending[8], frame[8];
static const fathom_avr_usart_config_t usart = {
    .request = sending, .request_size = sizeof sending, .line = {9600, FATHOM_PARITY_NONE, 1}};
static const fathom_line_parts_t line_parts = {
    .uart = &fathom_avr_usart0, .clock = &fathom_avr_clock, .frame = frame, .frame_size = sizeof frame};
static fathom_line_t line;
static fathom_a16_auto_t probe;
static uint16_t window[5];
static fathom_median_t median;
static const fathom_level_config_t tank = {
    .volume = fathom_tank_upright, .capacity = 5000, .height_mm = 2000, .mounting_mm = 2300};

int main(void)
{
    fathom_avr_clock_init();
    const fathom_pin_t full = fathom_avr_output(&full_at), error = fathom_avr_output(&error_at);
    full.set(full.ctx, false);
    if (!fathom_avr_usart0_init(&usart)) return 1; /* `error` is high from its beginning */
    if (fathom_line_init_listening(&line, &line_parts) != FATHOM_OK) return 1;
    if (fathom_a16_auto_init(&probe, &line, NULL) != FATHOM_OK) return 1;
    const fathom_median_config_t median_config = {window, 2000000, .gate_mm = 300, .count = 5};
    if (fathom_median_init(&median, &median_config) != FATHOM_OK) return 1;
    const fathom_sensor_t sensor = fathom_a16_auto_sensor(&probe);
    sei();
    for (;;) {
        fathom_sample_t sample;
        fathom_level_t level = {0};
        const fathom_status_t status = fathom_poll(&sensor, &sample);
        const bool is_new = status == FATHOM_OK && fathom_median_add_sample(&median, &sample, &sample);
        const bool is_known = is_new && sample.kind == FATHOM_TARGET; /* no target: empty, or foam */
        if (is_known) fathom_level_from_distance(&tank, sample.distance_mm, &level);
        if (is_new || fathom_median_advance(&median, fathom_avr_clock.now_us(NULL))) { /* 2 s without any */
            full.set(full.ctx, level.volume > 4500);
            error.set(error.ctx, !is_known);
        }
        /* the rest of the firmware; a loop that comes round every 20 ms loses no reading */
    }
}
