/* SPDX-License-Identifier: MIT */
#include "fathom/dyp.h"

uint8_t fathom_dyp_meaning(const fathom_dyp_window_t *window, uint16_t value)
{
    if (value == 0) return window->value_0;
    if (value == 0xFFFD) return window->value_fffd;
    if (value == 0xFFFE) return window->value_fffe;
    if (value == 0xFFFF) return window->value_ffff;
    return value >= window->min_mm && value <= window->max_mm ? (uint8_t)FATHOM_TARGET
                                                              : (uint8_t)FATHOM_MEANS_REFUSED;
}

fathom_status_t fathom_dyp_next(fathom_dyp_answer_t *answer, fathom_sample_t *sample)
{
    if (answer->left == 0) return FATHOM_PENDING;
    uint8_t probe = 1;
    uint8_t bit = 1;
    for (; (answer->left & bit) == 0; bit = (uint8_t)(bit << 1)) probe++;
    answer->left &= (uint8_t)~bit;
    const uint16_t value = answer->values[probe - answer->first];
    const uint8_t meaning = fathom_dyp_meaning(&answer->window, value);
    if (meaning == FATHOM_MEANS_REFUSED) {
        if (answer->implausible != UINT16_MAX) answer->implausible++;
        answer->refused_raw = value;
        answer->refused_probe = probe;
        return FATHOM_ERR_MALFORMED;
    }
    sample->time_us = answer->time_us;
    sample->magnitude = 0;
    sample->sequence = answer->sequence;
    sample->raw = value;
    sample->distance_mm = meaning == FATHOM_TARGET ? value : 0;
    sample->precision = 0;
    sample->kind = meaning == FATHOM_MEANS_INTERFERENCE ? (uint8_t)FATHOM_NO_TARGET : meaning;
    sample->model = answer->model;
    sample->unit = answer->unit;
    sample->probe = probe;
    sample->ambient = 0;
    sample->interference = meaning == FATHOM_MEANS_INTERFERENCE;
    return FATHOM_READY;
}

void fathom_dyp_answer(fathom_dyp_answer_t *answer, uint8_t probes, uint32_t time_us)
{
    answer->sequence++;
    answer->time_us = time_us;
    answer->left = probes;
}

fathom_status_t fathom_dyp_answer_init(fathom_dyp_answer_t *answer, uint16_t default_max_mm)
{
    fathom_dyp_window_t *const window = &answer->window;
    if (window->min_mm == 0) window->min_mm = 1;
    if (window->max_mm == 0) window->max_mm = default_max_mm;
    if (window->value_0 == 0) window->value_0 = FATHOM_MEANS_UNKNOWN;
    if (window->value_fffd == 0) window->value_fffd = FATHOM_MEANS_NO_TARGET;
    if (window->value_fffe == 0) window->value_fffe = FATHOM_MEANS_INTERFERENCE;
    if (window->value_ffff == 0) window->value_ffff = FATHOM_MEANS_REFUSED;
    answer->time_us = 0;
    answer->sequence = 0;
    answer->implausible = 0;
    answer->refused_raw = 0;
    answer->refused_probe = 0;
    answer->left = 0;
    return window->min_mm > window->max_mm ? FATHOM_ERR_ARGUMENT : FATHOM_READY;
}
