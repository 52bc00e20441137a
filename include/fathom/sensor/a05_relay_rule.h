/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A05_RELAY_RULE_H
#define FATHOM_A05_RELAY_RULE_H

#include "fathom/processing/debounce.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Applies the rule of the A05's relay (datasheet A05 4) to the distances of an A05 in any other mode.
 *
 * The rule closes if at least one probe has something nearer than the threshold, and each state lasts at least 1 s. It
 * uses samples only: it has no clock, no I/O and no allocation. Use one rule for each sensor. include/COST.md has its
 * flash, RAM and stack (`a05_relay_rule`). debounce.h has the further rules.
 *
 * @code
 * static fathom_a05_relay_rule_t rule;
 * const fathom_a05_relay_rule_config_t config = {.threshold_mm = 800};
 * fathom_a05_relay_rule_init(&rule, &config);
 *
 * if (fathom_a05_relay_rule_add_sample(&rule, &sample)) use(rule.debounce.level);   // in the loop, for each sample
 * if (fathom_debounce_advance(&rule.debounce, clock.now_us(clock.ctx))) stop();     // in the loop
 * @endcode
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
 * A measurement that does not count leaves the level as it is, until the level becomes unknown (`unknown_us`). The rule
 * ignores probes that are not fitted, because their values are not defined.
 */

/** @brief Threshold of the relay (A05 4(2), note 1). */
enum {
    FATHOM_A05_RELAY_MIN_MM = 250,     /**< Least threshold in mm. */
    FATHOM_A05_RELAY_MAX_MM = 4500,    /**< Greatest threshold in mm. */
    FATHOM_A05_RELAY_DEFAULT_MM = 1000 /**< Factory setting in mm. */
};

/** @brief Default of fathom_a05_relay_rule_config_t::hold_us, in microseconds (A05 4(1)). */
#define FATHOM_A05_RELAY_HOLD_US 1000000uL

/** @brief Configuration. Read only during fathom_a05_relay_rule_init(). A member that is 0 takes its default. */
typedef struct {
    /**
     * @brief Least time that each state lasts, in microseconds: 1 to FATHOM_MAX_DURATION_US. 0 selects 1 s.
     *
     * The datasheet: "pull-in and cut-off time will be maintained for 1 second" (A05 4(1)). 1 us is practically no
     * hold.
     */
    uint32_t hold_us;
    /**
     * @brief Time after the newest measurement that counted at which the level becomes FATHOM_UNKNOWN, in microseconds.
     *
     * 1 to FATHOM_MAX_DURATION_US. 0 selects 5 s; FATHOM_NO_DEADLINE disables it.
     */
    uint32_t unknown_us;

    /** @brief Threshold in mm, 250 to 4500. 0 selects 1000. */
    uint16_t threshold_mm;

    /** @brief Fitted probes that the sensor's driver reads, bit (probe - 1): 1 to 15. 0 selects all four. */
    uint8_t probes;

    /** @brief What a distance at the threshold is: a fathom_equal_t. */
    uint8_t equal;
} fathom_a05_relay_rule_config_t;

/** @brief A rule, in the caller's memory. The caller may read `debounce.level`; all other members are private. */
typedef struct {
    /**
     * @brief The switch. Its `level` is FATHOM_NEAR (closed), FATHOM_FAR (open), FATHOM_UNKNOWN (an error), or 0 (not
     * known yet). A relay without power shows the last two as open.
     */
    fathom_debounce_t debounce;
    /* private */
    uint16_t sequence; /* sequence number of the present measurement */
    uint8_t probes;    /* as in the config. Invariant: 0 unless the initialisation succeeded */
    uint8_t missing;   /* probes without a sample in the present measurement, bit (probe - 1) */
    uint8_t verdict;   /* verdict on the present measurement so far */
} fathom_a05_relay_rule_t;

/**
 * @brief Initialises a rule. It has no level before the first measurement that counts.
 *
 * @param rule    The rule, in any memory.
 * @param config  The config. Read only during the call.
 * @retval FATHOM_OK            The rule can be used. Next, pass each sample to fathom_a05_relay_rule_add_sample().
 * @retval FATHOM_ERR_ARGUMENT  A member is outside its range. The rule is zeroed; it then never has a level.
 */
fathom_status_t fathom_a05_relay_rule_init(fathom_a05_relay_rule_t *rule,
                                           const fathom_a05_relay_rule_config_t *config);

/**
 * @brief Adds the next sample of the sensor, at its `time_us`.
 *
 * @param rule    The rule.
 * @param sample  The sample. Used only during the call.
 * @return True if the level changed, also from none to the first one, or to unknown.
 */
bool fathom_a05_relay_rule_add_sample(fathom_a05_relay_rule_t *rule, const fathom_sample_t *sample);

#ifdef __cplusplus
}
#endif

#endif
