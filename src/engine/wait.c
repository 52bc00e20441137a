/* SPDX-License-Identifier: MIT */
#include "fathom/engine/wait.h"

/* The blocking form of fathom_poll(). It polls one sensor, and sleeps in between until the sensor is due. */

fathom_status_t fathom_wait(const fathom_sensor_t *sensor, fathom_sample_t *sample, fathom_idle_t idle,
                            void *idle_ctx)
{
    for (;;) {
        const fathom_status_t status = fathom_poll(sensor, sample);
        if (status != FATHOM_PENDING) return status;
        if (idle != NULL) idle(idle_ctx, fathom_due_us(sensor, 1));
    }
}
