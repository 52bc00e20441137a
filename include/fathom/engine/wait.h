/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_WAIT_H
#define FATHOM_WAIT_H

#include <stdint.h>

#include "fathom/engine/sensor.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The blocking form, for programs that have nothing else to do. It is the only function of Fathom that does
 * not return at once, and nothing else needs it.
 */

/*
 * Called while there is nothing to do: sleep until bytes come, but no longer than max_us microseconds
 * (FATHOM_NO_DEADLINE: for as long as it takes), and return; earlier is allowed. WFI, an RTOS semaphore,
 * poll(2), or advancing a simulated clock.
 */
typedef void (*fathom_idle_t)(void *ctx, uint32_t max_us);

/*
 * Polls the sensor until it has a reading or an error, and returns that: any value of fathom_poll but
 * FATHOM_PENDING. It ends because every driver ends every attempt, by a time-out at the latest; but a request leaves
 * into a silence only, so that on a line which never falls silent it does not end.
 * idle: may be NULL, then it spins.
 */
fathom_status_t fathom_wait(const fathom_sensor_t *sensor, fathom_sample_t *sample, fathom_idle_t idle,
                            void *idle_ctx);

#ifdef __cplusplus
}
#endif

#endif
