/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_ALARM_H
#define FATHOM_ALARM_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/sample.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief An alarm on the distance of one probe: two thresholds, hold times, and a side for the time without a distance.
 *
 * The alarm works for any sensor in any mode, and behind a median. It is not a safety function. include/COST.md has its
 * size in the row `alarm`.
 *
 * @code
 * static const fathom_alarm_config_t bumper = {.when = FATHOM_NEAR, .on_mm = 500, .off_mm = 600,
 *     .if_unknown = FATHOM_ALARM_ON, .if_no_response = FATHOM_ALARM_ON};
 * status = fathom_poll(&sensor, &sample);
 * if (status == FATHOM_OK ? fathom_alarm_add_sample(&alarm, &sample)
 *                            : fathom_alarm_add_status(&alarm, status, clock.now_us(clock.ctx)))
 *     stop_or_go(fathom_alarm_is_on(&alarm));
 * @endcode
 *
 * | state | when it is reached |
 * |---|---|
 * | FATHOM_ALARM_ON | something is nearer than `on_mm` (`when` FATHOM_NEAR) or farther (FATHOM_FAR) for `on_hold_us` |
 * | FATHOM_ALARM_OFF | something is farther than `off_mm`, or nearer, for `off_hold_us` |
 * | FATHOM_ALARM_UNKNOWN | no distance for more than `unknown_us`, and the device responds; also at first |
 * | FATHOM_ALARM_NO_RESPONSE | no distance for more than `unknown_us`, and the device does not respond, or never did |
 *
 * Whether a device responds is decided by the last call before. FATHOM_UNKNOWN, FATHOM_FAULT, a refused value and a
 * warm-up are responses without a distance. From the initialisation on, `unknown_us` begins with the first call.
 *
 * Between the thresholds, and at them, the state holds. In the last two states the caller's `if_unknown` and
 * `if_no_response` decide whether the alarm is on. There is no default, because a bumper, a tank and a pit differ. A
 * distance beyond a threshold ends these states after its hold time. A distance between the thresholds ends them at
 * once: the state is then the one before them, or `if_unknown` if there was none.
 *
 * A hold time runs from the first sample beyond the threshold to the sample that ends it. Time alone switches neither
 * on nor off. A distance that is not beyond the threshold begins the hold time again, and so does a time of
 * `unknown_us` without a distance; a shorter time without a distance does not.
 *
 * FATHOM_NO_TARGET and FATHOM_FAR are farther than every threshold, FATHOM_NEAR is nearer. With `no_target_is_unknown`,
 * FATHOM_NO_TARGET is no distance: an ultrasonic sensor may detect nothing in foam, or too near.
 *
 * The functions use no clock but the times that they are given, may be called from any context, and do no I/O.
 */

/** @brief The state of an alarm. */
typedef enum {
    FATHOM_ALARM_ON = 1,         /**< Beyond `on_mm`. */
    FATHOM_ALARM_OFF = 2,        /**< Beyond `off_mm`. */
    FATHOM_ALARM_UNKNOWN = 3,    /**< No distance; the device responds. */
    FATHOM_ALARM_NO_RESPONSE = 4 /**< No distance; the device does not respond. */
} fathom_alarm_state_t;

/** Default of `unknown_us`. */
#define FATHOM_ALARM_DEFAULT_UNKNOWN_US 5000000uL

