/* SPDX-License-Identifier: MIT */
/*
 * Two lines and a pin, read in one thread: an HPS-167S at a gate, an A16 by Modbus over a tank, and the relay of an A05 at
 * a door, which closes to ground, on line 17 of a GPIO chip. A port that is lost, or not there yet, is opened as soon as
 * it can be; the others go on meanwhile. What stands in main lives as long as the loop runs. It never ran on a board: the
 * pin of its test is a stand-in. After sh examples/demo.sh, which builds the libraries:
 *
 *     cc -Iinclude -Iport/posix -Iport/gpio examples/site.c build/port/libfathom_gpio.a build/port/libfathom_posix.a \
 *         build/libfathom.a -o site
 *     ./site /dev/ttyUSB0 /dev/ttyUSB1 gpiochip0
 */
#include <stdio.h>

#include "fathom/fathom.h"
#include "fathom_gpio.h"
#include "fathom_loop.h"

static fathom_loop_t loop;
static fathom_loop_line_t north, west;
static fathom_loop_pin_t pin;
static fathom_gpio_t contact;
static fathom_hps167s_t gate;
static fathom_a16_modbus_t tank;
static fathom_a05_relay_t door;

static void take(void *name, fathom_status_t status, const fathom_sample_t *sample)
{
    static const char *const kinds[] = {"", " mm", "nothing in range", "fault", "near", "far", "unknown"};
    const char *const words = sample != NULL ? kinds[sample->kind] : fathom_status_name(status);
    const unsigned mm = sample != NULL ? sample->distance_mm : 0; /* "%.0u" prints no 0 */
    if (printf("%s: %.0u%s\n", (char *)name, mm, words) < 0 || fflush(stdout) != 0) fathom_loop_stop(&loop);
}

static void tell(void *ctx, const fathom_loop_source_t *source, bool is_open)
{
    (void)fprintf(ctx, "%s\n", is_open ? "a port is open" : fathom_loop_error_text(source));
}

int main(int argc, char **argv)
{
    if (argc != 4 || fathom_loop_init(&loop, &(fathom_loop_config_t){.tell = tell, .ctx = stderr})) return 2;
    bool bad = fathom_gpio_open_edges(&contact, argv[3], 17, FATHOM_GPIO_BIAS_PULL_UP) != FATHOM_GPIO_OK;
    const fathom_pin_t level = fathom_gpio_pin(&contact);
    fathom_loop_add_line(&loop, &north, argv[1], &fathom_hps167s_factory_line);
    fathom_loop_add_line(&loop, &west, argv[2], &fathom_a16_factory_line);
    /* An edge wakes it. A state that does not change is printed once a minute. */
    const fathom_a05_relay_config_t slow = {{.period_us = 60000000, .interval_us = FATHOM_NO_DEADLINE}, 0, 0};
    bad |= fathom_hps167s_init(&gate, &north.bus.modbus, NULL) < 0;
    bad |= fathom_a16_modbus_init(&tank, &west.bus.modbus, NULL) < 0;
    bad |= fathom_a05_relay_init(&door, &level, &north.bus.clock, &slow) < 0;
    if (bad) return fprintf(stderr, "wrong pin or configuration: %s\n", fathom_gpio_error_text(&contact)), 1;
    fathom_loop_add_pin(&loop, &pin, fathom_gpio_fd(&contact));
    fathom_loop_read(&north.source, &(fathom_loop_sensor_t){0}, fathom_hps167s_sensor(&gate), take, "gate");
    fathom_loop_read(&west.source, &(fathom_loop_sensor_t){0}, fathom_a16_modbus_sensor(&tank), take, "tank");
    fathom_loop_read(&pin.source, &(fathom_loop_sensor_t){0}, fathom_a05_relay_sensor(&door), take, "door");
    return fathom_loop_run(&loop), 1; /* a broken output alone ends it */
}
