/* SPDX-License-Identifier: MIT */
#include "programs.h"

/* Every program at once: one of each driver, and all that a line can do. Programs that share a driver share its memory
 * too. */

#define COUNT(program) +1
enum { SENSORS = 0 PROGRAMS(COUNT) };

static fathom_sensor_t sensors[SENSORS];

static uint16_t counters[FATHOM_LINE_COUNTERS];
static const fathom_line_parts_t line_parts = {.uart = &uart,
                                               .clock = &clock,
                                               .frame = frame,
                                               .frame_size = sizeof frame,
                                               .find_echo = fathom_line_find_echo,
                                               .marks = fathom_line_marks,
                                               .count = fathom_line_count,
                                               .counters = counters,
                                               .senders = &fathom_line_senders,
                                               .masters = &fathom_line_masters};

fathom_sensor_t everything_begin(void)
{
    fathom_sensor_t *next = sensors;
#define BEGIN_ONE(program) *next++ = program##_begin();
    PROGRAMS(BEGIN_ONE)
    fathom_line_init(&line, &line_parts);
    modbus = fathom_modbus_client_with_zero(&line);
    return sensors[argument];
}

void everything_use(const fathom_sample_t *sample)
{
#define USE_ONE(program) program##_use(sample);
    PROGRAMS(USE_ONE)
    for (uint8_t i = 0; i != SENSORS; i++) {
        fathom_sample_t another;
        if (fathom_poll(&sensors[i], &another) == FATHOM_OK) outcome = another.distance_mm;
    }
}