/** @brief The configuration of an alarm. */
typedef struct {
    /** Time for which something must be beyond `on_mm` before the alarm is on, 0..FATHOM_MAX_DURATION_US; 0: the first
     * sample switches it on. */
    uint32_t on_hold_us;
    uint32_t off_hold_us; /**< The same with `off_mm` and off. */
    /** Time without a distance after which the distance is not known, 1..FATHOM_MAX_DURATION_US. Choose more than the
     * interval between two samples. 0 selects 5 s. It cannot be disabled. */
    uint32_t unknown_us;
    uint16_t on_mm;  /**< Threshold of on, 0..65535 mm. */
    uint16_t off_mm; /**< Threshold of off. With FATHOM_NEAR: on_mm..65535; with FATHOM_FAR: 0..on_mm. */
    uint8_t when;    /**< FATHOM_NEAR or FATHOM_FAR. Required. */
    /** FATHOM_ALARM_ON or FATHOM_ALARM_OFF: what fathom_alarm_is_on() reports in FATHOM_ALARM_UNKNOWN. Required. */
    uint8_t if_unknown;
    uint8_t if_no_response; /**< The same in FATHOM_ALARM_NO_RESPONSE. Required. */
    bool
        no_target_is_unknown; /**< FATHOM_NO_TARGET is no distance. False: it is farther than every threshold. */
} fathom_alarm_config_t;

/** @brief An alarm. The caller owns the memory. Only `state` is meant to be read. */
typedef struct {
    fathom_alarm_config_t config; /**< The configuration, with the default filled in. */
    uint32_t fed_us;   /**< Time of the last distance; before the first distance, of the first call. */
    uint32_t since_us; /**< Time of the first distance on this side. */
    uint8_t state;     /**< fathom_alarm_state_t. Invariant: 0 unless the initialisation succeeded. */
    uint8_t was;       /**< FATHOM_ALARM_ON or FATHOM_ALARM_OFF, whichever was the state last. */
    /** Of the last distance: FATHOM_ALARM_ON or FATHOM_ALARM_OFF, beyond that threshold; 0: neither;
     * FATHOM_ALARM_UNKNOWN: the last distance is more than `unknown_us` ago. */
    uint8_t side;
    bool is_fed;   /**< `fed_us` is set. */
    bool responds; /**< The device responded at the last call. */
} fathom_alarm_t;

/**
 * @brief Initialises an alarm in the state FATHOM_ALARM_UNKNOWN.
 *
 * If the function fails, the alarm is zeroed: its state is 0 and never changes, and fathom_alarm_is_on() is false.
 * Check the result.
 *
 * @param alarm   The alarm.
 * @param config  The configuration. Not used after the call.
 * @retval FATHOM_OK            The alarm is ready.
 * @retval FATHOM_ERR_ARGUMENT  A required member is missing, or a member is outside its range.
 */
fathom_status_t fathom_alarm_init(fathom_alarm_t *alarm, const fathom_alarm_config_t *config);

/**
 * @brief Adds a sample of the probe, at its `time_us`.
 *
 * Times may wrap. The time between two calls and `unknown_us` must together be below 35 minutes. A time that is up to
 * 100 ms before the previous one counts as equal to it.
 *
 * @param alarm   The alarm.
 * @param sample  The sample. Samples of one probe only.
 * @return True if the state changed.
 */
bool fathom_alarm_add_sample(fathom_alarm_t *alarm, const fathom_sample_t *sample);

/**
 * @brief Adds a result without a sample. A time before that of the last sample has no effect on the state.
 *
 * | status | meaning |
 * |---|---|
 * | FATHOM_PENDING, FATHOM_ERR_LINE_BUSY, FATHOM_ERR_OTHER_MASTER | time has passed; nothing is known of the device |
 * | FATHOM_ERR_MALFORMED, FATHOM_ERR_EXCEPTION, FATHOM_ERR_WARMING_UP | the device responds without a distance |
 * | FATHOM_OK | the same: a sample of another probe, or a sample without a median |
 * | other errors | the device does not respond |
 *
 * @param alarm   The alarm.
 * @param status  The result of fathom_poll().
 * @param now_us  The clock, in microseconds.
 * @return True if the state changed.
 */
bool fathom_alarm_add_status(fathom_alarm_t *alarm, fathom_status_t status, uint32_t now_us);

/** @brief Returns true if the alarm is on, by its state or by the side that the configuration names for the state. */
bool fathom_alarm_is_on(const fathom_alarm_t *alarm);

#ifdef __cplusplus
}
#endif

#endif
