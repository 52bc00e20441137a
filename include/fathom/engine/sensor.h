/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SENSOR_H
#define FATHOM_SENSOR_H

#include <stddef.h>
#include <stdint.h>

#include "fathom/sample.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Any sensor in any mode: what fathom_a16_auto_sensor() and its like return, so that one loop reads them all.
 * By value; it points to the driver, which must outlive it.
 */
typedef struct {
    fathom_status_t (*poll)(void *ctx, fathom_sample_t *sample);
    uint32_t (*due_us)(void *ctx);
    void *ctx;
} fathom_sensor_t;

/*
 * Does all that can be done for a sensor without waiting.
 * FATHOM_READY: *sample is a new reading, one probe's; call again at once for the next one.
 * FATHOM_PENDING, or an error (< 0) of the attempt that has just failed: *sample is untouched. The sensor
 * goes on by itself after an error; each driver's header says which errors it has.
 */
fathom_status_t fathom_poll(const fathom_sensor_t *sensor, fathom_sample_t *sample);

/*
 * How long from now until any of the `count` sensors has something to do if no byte comes, in microseconds;
 * FATHOM_NO_DEADLINE when none has. A device that is woken by received bytes may sleep that long.
 */
uint32_t fathom_due_us(const fathom_sensor_t *sensors, size_t count);

#ifdef __cplusplus
}
#endif

#endif
