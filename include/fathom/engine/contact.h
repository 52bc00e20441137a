/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_CONTACT_H
#define FATHOM_CONTACT_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/sensor.h"
#include "fathom/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Reads a level that a sensor drives: a switch or a relay.
 *
 * a16_switch.h and a05_relay.h are built on this file, and any other switch can be read with it. No function waits.
 * Call all functions of one contact from one context. include/COST.md has the size in the rows of the two drivers.
 *
 * Each poll reads the pin once, which is a *look*. What the level does between two looks is not seen. A level *counts*
 * while it was equal at every look for `settle_us`.
 *
 * **What a program gets.** The first level that counts is a sample, and so is each new one. A level that does not
 * change is a sample again after each `period_us` (default 1 s), so that a program can distinguish a contact that
 * stands still from one that is not read any more. A level that does not count for `stale_us` (default 2 s) is
 * FATHOM_ERR_STALE.
 *
 * **How long a program can be without an outcome.** If the longest time between two polls is P, each sample or error
 * follows the one before, or the initialisation, within
 *
 *     period_us + stale_us + 2 * P                 by default 3 s + 2 * P
 *
 * by the clock of the configuration, whatever the pin and the guard do. If the clock stands still, the time stands
 * still with it. If the clock is set back by up to 100 ms, the bound grows by that amount.
 *
 * **Age.** `raw` and `kind` are always the level at the look of the poll that returns the sample. At most 71 minutes
 * may pass between two looks, because the clock wraps: call fathom_contact_init() again after a longer pause.
 *
 * **Sequence.** Each sample increments `sequence`. A new number shows that the pin was read, not that the sensor
 * measured again: the sensor's own period is in the header of its driver.
 */

/** Default of `settle_us`. */
#define FATHOM_CONTACT_DEFAULT_SETTLE_US 20000u
/** Default of `period_us`. */
#define FATHOM_CONTACT_DEFAULT_PERIOD_US 1000000u
/** Default of `interval_us`. */
#define FATHOM_CONTACT_DEFAULT_INTERVAL_US 10000u
/** Default of `stale_us`. */
#define FATHOM_CONTACT_DEFAULT_STALE_US 2000000u

/** Silence after the last byte of a line on the same pin, in microseconds: more than a character at 9600 baud, which a
 * look could hit. While the guard is not clear, the next look is due after this time. */
#define FATHOM_CONTACT_QUIET_US 5000u

/** @brief The times of a contact. A member that is 0 takes its default. */
typedef struct {
    /** Time for which a level must be equal before it counts: 1..stale_us - 1; 0 selects 20000 us. Choose more than a
     * contact bounces, and more than a response on the pin takes. With 1, two equal looks are enough. */
    uint32_t settle_us;
    /** Time after which a level that does not change is a sample again: 1..FATHOM_MAX_DURATION_US; 0 selects 1 s. A
     * program that needs changes only chooses a long time, and compares `kind` with that of the previous sample. */
    uint32_t period_us;
    /** Longest time that fathom_due_us() returns while a level counts: 1..FATHOM_MAX_DURATION_US; 0 selects 10000 us.
     * If an interrupt of the pin wakes the program, FATHOM_NO_DEADLINE leaves `period_us` as the only limit. */
    uint32_t interval_us;
    /** Time without a level that counts after which the error is FATHOM_ERR_STALE: settle_us +
     * 1..FATHOM_MAX_DURATION_US; 0 selects 2 s. It cannot be disabled. */
    uint32_t stale_us;
} fathom_contact_timing_t;

/** @brief What else uses the pin, and when its level has no meaning. fathom_contact_line_guard() makes one of a line.
 * All functions are required. The guard must stay valid as long as the contact. */
typedef struct {
    /** Called before each look. Returns FATHOM_PENDING, or an error that the contact's poll returns if it has neither a
     * sample nor an error of its own. */
    fathom_status_t (*poll)(void *ctx);
    bool (*is_clear)(void *ctx, uint32_t now_us); /**< Returns true if the level has a meaning now. */
    uint32_t (*due_us)(void *ctx); /**< Returns the time until `poll` must be called, as fathom_due_us(). */
    void *ctx;                     /**< Passed to the functions. */
} fathom_contact_guard_t;

/** @brief A contact. The caller owns the memory and sets the first six members before fathom_contact_init(). */
typedef struct {
    const fathom_pin_t *pin;             /**< An input, with `get`. Must stay valid as long as the contact. */
    const fathom_clock_t *clock;         /**< With `now_us`. Must stay valid as long as the contact. */
    const fathom_contact_guard_t *guard; /**< NULL: nothing else uses the pin. */
    bool near_is_high;                   /**< A high level is FATHOM_NEAR; else it is FATHOM_FAR. */
    uint8_t model;                       /**< Of the samples; fathom_model_t. */
    uint8_t address;                     /**< Of the samples. */

    /* Members of the contact. They may be read. */
    fathom_contact_timing_t timing; /**< Invariant: `interval_us` is 0 unless the initialisation succeeded. */
    uint32_t sampled_us;            /**< Time of the last look. */
    uint32_t since_us;              /**< Time of the first look that saw the present level. */
    uint32_t settle_us;             /**< Time until the level counts; 0: it counts. */
    uint32_t period_us;             /**< Time until the level is a sample again. */
    uint32_t stale_us;              /**< Time until the level is stale. */
    uint16_t sequence;              /**< Number of the last sample; wraps. */
    uint8_t last_kind;              /**< Kind of the last sample; 0: there was none. */
    bool is_high;                   /**< The level at the last look. */
    bool is_clear;                  /**< The level at the last look had a meaning. */
    bool is_held;                   /**< fathom_contact_set_hold() is in force. */
} fathom_contact_t;

