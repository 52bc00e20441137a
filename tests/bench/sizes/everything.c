/* SPDX-License-Identifier: MIT */
#include "programs.h"

/* Every program at once: one of each driver. Those that share a driver share its memory too. */

#define COUNT(program) +1
enum { SENSORS = 0 PROGRAMS(COUNT) };

static fathom_sensor_t sensors[SENSORS];

fathom_sensor_t everything_begin(void)
{
    fathom_sensor_t *next = sensors;
#define BEGIN_ONE(program) *next++ = program##_begin();
    PROGRAMS(BEGIN_ONE)
    return sensors[argument];
}

void everything_use(const fathom_sample_t *sample)
{
#define USE_ONE(program) program##_use(sample);
    PROGRAMS(USE_ONE)
    for (uint8_t i = 0; i != SENSORS; i++) {
        fathom_sample_t another;
        if (fathom_poll(&sensors[i], &another) == FATHOM_READY) outcome = another.distance_mm;
    }
}
