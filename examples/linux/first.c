/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "fathom/fathom.h"
#include "fathom_posix.h"

int main(int argc, char **argv)
{
    static fathom_posix_bus_t bus; /* the port, and all that stands between it and a sensor */
    static fathom_hps167s_t gate;
    const char *const path = argc > 1 ? argv[1] : "/dev/ttyUSB0";
    bool has_port = fathom_posix_bus_open(&bus, path, &fathom_hps167s_factory_line) == FATHOM_POSIX_OK &&
                    fathom_hps167s_init(&gate, &bus.modbus, NULL) == FATHOM_OK;
    while (has_port && fflush(stdout) == 0) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_posix_bus_read(&bus, fathom_hps167s_sensor(&gate), &sample);
        has_port = status != FATHOM_ERR_PORT; /* false: the adapter was unplugged */
        if (status != FATHOM_OK)
            printf("no reading (%s). %s\n", fathom_status_name(status), fathom_status_advice(status));
        else if (sample.kind == FATHOM_TARGET)
            printf("%u mm\n", sample.distance_mm);
        else
            printf("%s\n", sample.kind == FATHOM_NO_TARGET ? "nothing in range" : "no distance");
    }
    if (!has_port) fprintf(stderr, "%s\n", fathom_posix_bus_error(&bus));
    return 1;
}
