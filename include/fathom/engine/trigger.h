/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TRIGGER_H
#define FATHOM_TRIGGER_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/output.h"
#include "fathom/hal.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Makes the falling edges that trigger a sensor (A16 1, 3).
 *
 *     high ____          __________________          ____
 *              |________|                  |________|
 *              |<low_us>|<---- >= low_us -->|
 *              |<------- >= period_us ----->|
 *
 * pulse.h and a16_controlled.h are built on this file; a program that reads a sensor needs those only. No function
 * waits. Call all functions of one trigger from one context. include/COST.md has the cost in the rows of the drivers.
 *
 * The functions are meant for a driver, which checks first that its own initialisation succeeded. A trigger whose
 * fathom_trigger_init() failed must not be passed to them, except to fathom_trigger_deinit().
 */

/** Default of `low_us`. The datasheet asks for an edge and names no time; no input misses 2 ms. */
#define FATHOM_TRIGGER_DEFAULT_LOW_US 2000u

/** Longest `low_us`: half of the A16's shortest period, 120 ms (A16 3(2)). */
#define FATHOM_TRIGGER_MAX_LOW_US 60000u

/** An output that refuses to begin or to end the low level for this time is reported with FATHOM_ERR_PORT. */
#define FATHOM_TRIGGER_REFUSED_US 1000000uL

/** @brief A trigger. The caller owns the memory and sets the first four members before fathom_trigger_init(). */
typedef struct {
    fathom_output_t output;      /**< The sensor's input. */
    const fathom_clock_t *clock; /**< Must stay valid as long as the trigger. */
    uint32_t period_us; /**< Between two falling edges, at least: low_us + 1..FATHOM_MAX_DURATION_US. */
    uint16_t low_us;    /**< Low, and high before the next edge, at least: 1..60000 us; 0 selects 2000 us. */

    /* Members of the trigger. They may be read. */
    bool low;            /**< The output is low. A low level whose end the output refuses counts too. */
    bool refused;        /**< The output refused the last call. */
    uint32_t refused_us; /**< Time of the first refusal, or of the last report of it. */
    uint32_t polled_us;  /**< Time of the last fathom_trigger_update(), or of a later falling edge. */
    uint32_t left_us;    /**< Rest of the period at `polled_us`. */
} fathom_trigger_t;

/**
 * @brief Initialises a trigger and makes the output high. The first falling edge may come `low_us` later.
 *
 * @param trigger  The trigger, with `output`, `clock`, `period_us` and `low_us` set.
 * @retval FATHOM_OK               The trigger is ready.
 * @retval FATHOM_ERR_ARGUMENT     There is no output or no clock, or a time is outside its range.
 * @retval FATHOM_ERR_UNSUPPORTED  The port has no `set_break`, or the pin no `set`.
 */
fathom_status_t fathom_trigger_init(fathom_trigger_t *trigger);

/** @brief Reads the clock. Call it first in each poll. */
void fathom_trigger_update(fathom_trigger_t *trigger);

/** @brief Returns true if fathom_trigger_drive() would begin a cycle. */
static inline bool fathom_trigger_is_due(const fathom_trigger_t *trigger)
{
    return !trigger->low && (trigger->left_us == 0u);
}

/**
 * @brief Sets the output if it is time to.
 *
 * An output that refuses is tried again in each call. If it refuses for 1 s to begin or to end the low level, the
 * function returns FATHOM_ERR_PORT, and again after each further second. Shorter refusals are not added up.
 *
 * @param trigger    The trigger, after fathom_trigger_update().
 * @param may_begin  True if the next falling edge may come.
 * @retval FATHOM_OK        The falling edge was made. `polled_us` is the clock after it, so no period is too short.
 * @retval FATHOM_PENDING   It is not time yet, the output refuses for less than 1 s, or the output went high.
 * @retval FATHOM_ERR_PORT  The output is broken, or refuses.
 */
fathom_status_t fathom_trigger_drive(fathom_trigger_t *trigger, bool may_begin);

/**
 * @brief Returns the time in microseconds until fathom_trigger_drive() must be called again.
 *
 * @param trigger   The trigger.
 * @param until_us  A time after `polled_us` at which the caller has something to do. If it is 0, 1 ms is used, because
 *                  an output may have refused.
 */
uint32_t fathom_trigger_due_us(const fathom_trigger_t *trigger, uint32_t until_us);

/**
 * @brief Makes the output high, if it is low. Call it again unless it returns FATHOM_OK.
 * @retval FATHOM_OK        The output is high. A zeroed trigger has this result too.
 * @retval FATHOM_PENDING   The output refused.
 * @retval FATHOM_ERR_PORT  The output is broken, or has refused for 1 s.
 */
fathom_status_t fathom_trigger_deinit(fathom_trigger_t *trigger);

#ifdef __cplusplus
}
#endif

#endif
