/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "fathom/fathom.h"
#include "loopback.h"

/* A line of the library on the port: it hears its own request, and no response. */
int main(void)
{
    static uint8_t frame[32];
    static fathom_line_t line;
    static fathom_hps167s_t hps;
    loopback_begin();
    const fathom_line_parts_t config = {.uart = &loopback_uart,
                                        .clock = &loopback_clock,
                                        .frame = frame,
                                        .frame_size = sizeof frame,
                                        .find_echo = fathom_line_find_echo};
    if (fathom_line_init(&line, &config) != FATHOM_OK) return 1;
    const fathom_modbus_t modbus = fathom_modbus_client(&line);
    if (fathom_hps167s_init(&hps, &modbus, NULL) != FATHOM_OK) return 1;
    const fathom_sensor_t sensor = fathom_hps167s_sensor(&hps);
    fathom_sample_t sample;
    fathom_status_t status;
    do status = fathom_poll(&sensor, &sample);
    while (status == FATHOM_PENDING);
    puts(fathom_status_name(status));
    return 0;
}
