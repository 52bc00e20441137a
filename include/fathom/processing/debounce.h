/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_DEBOUNCE_H
#define FATHOM_DEBOUNCE_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/sample.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief A switch made of distances: the rule of the A16's switch output (A16 4(2)), for any sensor in any mode.
 *
 * `near_count` measurements in a row nearer than the threshold make the level FATHOM_NEAR. `far_count` measurements
 * in a row farther than the threshold make it FATHOM_FAR. With `hold_us` a level also lasts for a least time, as that
 * of the A05's relay does (A05 4(1)).
 *
 * @code
 * fathom_debounce_t gate;
 * fathom_debounce_init(&gate, &(fathom_debounce_config_t){.threshold_mm = 800});
 * if (fathom_poll(&sensor, &sample) == FATHOM_OK && fathom_debounce_add_sample(&gate, &sample))
 *     open_or_close(gate.level);
 * if (fathom_debounce_advance(&gate, clock.now_us(clock.ctx))) warn();
 * @endcode
 *
 * | measurement | input |
 * |---|---|
 * | farther | a distance above the threshold; FATHOM_NO_TARGET, with or without interference; FATHOM_FAR |
 * | nearer | a distance below the threshold; FATHOM_NEAR |
 * | equal | a distance at the threshold |
 * | none | FATHOM_UNKNOWN, FATHOM_FAULT, or an error, which has no sample |
 *
 * At an equal measurement the level holds and both rows begin again, because "3 times in a row is less" (A16 4(2)) is
 * not true then. Without a measurement the level holds too, and a row continues behind the gap.
 *
 * If no measurement counts for more than `unknown_us`, the level becomes FATHOM_UNKNOWN. Treat that as a broken wire.
 * A new level then needs a whole row and does not wait for `hold_us`. If samples stop, only the loop knows the time,
 * so it must call fathom_debounce_advance().
 *
 * Otherwise only a measurement changes the level. If `hold_us` delays a change, the first measurement after it makes
 * the change, if its row is still unbroken.
 *
 * The functions use no clock but the times that they are given, may be called from any context, and do no I/O.
 */

/** Default of `unknown_us`: twice the A16's 5 measurements of 500 ms (A16 4(2)). */
#define FATHOM_DEBOUNCE_DEFAULT_UNKNOWN_US 5000000uL

/** @brief Defaults of the other members: the A16's factory settings (A16 4(2)). */
enum {
    FATHOM_DEBOUNCE_DEFAULT_THRESHOLD_MM = 1000, /**< Default of `threshold_mm`. */
    FATHOM_DEBOUNCE_DEFAULT_NEAR_COUNT = 3,      /**< Default of `near_count`. */
    FATHOM_DEBOUNCE_DEFAULT_FAR_COUNT = 5        /**< Default of `far_count`. */
};

/** @brief What a distance at the threshold is. The datasheet names less and greater only. */
typedef enum {
    FATHOM_EQUAL_HOLDS = 0,   /**< The default: a target that stands at the threshold changes nothing. */
    FATHOM_EQUAL_IS_NEAR = 1, /**< The distance is nearer. */
    FATHOM_EQUAL_IS_FAR = 2   /**< The distance is farther. */
} fathom_equal_t;

/** @brief The configuration. A member that is 0 takes its default. */
typedef struct {
    /** Least time that a level lasts, by the times of the measurements, 0..FATHOM_MAX_DURATION_US; 0: no such time. */
    uint32_t hold_us;
    /** Time after the last measurement that counted at which the level becomes unknown, 1..FATHOM_MAX_DURATION_US.
     * Choose more than the interval between two measurements. 0 selects 5 s; FATHOM_NO_DEADLINE disables it. */
    uint32_t unknown_us;
    uint16_t threshold_mm; /**< 1..65535; 0 selects 1000 mm. */
    uint8_t near_count;    /**< Nearer measurements in a row, 1..255; 0 selects 3. */
    uint8_t far_count;     /**< Farther measurements in a row, 1..255; 0 selects 5. */
    uint8_t equal;         /**< fathom_equal_t. */
} fathom_debounce_config_t;

