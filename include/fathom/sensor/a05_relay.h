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
 * @brief A05 with relay output (A05 4): its relay closes if any of its four probes has something nearer than the
 * threshold, which is 1 m with factory settings. Each state lasts about 1 s.
 *
 * A user teaches the threshold on the board, with a button and a flat target in front of probe 4 (A05 4(2)). A program
 * can neither read nor set it. a05_relay_rule.h is the same rule in software, for an A05 in any other mode.
 *
 * The samples are FATHOM_NEAR or FATHOM_FAR, without a distance or a probe. contact.h states when there is a sample,
 * what its `time_us` and `raw` are, and within which time a program that polls gets a sample or an error: 3 s + 2 * P
 * by default, where P is the longest time between two polls.
 *
 * | error of fathom_poll() | cause |
 * |---|---|
 * | FATHOM_ERR_STALE | the contact was not equal for `settle_us` within `stale_us`: noise, a worn or a loose contact |
 * | FATHOM_ERR_ARGUMENT | the initialisation failed or never ran, and the memory is zeroed |
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
    FATHOM_A05_RELAY_CONDUCTS_LOW = 1, /**< The contact goes to ground, and a resistor pulls the pin up. */
    FATHOM_A05_RELAY_CONDUCTS_HIGH =
        2 /**< The contact goes to the supply, and a resistor pulls the pin down. */
} fathom_a05_relay_level_t;

/** @brief The configuration. fathom_a05_relay_init() copies it; what it points to must stay valid as long as the
 * driver. A member that is 0 takes its default. */
typedef struct {
    const fathom_pin_t *pin;        /**< Reads the contact. Required, with `get`. */
    const fathom_clock_t *clock;    /**< Required, with `now_us`. */
    fathom_contact_timing_t timing; /**< The times; contact.h has their ranges. */
    uint8_t wiring;                 /**< fathom_a05_relay_wiring_t; 0 selects normally open. */
    uint8_t level; /**< fathom_a05_relay_level_t; 0 selects low while the contact conducts. */
} fathom_a05_relay_config_t;

/** @brief The driver. The caller owns the memory. */
typedef struct {
    fathom_contact_t base;
} fathom_a05_relay_t;

/**
 * @brief Initialises the driver and reads the pin once. If it fails, the driver is zeroed.
 * @retval FATHOM_OK         The driver is ready.
 * @retval FATHOM_ERR_ARGUMENT  There is no clock, no pin that can be read, or a member outside its range.
 */
fathom_status_t fathom_a05_relay_init(fathom_a05_relay_t *sensor, const fathom_a05_relay_config_t *config);

/** @brief Returns the sensor for fathom_poll() and fathom_due_us(). There is no deinit: stop polling. */
fathom_sensor_t fathom_a05_relay_sensor(fathom_a05_relay_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
