/* SPDX-License-Identifier: MIT */
/*
 * An ATmega328P at 16 MHz, with the numbers of an Uno. A line: RXD and TXD (0, 1), and DE and /RE of an RS-485
 * transceiver at PD2 (2). A contact or the TX of an A16 with PWM trigger_at: PB0 (8). The RX of that A16: PB1 (9). Text: PB2
 * (10), 9600 8N1.
 */
#include "board.h"

#include <avr/interrupt.h>
#include <avr/io.h>

static const fathom_avr_pin_t driver = {&PORTD, _BV(PD2)};
static const fathom_avr_pin_t input_at = {&PORTB, _BV(PB0)};
static const fathom_avr_pin_t trigger_at = {&PORTB, _BV(PB1)};
static fathom_pin_t input_pin, trigger_pin;
static fathom_edges_t edges;

bool board_open(board_bus_t *bus, const fathom_line_settings_t *settings, int argc, char **argv)
{
    (void)argc, (void)argv;
    fathom_avr_clock_init();
    const bool is_open = fathom_avr_bus_init(bus, &driver, settings);
    sei();
    return is_open;
}

bool board_open_listening(board_bus_t *bus, const fathom_line_settings_t *settings, int argc, char **argv)
{
    (void)argc, (void)argv;
    fathom_avr_clock_init();
    const bool is_open = fathom_avr_bus_init_listening(bus, settings);
    sei();
    return is_open;
}

fathom_status_t board_read(board_bus_t *bus, fathom_sensor_t sensor, fathom_sample_t *sample)
{
    (void)bus;
    return fathom_avr_bus_read(sensor, sample);
}

bool board_open_contact(board_pins_t *pins, int argc, char **argv)
{
    (void)argc, (void)argv;
    fathom_avr_clock_init();
    sei();
    pins->contact = fathom_avr_input(&input_at, true);
    pins->clock = fathom_avr_clock;
    return true;
}

bool board_open_pulse(board_pins_t *pins, int argc, char **argv)
{
    (void)board_open_contact(pins, argc, argv);
    input_pin = fathom_avr_input(&input_at, false);
    trigger_pin = fathom_avr_output(&trigger_at);
    pins->trigger = fathom_output_pin(&trigger_pin);
    fathom_edges_init(&edges, &input_pin);
    pins->capture = fathom_edges_capture(&edges);
    fathom_avr_icp1_init(&edges);
    return true;
}

fathom_status_t board_read_pins(board_pins_t *pins, fathom_sensor_t sensor, fathom_sample_t *sample)
{
    (void)pins;
    return fathom_avr_bus_read(sensor, sample);
}
