/* SPDX-License-Identifier: MIT */
#include "fathom/processing/debounce.h"

#include "../common.h"

/* A switch made of distances. This file counts measurements in a row and keeps the least time of a level. */

enum { NEITHER = 0 };

fathom_status_t fathom_debounce_init(fathom_debounce_t *debounce, const fathom_debounce_config_t *config)
{
    fathom_debounce_config_t *const own = &debounce->config;
    const uint32_t unknown_us = or_default(config->unknown_us, FATHOM_DEBOUNCE_DEFAULT_UNKNOWN_US);
    clear(debounce, sizeof *debounce);
    if ((config->hold_us > FATHOM_MAX_DURATION_US) || (config->equal > FATHOM_EQUAL_IS_FAR) ||
        ((unknown_us > FATHOM_MAX_DURATION_US) && (unknown_us != FATHOM_NO_DEADLINE)))
        return FATHOM_ERR_ARGUMENT;
    own->hold_us = config->hold_us;
    own->unknown_us = unknown_us;
    own->threshold_mm = (uint16_t)or_default(config->threshold_mm, FATHOM_DEBOUNCE_DEFAULT_THRESHOLD_MM);
    own->near_count = (uint8_t)or_default(config->near_count, FATHOM_DEBOUNCE_DEFAULT_NEAR_COUNT);
    own->far_count = (uint8_t)or_default(config->far_count, FATHOM_DEBOUNCE_DEFAULT_FAR_COUNT);
    own->equal = config->equal;
    return FATHOM_OK;
}

static bool is_initialised(const fathom_debounce_t *debounce) { return debounce->config.near_count != 0u; }

bool fathom_debounce_advance(fathom_debounce_t *debounce, uint32_t now_us)
{
    const uint32_t passed_us = fathom_elapsed_us(now_us, debounce->fed_us);
    const uint8_t before = debounce->level;
    /* A difference above half of what the clock counts is a time before the measurement. */
    if (!debounce->is_fed || (passed_us <= debounce->config.unknown_us) || (passed_us > (UINT32_MAX / 2u)))
        return false;
    debounce->level = FATHOM_UNKNOWN;
    debounce->row = 0;
    debounce->left_us = 0;
    return before != FATHOM_UNKNOWN;
}

bool fathom_debounce_add_verdict(fathom_debounce_t *debounce, uint8_t verdict, uint32_t now_us)
{
    const uint8_t before = debounce->level;
    if (!is_initialised(debounce)) return false;
    (void)fathom_debounce_advance(debounce, now_us);
    const bool is_over = fathom_count_down(&debounce->left_us, time_since_us(now_us, debounce->fed_us));
    debounce->fed_us = now_us;
    debounce->is_fed = true;
    if (debounce->verdict != verdict) debounce->row = 0;
    debounce->verdict = verdict;
    if ((verdict == FATHOM_NEAR) || (verdict == FATHOM_FAR)) {
        if (debounce->row != UINT8_MAX) debounce->row++;
        const uint8_t enough =
            (verdict == FATHOM_NEAR) ? debounce->config.near_count : debounce->config.far_count;
        if ((debounce->level != verdict) && (debounce->row >= enough) && is_over) {
            debounce->level = verdict;
            debounce->left_us = debounce->config.hold_us;
        }
    }
    return debounce->level != before;
}

uint8_t fathom_debounce_compare(const fathom_debounce_t *debounce, uint16_t distance_mm)
{
    const uint16_t threshold_mm = debounce->config.threshold_mm;
    if (distance_mm < threshold_mm) return FATHOM_NEAR;
    if (distance_mm > threshold_mm) return FATHOM_FAR;
    if (debounce->config.equal == FATHOM_EQUAL_IS_NEAR) return FATHOM_NEAR;
    return (debounce->config.equal == FATHOM_EQUAL_IS_FAR) ? FATHOM_FAR : NEITHER;
}

bool fathom_debounce_add_distance(fathom_debounce_t *debounce, uint16_t distance_mm, uint32_t now_us)
{
    return fathom_debounce_add_verdict(debounce, fathom_debounce_compare(debounce, distance_mm), now_us);
}

bool fathom_debounce_add_sample(fathom_debounce_t *debounce, const fathom_sample_t *sample)
{
    switch (sample->kind) {
    case FATHOM_TARGET:
        return fathom_debounce_add_distance(debounce, sample->distance_mm, sample->time_us);
    case FATHOM_NO_TARGET:
        return fathom_debounce_add_verdict(debounce, FATHOM_FAR, sample->time_us);
    case FATHOM_NEAR:
    case FATHOM_FAR:
        return fathom_debounce_add_verdict(debounce, sample->kind, sample->time_us);
    default:
        return fathom_debounce_advance(debounce, sample->time_us);
    }
}
