/* SPDX-License-Identifier: MIT */
/*
 * The rule of the A05's relay in software. It combines the samples of one measurement into one verdict, and debounce.c
 * makes a level of the verdicts.
 */
#include "fathom/sensor/a05_relay_rule.h"

#include "../common.h"

enum { ALL_PROBES = 0x0F };

fathom_status_t fathom_a05_relay_rule_init(fathom_a05_relay_rule_t *rule,
                                           const fathom_a05_relay_rule_config_t *config)
{
    fathom_debounce_config_t own;
    own.hold_us = or_default(config->hold_us, FATHOM_A05_RELAY_HOLD_US);
    own.unknown_us = config->unknown_us;
    own.threshold_mm = (uint16_t)or_default(config->threshold_mm, FATHOM_A05_RELAY_DEFAULT_MM);
    own.near_count = 1; /* A05 4 does not require several measurements in a row. */
    own.far_count = 1;
    own.equal = config->equal;
    clear(rule, sizeof *rule);
    if ((own.threshold_mm < FATHOM_A05_RELAY_MIN_MM) || (own.threshold_mm > FATHOM_A05_RELAY_MAX_MM) ||
        (config->probes > ALL_PROBES) || (fathom_debounce_init(&rule->debounce, &own) != FATHOM_OK))
        return FATHOM_ERR_ARGUMENT;
    rule->probes = (config->probes != 0u) ? config->probes : (uint8_t)ALL_PROBES;
    rule->missing = rule->probes;
    rule->verdict = FATHOM_FAR;
    return FATHOM_OK;
}

/* Returns the verdict on one sample: FATHOM_NEAR, FATHOM_FAR, 0 at the threshold, or FATHOM_UNKNOWN for no verdict. */
static uint8_t verdict_of(const fathom_a05_relay_rule_t *rule, const fathom_sample_t *sample)
{
    if (sample->kind == FATHOM_TARGET) return fathom_debounce_compare(&rule->debounce, sample->distance_mm);
    if (sample->kind == FATHOM_NO_TARGET) return FATHOM_FAR;
    return (sample->kind == FATHOM_NEAR) ? (uint8_t)FATHOM_NEAR : (uint8_t)FATHOM_UNKNOWN;
}

bool fathom_a05_relay_rule_add_sample(fathom_a05_relay_rule_t *rule, const fathom_sample_t *sample)
{
    const uint8_t bit = (uint8_t)(1u << ((sample->probe - 1u) & 7u));
    const uint8_t verdict = verdict_of(rule, sample);
    if (sample->sequence != rule->sequence) {
        rule->sequence = sample->sequence;
        rule->missing = rule->probes;
        rule->verdict = FATHOM_FAR;
    }
    if (verdict == FATHOM_UNKNOWN) return fathom_debounce_advance(&rule->debounce, sample->time_us);
    if ((rule->missing & bit) == 0u) return false;
    rule->missing &= (uint8_t)~bit;
    if (verdict != FATHOM_FAR) rule->verdict = verdict;
    if (verdict == FATHOM_NEAR) rule->missing = 0; /* The other probes cannot change this verdict. */
    return (rule->missing == 0u) &&
           fathom_debounce_add_verdict(&rule->debounce, rule->verdict, sample->time_us);
}
