/* SPDX-License-Identifier: MIT */
/* Three sensors on one RS-485 pair, read in one loop: an A16 at address 2 and an A05 at address 1, both at 9600 8N1, and
 * an HPS-167S at address 5, at 19200 8E1. A sensor that does not respond delays the others little. */
#include <stdio.h>

#include "fathom/fathom.h"
#include "fathom_posix.h"

enum { SENSORS = 3 };

static void print(const char *name, fathom_status_t status, const fathom_sample_t *sample)
{
    if (status != FATHOM_OK)
        printf("%s: no reading (%s). %s\n", name, fathom_status_name(status), fathom_status_advice(status));
    else if (sample->kind == FATHOM_TARGET)
        printf("%s: probe %u: %u mm\n", name, sample->probe, sample->distance_mm);
    else
        printf("%s: probe %u: %s\n", name, sample->probe,
               sample->kind == FATHOM_NO_TARGET ? "nothing in range" : "no distance");
}

int main(int argc, char **argv)
{
    static const char *const names[SENSORS] = {"A16", "A05", "HPS-167S"};
    static fathom_posix_bus_t bus;
    static fathom_a16_modbus_t a16;
    static fathom_a05_modbus_t a05;
    static fathom_hps167s_t hps;
    const fathom_a16_modbus_config_t a16_config = {
        .modbus = {.address = 2, .line_settings = &fathom_a16_factory_line}};
    const fathom_a05_modbus_config_t a05_config = {
        .modbus = {.address = 1, .line_settings = &fathom_a05_factory_line}};
    const fathom_hps167s_config_t hps_config = {
        .modbus = {.address = 5, .line_settings = &fathom_hps167s_factory_line}};
    const char *const path = argc > 1 ? argv[1] : "/dev/ttyUSB0";
    bool has_port = fathom_posix_bus_open(&bus, path, &fathom_a16_factory_line) == FATHOM_POSIX_OK &&
                    fathom_a16_modbus_init(&a16, &bus.modbus, &a16_config) == FATHOM_OK &&
                    fathom_a05_modbus_init(&a05, &bus.modbus, &a05_config) == FATHOM_OK &&
                    fathom_hps167s_init(&hps, &bus.modbus, &hps_config) == FATHOM_OK;
    const fathom_sensor_t sensors[SENSORS] = {fathom_a16_modbus_sensor(&a16), fathom_a05_modbus_sensor(&a05),
                                              fathom_hps167s_sensor(&hps)};
    while (has_port && fflush(stdout) == 0) {
        for (int i = 0; i != SENSORS && has_port; i++) {
            fathom_sample_t sample;
            const fathom_status_t status = fathom_poll(&sensors[i], &sample);
            if (status != FATHOM_PENDING) print(names[i], status, &sample);
            has_port = status != FATHOM_ERR_PORT; /* false: the adapter was unplugged */
        }
        fathom_posix_wait(&bus.port, fathom_due_us(sensors, SENSORS));
    }
    if (!has_port) fprintf(stderr, "%s\n", fathom_posix_bus_error(&bus));
    return 1;
}