/**
 * @brief Initialises a contact and reads the pin once.
 *
 * If the function fails, the contact is zeroed: set its members again before the next try.
 *
 * @param contact  The contact, with its first six members set.
 * @param timing   The times. Not used after the call.
 * @retval FATHOM_OK            The contact is ready.
 * @retval FATHOM_ERR_ARGUMENT  There is no pin that can be read, no clock, a guard without one of its functions, or a
 *                              time outside its range.
 */
fathom_status_t fathom_contact_init(fathom_contact_t *contact, const fathom_contact_timing_t *timing);

/**
 * @brief Changes what a high level means.
 *
 * The level must settle again. If its kind is the same then, there is no sample before `period_us` is over.
 *
 * @param contact       The contact.
 * @param near_is_high  True if a high level is FATHOM_NEAR.
 */
void fathom_contact_set_near_is_high(fathom_contact_t *contact, bool near_is_high);

/**
 * @brief Stops the level from counting while its meaning is about to change.
 *
 * After the hold the level must settle again. A hold that does not end is FATHOM_ERR_STALE after each `stale_us`.
 *
 * @param contact  The contact.
 * @param hold     True to start the hold, false to end it.
 */
void fathom_contact_set_hold(fathom_contact_t *contact, bool hold);

/**
 * @brief Polls a driver of unknown type: the `poll` of its fathom_sensor_t. Programs call fathom_contact_poll().
 *
 * @param ctx     The driver, a fathom_contact_t.
 * @param sample  Written with FATHOM_OK only.
 * @return As fathom_contact_poll().
 */
fathom_status_t fathom_contact_sensor_poll(void *ctx, fathom_sample_t *sample);

/**
 * @brief Returns when a driver of unknown type is due: the `due_us` of its fathom_sensor_t.
 *
 * @param ctx  The driver, a fathom_contact_t.
 * @return As fathom_contact_due_us().
 */
uint32_t fathom_contact_sensor_due_us(void *ctx);

/**
 * @brief Polls the driver as fathom_poll() does, without a fathom_sensor_t.
 *
 * A program that calls only this function does not link the part of the driver that fathom_due_us() needs.
 *
 * @param contact  The driver.
 * @param sample   Written with FATHOM_OK only.
 * @retval FATHOM_OK            `*sample` is a new reading. Call again at once for the next one.
 * @retval FATHOM_PENDING       There is nothing new.
 * @retval FATHOM_ERR_ARGUMENT  The initialisation failed or never ran, and the memory is zeroed.
 * @return Other errors: an attempt failed. This header lists them as errors of fathom_poll().
 */
static inline fathom_status_t fathom_contact_poll(fathom_contact_t *contact, fathom_sample_t *sample)
{
    return fathom_contact_sensor_poll(contact, sample);
}

/**
 * @brief Returns the time in microseconds until the driver must be polled again if the pin does not change.
 *
 * The result is that of fathom_due_us(), without a fathom_sensor_t. It is 0 for a driver in zeroed memory.
 *
 * @param contact  The driver.
 */
static inline uint32_t fathom_contact_due_us(fathom_contact_t *contact)
{
    return fathom_contact_sensor_due_us(contact);
}

/**
 * @brief Returns the sensor for fathom_poll() and fathom_due_us(). Each poll is one look, and one poll of the guard.
 *
 * - FATHOM_OK: a sample. `raw` is the level, 1 for high. `time_us` is the first look that saw this level if the kind
 *   is new and that look was at most `stale_us` ago, and the present look otherwise.
 * - FATHOM_PENDING: nothing new; the level may be settling.
 * - FATHOM_ERR_STALE: no level counted for `stale_us`, because the level never stands still, the guard is never clear,
 *   or the contact is held. Returned after each further `stale_us`.
 * - FATHOM_ERR_PORT: the port of the guard's line is broken. Returned by every poll that has neither a sample nor
 *   FATHOM_ERR_STALE.
 * - FATHOM_ERR_ARGUMENT: the initialisation failed or never ran, and the memory is zeroed. fathom_due_us() is 0 then.
 *
 * A cut wire is no error: it reads as the level that the board pulls the pin to.
 */
static inline fathom_sensor_t fathom_contact_sensor(fathom_contact_t *contact)
{
    return fathom_sensor_make(fathom_contact_sensor_poll, fathom_contact_sensor_due_us, contact);
}

#ifdef __cplusplus
}
#endif

#endif
