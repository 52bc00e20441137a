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
 * The alarm works for any sensor in any mode, and behind a median. It is not a safety function. It never waits, has no
 * clock of its own and does no I/O. include/COST.md has its size in the row `alarm`.
 *
 * @code
 * static const fathom_alarm_config_t bumper = {.when = FATHOM_NEAR, .on_mm = 500, .off_mm = 600,
 *     .if_unknown = FATHOM_ALARM_ON, .if_no_response = FATHOM_ALARM_ON};
 * static fathom_alarm_t alarm;
 *
 * if (fathom_alarm_init(&alarm, &bumper) != FATHOM_OK) fail();
 * stop_or_go(fathom_alarm_is_on(&alarm));                           // the side before the first distance
 * for (;;) {
 *     const fathom_status_t status = fathom_poll(&sensor, &sample);
 *     const bool has_changed = status == FATHOM_OK ? fathom_alarm_add_sample(&alarm, &sample)
 *                                                  : fathom_alarm_add_status(&alarm, status, clock.now_us(clock.ctx));
 *     if (has_changed) stop_or_go(fathom_alarm_is_on(&alarm));
 * }
 * @endcode
 *
 * 1. **Thresholds.** If `when` is FATHOM_NEAR, a distance below `on_mm` is beyond the threshold of on, and a distance
 *    above `off_mm` is beyond the threshold of off. If `when` is FATHOM_FAR, it is the reverse: above `on_mm` and below
 *    `off_mm`. A sample of the kind FATHOM_NEAR counts as 0 mm. A sample of the kind FATHOM_FAR or FATHOM_NO_TARGET is
 *    farther than every threshold. With `no_target_is_unknown`, FATHOM_NO_TARGET has no distance (rule 5); an ultrasonic
 *    sensor can detect nothing in foam, or if the surface is too near.
 *
 * 2. **States.**
 *
 *    | state | reached when |
 *    |---|---|
 *    | FATHOM_ALARM_ON | distances are beyond the threshold of on for at least `on_hold_us` |
 *    | FATHOM_ALARM_OFF | distances are beyond the threshold of off for at least `off_hold_us` |
 *    | FATHOM_ALARM_UNKNOWN | after init; or there was no distance for more than `unknown_us`, and the device responds |
 *    | FATHOM_ALARM_NO_RESPONSE | there was no distance for more than `unknown_us`, and the device does not respond |
 *
 *    Distances between the thresholds, or equal to one of them, do not change FATHOM_ALARM_ON or _OFF.
 *
 * 3. **Hold times.** A hold time runs from the first sample beyond the threshold to the sample that completes it; time
 *    alone switches neither on nor off. A distance that is not beyond that threshold starts the hold time again. A time
 *    without a distance starts it again only if it is longer than `unknown_us`.
 *
 * 4. **Which side without a distance.** In the last two states, `if_unknown` and `if_no_response` decide whether the
 *    alarm is on. There is no default, because a bumper, a tank and a pit differ. A distance beyond a threshold ends
 *    these states after its hold time; until then the state stays. A distance between the thresholds ends them at once:
 *    the state is then FATHOM_ALARM_ON or _OFF, whichever was the last of the two, or `if_unknown` if there was none.
 *
 * 5. **Whether the device responds.** The newest call that says something about the device decides this (the table of
 *    fathom_alarm_add_status()). FATHOM_PENDING, for example, changes nothing. Samples of the kinds FATHOM_UNKNOWN and
 *    FATHOM_FAULT are responses without a distance. A device that was never heard counts as not responding. Before the
 *    first distance, `unknown_us` counts from the first call.
 *
 * 6. **Several probes.** Each probe needs an alarm of its own. Pass a sample only to the alarm of its probe
 *    (`sample.probe`). You may call fathom_alarm_add_status() with FATHOM_OK for the other alarms, to show that the
 *    device responds.
 *
 * 7. **Times.** `now_us` and the `time_us` of the samples must be from the same clock. They may wrap. The time between two
 *    calls and `unknown_us` must together be below 35 minutes; after a longer pause initialise the alarm again. A sample
 *    that is up to 100 ms older than the sample before it counts as equally old.
 *
 * 8. **Contexts.** The functions may be called from an interrupt. Two contexts must not use the same alarm at once.
 */

/** @brief The state of an alarm. */
typedef enum {
    FATHOM_ALARM_ON = 1,  /**< Distances are beyond the threshold of on. */
    FATHOM_ALARM_OFF = 2, /**< Distances are beyond the threshold of off. */
    FATHOM_ALARM_UNKNOWN =
        3, /**< There is no distance; the device responds, or this is the state after init. */
    FATHOM_ALARM_NO_RESPONSE = 4 /**< There is no distance; the device does not respond, or never did. */
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
 * Check the result: a bumper that is never on is dangerous.
 *
 * @param alarm   The alarm.
 * @param config  The configuration. Not used after the call.
 * @retval FATHOM_OK            The alarm is ready.
 * @retval FATHOM_ERR_ARGUMENT  A required member is missing, or a member is outside its range.
 */
fathom_status_t fathom_alarm_init(fathom_alarm_t *alarm, const fathom_alarm_config_t *config);

/**
 * @brief Adds a sample of the probe, at its `time_us` (rule 7).
 *
 * @param alarm   The alarm.
 * @param sample  The sample. Samples of one probe only.
 * @return True if the state changed.
 */
bool fathom_alarm_add_sample(fathom_alarm_t *alarm, const fathom_sample_t *sample);

/**
 * @brief Adds a result without a sample, or time that has passed.
 *
 * | status | meaning |
 * |---|---|
 * | FATHOM_PENDING, FATHOM_ERR_LINE_BUSY, FATHOM_ERR_OTHER_MASTER | time has passed; the device may respond or not |
 * | FATHOM_ERR_MALFORMED, FATHOM_ERR_EXCEPTION, FATHOM_ERR_WARMING_UP | the device responds without a distance |
 * | FATHOM_OK | the device responds without a distance: the sample was of another probe, or the median has no value yet |
 * | other errors | the device does not respond |
 *
 * If only results of the first line arrive from the start, the state is FATHOM_ALARM_NO_RESPONSE after `unknown_us`. A
 * time before that of the newest sample does not change the state.
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
