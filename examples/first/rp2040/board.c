/* SPDX-License-Identifier: MIT */
/*
 * An RP2040 after the start-up of its maker's SDK. A line: UART1, TX at GPIO 4, RX at 5, DE and /RE of an RS-485
 * transceiver at 6. A contact or the TX of an A16 with PWM output: GPIO 3. The RX of that A16: GPIO 2. Text: GPIO 0,
 * 115200 8N1 (examples/rp2040/print.c).
 */
#include "board.h"

#include "../../rp2040/vectors.h"

enum { TRIGGER = 2, INPUT = 3, REF_HZ = 12000000 };

static const fathom_rp2040_wiring_t wiring = {
    .clk_peri_hz = 125000000, .number = 1, .tx = 4, .rx = 5, .has_driver = true, .driver = 6};
static board_bus_t *line_bus;
static fathom_rp2040_idle_t idle = {.alarm = 2};
static fathom_pin_t input_pin, trigger_pin;
static fathom_edges_t edges;
static fathom_rp2040_edges_t edges_pin;

void uart1_irq(void) { fathom_rp2040_uart_interrupt(&line_bus->port); }
void timer_irq_0(void) { fathom_rp2040_uart_alarm(&line_bus->port); }
void timer_irq_1(void) { fathom_rp2040_idle_alarm(&line_bus->idle); }
void timer_irq_2(void) { fathom_rp2040_idle_alarm(&idle); }
void io_irq_bank0(void) { fathom_rp2040_edges_interrupt(&edges_pin); }

bool board_open(board_bus_t *bus, const fathom_line_settings_t *settings, int argc, char **argv)
{
    (void)argc, (void)argv;
    line_bus = bus;
    fathom_rp2040_clock_init(REF_HZ);
    return fathom_rp2040_bus_init(bus, &wiring, settings);
}

bool board_open_listening(board_bus_t *bus, const fathom_line_settings_t *settings, int argc, char **argv)
{
    (void)argc, (void)argv;
    line_bus = bus;
    fathom_rp2040_clock_init(REF_HZ);
    return fathom_rp2040_bus_init_listening(bus, &wiring, settings);
}

fathom_status_t board_read(board_bus_t *bus, fathom_sensor_t sensor, fathom_sample_t *sample)
{
    return fathom_rp2040_bus_read(bus, sensor, sample);
}

/* An edge ends the sleep, for a contact too. */
bool board_open_contact(board_pins_t *pins, int argc, char **argv)
{
    (void)argc, (void)argv;
    fathom_rp2040_clock_init(REF_HZ);
    fathom_rp2040_idle_init(&idle);
    input_pin = pins->contact = fathom_rp2040_input(INPUT, true);
    pins->clock = fathom_rp2040_clock;
    fathom_edges_init(&edges, &input_pin);
    pins->capture = fathom_edges_capture(&edges);
    fathom_rp2040_edges_init(&edges_pin, &edges, INPUT, &idle);
    return true;
}

bool board_open_pulse(board_pins_t *pins, int argc, char **argv)
{
    trigger_pin = fathom_rp2040_output(TRIGGER, true);
    pins->trigger = fathom_output_pin(&trigger_pin);
    return board_open_contact(pins, argc, argv);
}

fathom_status_t board_read_pins(board_pins_t *pins, fathom_sensor_t sensor, fathom_sample_t *sample)
{
    (void)pins;
    return fathom_wait(&sensor, sample, fathom_rp2040_idle, &idle);
}
