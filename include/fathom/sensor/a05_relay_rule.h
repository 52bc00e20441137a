/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A05_RELAY_RULE_H
#define FATHOM_A05_RELAY_RULE_H

#include "fathom/processing/debounce.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief The rule of the A05's relay (A05 4) in software, over the distances of an A05 in any other mode: the relay
 * closes if at least one probe has something nearer than the threshold, and each state lasts at least 1 s.
 *
 *     if (fathom_poll(&bumper, &sample) == FATHOM_OK && fathom_a05_relay_rule_add_sample(&rule, &sample))
 *         stop_or_go(rule.debounce.level);
 *     if (fathom_debounce_advance(&rule.debounce, clock.now_us(clock.ctx))) stop();
 *
 * All samples of one sequence number are one measurement:
 *
 * | samples | the measurement |
 * |---|---|
 * | one fitted probe is nearer | is nearer at once; the other probes cannot change that |
 * | every fitted probe has a sample, and all are farther | is farther |
 * | the same, and some are at the threshold | is equal, so the level holds |
 * | no probe is nearer, and the sample of a probe is missing, FATHOM_UNKNOWN or FATHOM_FAULT | does not count |
 *
 * A measurement that does not count leaves the level as it is until it becomes unknown (debounce.h).
 *
 * Probes that are not fitted are ignored, because their values are not defined. debounce.h has the further rules. Use
 * one rule for each sensor.
 */

/** The threshold's range and its factory setting, in mm (A05 4). */
enum { FATHOM_A05_RELAY_MIN_MM = 250, FATHOM_A05_RELAY_MAX_MM = 4500, FATHOM_A05_RELAY_DEFAULT_MM = 1000 };
/** Default of `hold_us` (A05 4). */
#define FATHOM_A05_RELAY_HOLD_US 1000000uL

/** @brief The configuration. fathom_a05_relay_rule_init() copies it. A member that is 0 takes its default. */
typedef struct {
    /** Least time that each state lasts, 1..FATHOM_MAX_DURATION_US; 0 selects 1 s, because "pull-in and cut-off time
     * will be maintained for 1 second" (A05 4(1)). 1 us is practically no hold. */
    uint32_t hold_us;
    /** Time after the last measurement that counted at which the level becomes unknown, 1..FATHOM_MAX_DURATION_US; 0
     * selects 5 s; FATHOM_NO_DEADLINE disables it. */
    uint32_t unknown_us;
    uint16_t threshold_mm; /**< 250..4500; 0 selects 1000 mm. */
    uint8_t
        probes; /**< Fitted probes that the sensor's driver reads, bit probe - 1: 1..15; 0 selects all four. */
    uint8_t equal; /**< fathom_equal_t. */
} fathom_a05_relay_rule_config_t;

/** @brief The state of one rule. The caller owns the memory. Only `debounce.level` is meant to be read. */
typedef struct {
    /** `level` is FATHOM_NEAR (closed), FATHOM_FAR (open), FATHOM_UNKNOWN (an error), or 0 (not known yet). A relay
     * without power shows the last two as open. */
    fathom_debounce_t debounce;
    uint16_t sequence; /**< Of the present measurement. */
    uint8_t probes;    /**< Invariant: 0 unless the initialisation succeeded. */
    uint8_t missing;   /**< Probes without a sample in the present measurement, bit probe - 1. */
    uint8_t verdict;   /**< On the present measurement so far. */
} fathom_a05_relay_rule_t;

/**
 * @brief Initialises a rule without a level. If it fails, the rule is zeroed; it then never has a level.
 * @retval FATHOM_OK         The rule is ready.
 * @retval FATHOM_ERR_ARGUMENT  A member is outside its range.
 */
fathom_status_t fathom_a05_relay_rule_init(fathom_a05_relay_rule_t *rule,
                                           const fathom_a05_relay_rule_config_t *config);

/** @brief Adds the sensor's next sample, at its `time_us`. Returns true if the level changed, also from none to the
 * first one. */
bool fathom_a05_relay_rule_add_sample(fathom_a05_relay_rule_t *rule, const fathom_sample_t *sample);

#ifdef __cplusplus
}
#endif

#endif
