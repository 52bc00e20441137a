/* SPDX-License-Identifier: MIT */
/*
 * Linux. For a sensor with a line the argument is the path of its tty; without one it is /dev/ttyUSB0. For a sensor
 * without a line the arguments are a GPIO chip, the line at the sensor's TX or contact, and the line at its RX (a16_pwm
 * only), as in `example_first_a16_pwm gpiochip0 17 27`.
 */
#include "board.h"

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>

#include "fathom_gpio.h"

static fathom_gpio_t input, trigger;
static fathom_pin_t input_pin, trigger_pin;

bool board_open(board_bus_t *bus, const fathom_line_settings_t *settings, int argc, char **argv)
{
    const char *const path = argc > 1 ? argv[1] : "/dev/ttyUSB0";
    if (fathom_posix_bus_open(bus, path, settings) == FATHOM_POSIX_OK) return true;
    (void)fprintf(stderr, "%s\n", fathom_posix_bus_error(bus));
    return false;
}

bool board_open_listening(board_bus_t *bus, const fathom_line_settings_t *settings, int argc, char **argv)
{
    return board_open(bus, settings, argc, argv); /* each line of this port also listens */
}

fathom_status_t board_read(board_bus_t *bus, fathom_sensor_t sensor, fathom_sample_t *sample)
{
    return fathom_posix_bus_read(bus, sensor, sample);
}

static uint32_t number(const char *text) { return (uint32_t)strtoul(text, NULL, 10); }

static bool is_open(const fathom_gpio_t *gpio, fathom_gpio_status_t status)
{
    if (status != FATHOM_GPIO_OK) (void)fprintf(stderr, "%s\n", fathom_gpio_error_text(gpio));
    return status == FATHOM_GPIO_OK;
}

bool board_open_contact(board_pins_t *pins, int argc, char **argv)
{
    pins->clock = fathom_posix_clock();
    if (argc < 3) return fprintf(stderr, "usage: %s CHIP LINE\n", argv[0]) < 0;
    const fathom_gpio_bias_t bias = FATHOM_GPIO_BIAS_PULL_UP;
    if (!is_open(&input, fathom_gpio_open_edges(&input, argv[1], number(argv[2]), bias))) return false;
    pins->contact = input_pin = fathom_gpio_pin(&input);
    return true;
}

bool board_open_pulse(board_pins_t *pins, int argc, char **argv)
{
    pins->clock = fathom_posix_clock();
    if (argc < 4) return fprintf(stderr, "usage: %s CHIP LINE LINE\n", argv[0]) < 0;
    const fathom_gpio_bias_t bias = FATHOM_GPIO_BIAS_PULL_DOWN;
    if (!is_open(&input, fathom_gpio_open_edges(&input, argv[1], number(argv[2]), bias))) return false;
    if (!is_open(&trigger, fathom_gpio_open_output(&trigger, argv[1], number(argv[3]), true))) return false;
    input_pin = fathom_gpio_pin(&input);
    trigger_pin = fathom_gpio_pin(&trigger);
    pins->capture = fathom_gpio_capture(&input);
    pins->trigger = fathom_output_pin(&trigger_pin);
    return true;
}

static void wait_for_edge(void *ctx, uint32_t max_us)
{
    struct pollfd input_poll = {.fd = fathom_gpio_fd(&input), .events = POLLIN};
    (void)ctx;
    (void)poll(&input_poll, 1, (int)(max_us / 1000 + 1));
    (void)input_pin.get(input_pin.ctx); /* reads the edges, so that the next call waits again */
}

fathom_status_t board_read_pins(board_pins_t *pins, fathom_sensor_t sensor, fathom_sample_t *sample)
{
    (void)pins;
    return fathom_wait(&sensor, sample, wait_for_edge, NULL);
}
