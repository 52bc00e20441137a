/* SPDX-License-Identifier: MIT */
#include "fathom/engine/sensor.h"

#include "fathom/hal.h"

fathom_status_t fathom_poll(const fathom_sensor_t *sensor, fathom_sample_t *sample)
{
    return (sensor->poll != NULL) ? sensor->poll(sensor->ctx, sample) : FATHOM_ERR_ARGUMENT;
}

uint32_t fathom_due_us(const fathom_sensor_t *sensors, size_t count)
{
    uint32_t least_us = FATHOM_NO_DEADLINE;
    for (; count != 0u; count--) {
        const uint32_t due_us = (sensors->due_us != NULL) ? sensors->due_us(sensors->ctx) : 0u;
        if (due_us < least_us) least_us = due_us;
        sensors++;
    }
    return least_us;
}