/** @brief The state of one switch. The caller owns the memory. Only `level` is meant to be read. */
typedef struct {
    fathom_debounce_config_t config; /**< Invariant: `near_count` is 0 unless the initialisation succeeded. */
    uint32_t fed_us;                 /**< Time of the last measurement that counted. */
    uint32_t left_us;                /**< Rest of `hold_us` at `fed_us`. */
    /** FATHOM_NEAR, FATHOM_FAR or FATHOM_UNKNOWN; 0: no row has been long enough yet. Treat 0 as unknown too. */
    uint8_t level;
    uint8_t
        verdict; /**< Of the row: FATHOM_NEAR, FATHOM_FAR, or another value if the last measurement was equal. */
    uint8_t row; /**< Length of the row; stops at 255. */
    bool is_fed; /**< There was a measurement. */
} fathom_debounce_t;

/**
 * @brief Initialises a switch without a measurement and without a level.
 *
 * The first level that a row makes does not wait for `hold_us`. If the function fails, the switch is zeroed; it then
 * never has a level.
 *
 * @param debounce  The switch.
 * @param config    The configuration. Not used after the call.
 * @retval FATHOM_OK            The switch is ready.
 * @retval FATHOM_ERR_ARGUMENT  A member is outside its range.
 */
fathom_status_t fathom_debounce_init(fathom_debounce_t *debounce, const fathom_debounce_config_t *config);

/**
 * @brief Adds a measurement that was compared elsewhere.
 *
 * Times may wrap. The time between two measurements must be below 71 minutes; together with `unknown_us` it must be
 * below 35 minutes. A time that is up to 100 ms before the previous one counts as equal to it.
 *
 * @param debounce  The switch.
 * @param verdict   FATHOM_NEAR: nearer. FATHOM_FAR: farther. Any other value: equal.
 * @param now_us    Time of the measurement, in microseconds.
 * @return True if the level changed, also from none to the first one, or to unknown.
 */
bool fathom_debounce_add_verdict(fathom_debounce_t *debounce, uint8_t verdict, uint32_t now_us);

/**
 * @brief Adds a distance. As fathom_debounce_add_verdict().
 *
 * @param debounce     The switch.
 * @param distance_mm  The distance in millimetres, 0 to 65535.
 * @param now_us       Time of the measurement, in microseconds.
 * @return As fathom_debounce_add_verdict().
 */
bool fathom_debounce_add_distance(fathom_debounce_t *debounce, uint16_t distance_mm, uint32_t now_us);

/**
 * @brief Adds any sample, at its `time_us`. As fathom_debounce_add_verdict().
 *
 * @param debounce  The switch.
 * @param sample    The sample. Samples of one probe only.
 * @return As fathom_debounce_add_verdict().
 */
bool fathom_debounce_add_sample(fathom_debounce_t *debounce, const fathom_sample_t *sample);

/**
 * @brief Advances the switch to `now_us` without a measurement.
 *
 * Call it often enough that the time between two calls and `unknown_us` are together below 35 minutes. A time before
 * that of the last measurement has no effect.
 *
 * @param debounce  The switch.
 * @param now_us    The clock, in microseconds.
 * @return True if the level became FATHOM_UNKNOWN.
 */
bool fathom_debounce_advance(fathom_debounce_t *debounce, uint32_t now_us);

/**
 * @brief Compares a distance with the threshold. Changes nothing.
 *
 * @param debounce     The switch.
 * @param distance_mm  The distance in millimetres, 0 to 65535.
 * @retval FATHOM_NEAR  The distance is nearer.
 * @retval FATHOM_FAR   The distance is farther.
 * @retval 0            The distance is equal, and the level holds.
 */
uint8_t fathom_debounce_compare(const fathom_debounce_t *debounce, uint16_t distance_mm);

#ifdef __cplusplus
}
#endif

#endif
