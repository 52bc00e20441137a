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
 * The alarm works for any sensor in any mode, and behind a median (median.h). It is not a safety function. It never
 * waits, has no clock of its own and does no I/O. include/COST.md has its size in the row `alarm`.
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
 *    above `off_mm` is beyond the threshold of off. If `when` is FATHOM_FAR, a distance above `on_mm` is beyond the
 *    threshold of on, and a distance below `off_mm` is beyond the threshold of off. A sample of the kind FATHOM_NEAR is
 *    nearer than every threshold. A sample of the kind FATHOM_FAR or FATHOM_NO_TARGET is farther than every threshold.
 *    If `no_target_is_unknown` is true, FATHOM_NO_TARGET is a sample without a distance instead. Set it if a surface is
 *    always in range, such as in a tank: an ultrasonic sensor can detect nothing in foam, or if the surface is too
 *    near. For a bumper leave it false, because free space is FATHOM_NO_TARGET, and mount an ultrasonic sensor so that
 *    no object can be too near.
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
 *    A distance between the thresholds, or equal to one of them, does not change FATHOM_ALARM_ON or FATHOM_ALARM_OFF.
 *
 * 3. **Hold times.** A hold time runs from the first sample beyond the threshold to the sample that completes it. Time
 *    alone switches neither on nor off. After a distance that is not beyond that threshold, the hold time starts again.
 *    After a time without a distance it starts again only if that time was longer than `unknown_us`.
 *
 * 4. **Which side without a distance.** In FATHOM_ALARM_UNKNOWN, `if_unknown` decides whether the alarm is on. In
 *    FATHOM_ALARM_NO_RESPONSE, `if_no_response` does. There is no default, because a bumper, a tank and a pit differ. A
 *    distance beyond a threshold ends these states after its hold time, and not before. Any other distance ends them at
 *    once. The state is then the newer of FATHOM_ALARM_ON and FATHOM_ALARM_OFF, or `if_unknown` if the alarm was in
 *    neither before.
 *
 * 5. **Whether the device responds.** The newest call that proves something about the device decides this (the table of
 *    fathom_alarm_add_status()). For example, FATHOM_PENDING proves nothing. Samples of the kinds FATHOM_UNKNOWN and
 *    FATHOM_FAULT are responses without a distance. A device that has never responded counts as not responding. Before
 *    the first distance, `unknown_us` counts from the first call.
 *
 * 6. **Several probes.** Each probe needs an alarm of its own. Pass a sample only to the alarm of its probe
 *    (`sample.probe`). You may call fathom_alarm_add_status() with FATHOM_OK for the other alarms, to show that the
 *    device responds.
 *
 * 7. **Times.** `now_us` and the `time_us` of the samples must be from the same clock. They may wrap. The time between
 *    two calls and `unknown_us` must together be below 35 minutes. After a longer pause, initialise the alarm again. A
 *    sample that is up to 100 ms older than the previous sample counts as equally old. Do not pass an older one: it can
 *    complete a hold time at once.
 *
 * 8. **Contexts.** An interrupt may call the functions. Two contexts, such as an interrupt and the main loop, must not
 *    use the same alarm at once.
 */

/** @brief The state of an alarm. */
typedef enum {
    FATHOM_ALARM_ON = 1,  /**< Distances are beyond the threshold of on. */
    FATHOM_ALARM_OFF = 2, /**< Distances are beyond the threshold of off. */
    FATHOM_ALARM_UNKNOWN =
        3, /**< There is no distance; the device responds, or this is the state after init. */
    FATHOM_ALARM_NO_RESPONSE = 4 /**< There is no distance; the device does not respond, or never did. */
} fathom_alarm_state_t;

/** @brief Default of `unknown_us`, in microseconds. */
#define FATHOM_ALARM_DEFAULT_UNKNOWN_US 5000000uL

/** @brief The configuration of an alarm. */
typedef struct {
    /** Time for which distances must be beyond `on_mm` before the alarm is on, in microseconds,
     * 0..FATHOM_MAX_DURATION_US. 0: the first sample switches the alarm on. */
    uint32_t on_hold_us;
    uint32_t off_hold_us; /**< The same with `off_mm` and off. */
    /** Time without a distance after which the distance is unknown, in microseconds, 1..FATHOM_MAX_DURATION_US. Choose
     * more than the interval between two samples. 0 selects 5 s. This limit cannot be disabled. */
    uint32_t unknown_us;
    uint16_t on_mm;  /**< Threshold of on, 0..65535 mm. */
    uint16_t off_mm; /**< Threshold of off. With FATHOM_NEAR: on_mm..65535; with FATHOM_FAR: 0..on_mm. */
    uint8_t when;    /**< FATHOM_NEAR or FATHOM_FAR. Required. */
    /** FATHOM_ALARM_ON or FATHOM_ALARM_OFF: the side in the state FATHOM_ALARM_UNKNOWN (rule 4). Required. */
    uint8_t if_unknown;
    uint8_t if_no_response; /**< The same in the state FATHOM_ALARM_NO_RESPONSE. Required. */
    bool
        no_target_is_unknown; /**< FATHOM_NO_TARGET is no distance. False: it is farther than every threshold. */
} fathom_alarm_config_t;

/** @brief An alarm. The caller owns the memory. The caller may read `state`. All other members are private. */
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
 * | all others, such as FATHOM_ERR_CHECKSUM and FATHOM_ERR_PORT | the device counts as not responding |
 *
 * If only results of the first line arrive from the start, the state is FATHOM_ALARM_NO_RESPONSE after `unknown_us`. In
 * FATHOM_ALARM_ON and FATHOM_ALARM_OFF, a time before that of the newest distance does not change the state.
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
