/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_WAIT_H
#define FATHOM_WAIT_H

#include <stdint.h>

#include "fathom/engine/sensor.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief The blocking form of fathom_poll(), for programs that have nothing else to do.
 *
 * fathom_wait() is the only function of Fathom that does not return at once. No other function needs it.
 *
 * @code
 * if (fathom_wait(&sensor, &sample, NULL, NULL) == FATHOM_OK) use(&sample);
 * @endcode
 */

/**
 * @brief Sleeps until bytes arrive or a pin changes, but at most `max_us` microseconds, and returns. It may return
 * earlier.
 *
 * Examples are WFI, an RTOS semaphore, poll(2), or the advance of a simulated clock. If `max_us` is FATHOM_NO_DEADLINE,
 * only a byte or a pin can change anything.
 *
 * @param ctx     The `idle_ctx` of fathom_wait().
 * @param max_us  Longest time to sleep, in microseconds.
 */
typedef void (*fathom_idle_t)(void *ctx, uint32_t max_us);

/**
 * @brief Polls a sensor until it returns a reading or an error.
 *
 * The function always returns, because no driver is without an outcome for longer than the bound that its header
 * states. The bound is a formula of the driver's configuration and of the time between two polls, whatever is on the
 * wire or the pin. The program needs no time-out of its own. Two conditions must hold: the clock of the configuration
 * runs, and `idle` returns within the time that it is given.
 *
 * @param sensor    The sensor.
 * @param sample    Written with FATHOM_OK only.
 * @param idle      Called while there is nothing to do; NULL: the function polls without pause.
 * @param idle_ctx  Passed to `idle`.
 * @return Any result of fathom_poll() but FATHOM_PENDING.
 */
fathom_status_t fathom_wait(const fathom_sensor_t *sensor, fathom_sample_t *sample, fathom_idle_t idle,
                            void *idle_ctx);

#ifdef __cplusplus
}
#endif

#endif
