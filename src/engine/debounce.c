/* SPDX-License-Identifier: MIT */
#include "fathom/engine/debounce.h"

#include "fathom/hal.h"

enum { NEITHER = 0 };

fathom_status_t fathom_debounce_init(fathom_debounce_t *debounce, const fathom_debounce_config_t *config)
{
    fathom_debounce_config_t *const own = &debounce->config;
    own->hold_us = config->hold_us;
    own->unknown_us = (config->unknown_us != 0u) ? config->unknown_us : FATHOM_DEBOUNCE_DEFAULT_UNKNOWN_US;
    own->threshold_mm =
        (config->threshold_mm != 0u) ? config->threshold_mm : (uint16_t)FATHOM_DEBOUNCE_DEFAULT_THRESHOLD_MM;
    own->near_count =
        (config->near_count != 0u) ? config->near_count : (uint8_t)FATHOM_DEBOUNCE_DEFAULT_NEAR_COUNT;
    own->far_count =
        (config->far_count != 0u) ? config->far_count : (uint8_t)FATHOM_DEBOUNCE_DEFAULT_FAR_COUNT;
    own->equal = config->equal;
    debounce->fed_us = 0;
    debounce->left_us = 0;
    debounce->level = NEITHER;
    debounce->verdict = NEITHER;
    debounce->row = 0;
    debounce->is_fed = false;
    return (config->equal > FATHOM_EQUAL_IS_FAR) ? FATHOM_ERR_ARGUMENT : FATHOM_READY;
}

bool fathom_debounce_time(fathom_debounce_t *debounce, uint32_t now_us)
{
    const uint32_t passed_us = fathom_elapsed_us(now_us, debounce->fed_us);
    const uint8_t before = debounce->level;
    /* Half a turn of the clock and more: it is a time before the measurement. */
    if (!debounce->is_fed || (passed_us <= debounce->config.unknown_us) || (passed_us > (UINT32_MAX / 2u)))
        return false;
    debounce->level = FATHOM_UNKNOWN;
    debounce->row = 0;
    debounce->left_us = 0;
    return before != FATHOM_UNKNOWN;
}

bool fathom_debounce_verdict(fathom_debounce_t *debounce, uint8_t verdict, uint32_t now_us)
{
    const uint8_t before = debounce->level;
    (void)fathom_debounce_time(debounce, now_us);
    const bool is_over = fathom_count_down(&debounce->left_us, fathom_elapsed_us(now_us, debounce->fed_us));
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

bool fathom_debounce_distance(fathom_debounce_t *debounce, uint16_t distance_mm, uint32_t now_us)
{
    return fathom_debounce_verdict(debounce, fathom_debounce_compare(debounce, distance_mm), now_us);
}

bool fathom_debounce_sample(fathom_debounce_t *debounce, const fathom_sample_t *sample)
{
    switch (sample->kind) {
    case FATHOM_TARGET:
        return fathom_debounce_distance(debounce, sample->distance_mm, sample->time_us);
    case FATHOM_NO_TARGET:
        return fathom_debounce_verdict(debounce, FATHOM_FAR, sample->time_us);
    case FATHOM_NEAR:
    case FATHOM_FAR:
        return fathom_debounce_verdict(debounce, sample->kind, sample->time_us);
    default:
        return fathom_debounce_time(debounce, sample->time_us);
    }
}
