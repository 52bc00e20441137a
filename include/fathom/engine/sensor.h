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

/**
 * @file
 * @brief One type for every sensor in every mode, so that one loop reads all of them. It does not wait and costs 12 bytes
 * of RAM on a 32-bit machine.
 */

/**
 * @brief A sensor in any mode, as fathom_a16_auto_sensor() and its counterparts return it by value.
 *
 * A copy works like the original. The driver that it points to must stay valid.
 */
typedef struct {
    fathom_status_t (*poll)(void *ctx, fathom_sample_t *sample); /**< Called by fathom_poll(). */
    uint32_t (*due_us)(void *ctx);                               /**< Called by fathom_due_us(). */
    void *ctx;                                                   /**< The driver. */
} fathom_sensor_t;

/**
 * @brief Returns a sensor that consists of a driver and two of its functions. For those who write a driver.
 *
 * @param poll    Does everything for the driver that can be done without waiting; see fathom_poll().
 * @param due_us  Returns the time until `poll` must be called again; see fathom_due_us().
 * @param ctx     The driver, passed to both functions. Must stay valid as long as the sensor.
 */
static inline fathom_sensor_t fathom_sensor_make(fathom_status_t (*poll)(void *ctx, fathom_sample_t *sample),
                                                 uint32_t (*due_us)(void *ctx), void *ctx)
{
    fathom_sensor_t made;
    made.poll = poll;
    made.due_us = due_us;
    made.ctx = ctx;
    return made;
}

/**
 * @brief Does everything for a sensor that can be done without waiting.
 *
 * The sensor continues after an error. Each driver's header lists its errors, and states within which time a program
 * that polls gets a sample or an error.
 *
 * @param sensor  The sensor.
 * @param sample  Written with FATHOM_OK only.
 * @retval FATHOM_OK         `*sample` is a new reading of one probe. Call again at once for the next one.
 * @retval FATHOM_PENDING       There is nothing new.
 * @retval FATHOM_ERR_ARGUMENT  The driver's initialisation failed or never ran, or `*sensor` is zeroed.
 * @return Other errors: an attempt failed.
 */
fathom_status_t fathom_poll(const fathom_sensor_t *sensor, fathom_sample_t *sample);

/**
 * @brief Returns the time in microseconds until one of `count` sensors must be polled if no byte arrives and no pin
 * changes. Returns FATHOM_NO_DEADLINE if there is no such time. A program that received bytes wake may sleep that long.
 *
 * A zeroed sensor, or a driver in zeroed memory, is due in 0 us: the next poll returns FATHOM_ERR_ARGUMENT.
 *
 * @param sensors  The sensors.
 * @param count    How many there are.
 */
uint32_t fathom_due_us(const fathom_sensor_t *sensors, size_t count);

#ifdef __cplusplus
}
#endif

#endif
