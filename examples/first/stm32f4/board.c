/* SPDX-License-Identifier: MIT */
/*
 * An STM32F405 with the clocks that it has after reset. A line: USART2, TX on PA2, RX on PA3, DE and /RE of an RS-485
 * transceiver on PA1. A contact or the TX of an A16 with PWM trigger_at: PA0. The RX of that A16: PB1. Text: PA9, 115200 8N1
 * (examples/stm32f4/print.c).
 */
#include "board.h"

#include "../../stm32f4/start.h"

enum { HZ = 16000000 };

static const fathom_stm32f4_usart_config_t wiring = {
    .number = 2, .bus_hz = HZ, .tx = {'A', 2}, .rx = {'A', 3}, .driver = {'A', 1}};
static const fathom_stm32f4_pin_t input_at = {'A', 0};
static const fathom_stm32f4_pin_t trigger_at = {'B', 1};
static board_bus_t *line_bus;
static fathom_pin_t input_pin, trigger_pin;
static fathom_edges_t edges;

void usart2_interrupt(void) { fathom_stm32f4_usart_interrupt(&line_bus->port); }
void tim2_interrupt(void) { fathom_stm32f4_tim2_interrupt(); }
void tim5_interrupt(void) { fathom_stm32f4_tim5_interrupt(); }

bool board_open(board_bus_t *bus, const fathom_line_settings_t *settings, int argc, char **argv)
{
    (void)argc, (void)argv;
    line_bus = bus;
    fathom_stm32f4_clock_init(HZ);
    return fathom_stm32f4_bus_init(bus, &wiring, settings);
}

bool board_open_listening(board_bus_t *bus, const fathom_line_settings_t *settings, int argc, char **argv)
{
    (void)argc, (void)argv;
    line_bus = bus;
    fathom_stm32f4_clock_init(HZ);
    return fathom_stm32f4_bus_init_listening(bus, &wiring, settings);
}

fathom_status_t board_read(board_bus_t *bus, fathom_sensor_t sensor, fathom_sample_t *sample)
{
    return fathom_stm32f4_bus_read(bus, sensor, sample);
}

bool board_open_contact(board_pins_t *pins, int argc, char **argv)
{
    (void)argc, (void)argv;
    fathom_stm32f4_clock_init(HZ);
    pins->contact = fathom_stm32f4_input(&input_at, FATHOM_STM32F4_UP);
    pins->clock = fathom_stm32f4_clock;
    return true;
}

bool board_open_pulse(board_pins_t *pins, int argc, char **argv)
{
    (void)board_open_contact(pins, argc, argv);
    input_pin = fathom_stm32f4_input(&input_at, FATHOM_STM32F4_DOWN);
    trigger_pin = fathom_stm32f4_output(&trigger_at);
    pins->trigger = fathom_output_pin(&trigger_pin);
    fathom_edges_init(&edges, &input_pin);
    pins->capture = fathom_edges_capture(&edges);
    return fathom_stm32f4_capture_init(&input_at, &edges);
}

fathom_status_t board_read_pins(board_pins_t *pins, fathom_sensor_t sensor, fathom_sample_t *sample)
{
    fathom_stm32f4_idle_t idle = {NULL, 0};
    (void)pins;
    return fathom_wait(&sensor, sample, fathom_stm32f4_idle, &idle);
}
