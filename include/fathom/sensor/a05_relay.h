/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A05_RELAY_H
#define FATHOM_A05_RELAY_H

#include "fathom/engine/contact.h"
#include "fathom/engine/sensor.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Reads the relay of an A05 with relay output (datasheet A05 4).
 *
 * The relay closes if at least one of the four probes has something nearer than the threshold, which is 1 m with
 * factory settings. Each state lasts at least about 1 s (A05 4(1)). The driver samples one contact at each poll; it
 * sends nothing, never waits and never allocates memory. include/COST.md has its flash, RAM and stack (`a05_relay`).
 *
 * A user teaches the threshold on the board, with a button and a flat target in front of probe 4 (A05 4(2)). A program
 * can neither read nor set it. a05_relay_rule.h is the same rule in software, for an A05 in any other mode.
 *
 * @code
 * static fathom_a05_relay_t door;
 * fathom_a05_relay_init(&door, &pin, &clock, NULL);
 * const fathom_sensor_t sensor = fathom_a05_relay_sensor(&door);
 *
 * fathom_sample_t state;                             // in the loop
 * const fathom_status_t status = fathom_poll(&sensor, &state);
 * if (status < 0 || (status == FATHOM_OK && state.kind == FATHOM_NEAR)) stop();
 * @endcode
 *
 * The samples are FATHOM_NEAR or FATHOM_FAR, without a distance, and `probe` is always 1. contact.h states when
 * there is a sample, and what its `time_us` and `raw` are. If P is the longest time between two polls, a program gets a
 * sample or an error at the latest after 3 s + 2 * P by default.
 *
 * **What `sequence` promises.** `sequence` increases by 1 with each sample and wraps. A contact that does not change is
 * a sample again after each `period_us`, so a new number is not always a new state. `raw` and `kind` are the level at
 * the poll that returns the sample. The module itself keeps a state for about 1 s, so the state may be 1 s older than
 * the distance that caused it.
 *
 * | error of fathom_poll() | cause |
 * |---|---|
 * | FATHOM_ERR_STALE | No level lasted for `settle_us` within `stale_us`: noise, a worn or a loose contact. |
 * | FATHOM_ERR_ARGUMENT | The driver is not initialised, and its memory is zeroed. |
 *
 * A contact cannot report "no response":
 *
 * | contact | a cut wire reads as | a module without power reads as |
 * |---|---|---|
 * | normally open | FATHOM_FAR | FATHOM_FAR |
 * | normally closed | FATHOM_NEAR | FATHOM_FAR, because its relay has dropped |
 */

/** @brief The contact that is wired. The common terminal goes to the other pole. */
typedef enum {
    FATHOM_A05_RELAY_NORMALLY_OPEN = 1,  /**< Conducts if something is near. */
    FATHOM_A05_RELAY_NORMALLY_CLOSED = 2 /**< Conducts if nothing is near. */
} fathom_a05_relay_wiring_t;

/** @brief The level of the pin while the contact conducts. */
typedef enum {
    /** The contact goes to ground, and a resistor pulls the pin up. */
    FATHOM_A05_RELAY_CONDUCTS_LOW = 1,
    /** The contact goes to the supply, and a resistor pulls the pin down. */
    FATHOM_A05_RELAY_CONDUCTS_HIGH = 2
} fathom_a05_relay_level_t;

/** @brief Configuration. Read only during fathom_a05_relay_init(). A member that is 0 takes its default. */
typedef struct {
    /** @brief The times. contact.h has their ranges and defaults. */
    fathom_contact_timing_t timing;

    /** @brief The wired contact: a fathom_a05_relay_wiring_t. 0 selects normally open. */
    uint8_t wiring;

    /** @brief The level while the contact conducts: a fathom_a05_relay_level_t. 0 selects low. */
    uint8_t level;
} fathom_a05_relay_config_t;

/** @brief A driver, in the caller's memory. Call fathom_a05_relay_init() before use. */
typedef struct {
    fathom_contact_t base; /**< The contact. Its members may be read. */
} fathom_a05_relay_t;

/**
 * @brief Initialises a driver and reads the pin once.
 *
 * @param sensor  The driver, in any memory. Must stay valid as long as it is polled.
 * @param pin     Reads the contact, with `get`. Must stay valid as long as the driver.
 * @param clock   The clock, with `now_us`. Must stay valid as long as the driver.
 * @param config  The config. Read only during the call; what it points to must stay valid as long as the driver.
 *                NULL selects all defaults.
 * @retval FATHOM_OK            The driver can be used. Next, pass fathom_a05_relay_sensor() to fathom_poll().
 * @retval FATHOM_ERR_ARGUMENT  There is no clock or no pin that can be read, or a member is outside its range. The
 *                              driver is zeroed.
 */
fathom_status_t fathom_a05_relay_init(fathom_a05_relay_t *sensor, const fathom_pin_t *pin,
                                      const fathom_clock_t *clock, const fathom_a05_relay_config_t *config);

/**
 * @brief Polls the driver as fathom_poll() does, without a fathom_sensor_t.
 *
 * A program that calls only this function does not link the part of the driver that fathom_due_us() needs.
 *
 * @param sensor  The driver.
 * @param sample  Written with FATHOM_OK only.
 * @retval FATHOM_OK            `*sample` is a new reading. Call again at once for the next one.
 * @retval FATHOM_PENDING       There is nothing new.
 * @retval FATHOM_ERR_ARGUMENT  The initialisation failed or never ran, and the memory is zeroed.
 * @return Other errors: an attempt failed. This header lists them as errors of fathom_poll().
 */
static inline fathom_status_t fathom_a05_relay_poll(fathom_a05_relay_t *sensor, fathom_sample_t *sample)
{
    return fathom_contact_sensor_poll(&sensor->base, sample);
}

/**
 * @brief Returns the time in microseconds until the driver must be polled again if the pin does not change.
 *
 * The result is that of fathom_due_us(), without a fathom_sensor_t. It is 0 for a driver in zeroed memory.
 *
 * @param sensor  The driver.
 */
static inline uint32_t fathom_a05_relay_due_us(fathom_a05_relay_t *sensor)
{
    return fathom_contact_sensor_due_us(&sensor->base);
}

/** @brief Returns the sensor for fathom_poll() and fathom_due_us(), by value. There is no deinit: stop polling. */
static inline fathom_sensor_t fathom_a05_relay_sensor(fathom_a05_relay_t *sensor)
{
    return fathom_contact_sensor(&sensor->base);
}

#ifdef __cplusplus
}
#endif

#endif
